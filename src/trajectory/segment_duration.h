/** The best duration of one arc, as ξ = Tmin/T. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_SEGMENT_DURATION_H
#define JOULEPATH_TRAJECTORY_SEGMENT_DURATION_H

#include "src/trajectory/segment_arc.h"
#include "src/trajectory/segment_problem.h"

/** What sets the duration, or else its own optimum does. */
enum jp_acting_limit { JP_ACTING_NONE, JP_ACTING_SPEED, JP_ACTING_TURN_RATE };

/** 1/ξ = mantissa 2^exponent, the mantissa 1…2 in Q30; 0 if unknown. */
struct jp_inverse {
    uint32_t mantissa;
    int exponent;
};

/** The ξ of least energy at x in Q30, and the limit that sets it; s = β/π − x. */
int32_t jp_segment_best_xi(const struct jp_segment_problem *problem, int32_t x, int32_t s, const struct jp_arc *arc,
                           const struct jp_inverse *guess, enum jp_acting_limit *limit);

#endif
