/**
 * The energy of a segment as a function of two fractions. Private to the core.
 *
 * With Tmin = max(Ts, JP_SEGMENT_DURATION_MIN, d/vmax), half the arc angle γ/2 = π x and the shape r of the arc
 * (segment_arc.h)
 *
 *   ξ = Tmin/T,  v = (16 d/Tmin) r′ ξ,  r′ = r/16,  w = (2π/Tmin) x ξ,  σ = π s,  s = β/π − x
 *
 * every unknown is a fraction below 1, x and s are the bits of a wrapping angle, and E less its constant is
 *
 *   vv v′² + vw v′w′ + ww w′² + (vs v′ + ws w′) s + ss s² + lv v′ + lw w′ + ls s + (fv r′² + fw x²) ξ + P/ξ
 *
 * with v′ = r′ξ and w′ = xξ. The coefficients are in J and share one power of two, so that the largest fills its word.
 */
#ifndef JOULEPATH_TRAJECTORY_SEGMENT_PROBLEM_H
#define JOULEPATH_TRAJECTORY_SEGMENT_PROBLEM_H

#include <joulepath/segment.h>

#include "src/energy/energy_terms.h"

struct jp_segment_problem {
    int32_t vv2, vw, ww2, vs, ws, ss2; /**< quadratic; vv, ww and ss doubled */
    int32_t lv, lw, ls;                /**< linear */
    int32_t fv2, fw2;                  /**< friction, doubled */
    int32_t power;                     /**< P */
    unsigned power_shift;              /**< left shift that brings P to 29 bits */
    int32_t bearing;                   /**< β as a wrapping angle */
    int32_t speed_limit;               /**< vmax Tmin/d in Q27, saturated */
    int32_t turn_rate_limit;           /**< wmax Tmin/2π in Q31, saturated */
    int32_t xi_min;                    /**< Tmin/Tmax in Q30 */
};

/** d in Q22. */
void jp_segment_problem_build(struct jp_segment_problem *problem, const struct jp_energy_model *model,
                              const struct jp_segment_limits *limits, const struct jp_motion *before,
                              const struct jp_voltage_terms *voltage, uint32_t distance, jp_angle bearing,
                              jp_q16 time_min);

/** The largest |x| whose duration the limits allow. */
int32_t jp_segment_longest_half_arc(const struct jp_segment_problem *problem);

#endif
