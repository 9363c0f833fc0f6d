/** The least energy over one arc: the best duration at one x, and how the energy changes with x. Private to the core.
 */
#ifndef JOULEPATH_TRAJECTORY_SEGMENT_EVALUATION_H
#define JOULEPATH_TRAJECTORY_SEGMENT_EVALUATION_H

#include "src/trajectory/segment_duration.h"

/** J*(x) = min over ξ of J, and its slope by the envelope theorem. Energies are in the scale of the problem. */
struct jp_evaluation {
    int32_t x;
    int32_t xi;           /**< Q30 */
    int32_t energy;       /**< J* less a constant */
    int32_t slope;        /**< dJ* /dx / 16, saturated */
    int32_t slope_inside; /**< the same under the limit that acts nearer to x = 0 */
    int32_t idle;         /**< P/ξ */
    struct jp_inverse inverse;
    enum jp_acting_limit limit;
};

/**
 * Evaluates J* at x. Before the call *evaluation holds one near by, or an unknown inverse.
 * `inside` is the limit that acts nearer to x = 0 if x is a kink.
 */
void jp_segment_evaluate(const struct jp_segment_problem *problem, int32_t x, enum jp_acting_limit inside,
                         struct jp_evaluation *evaluation);

#endif
