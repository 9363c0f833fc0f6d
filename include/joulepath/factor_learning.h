/**
 * Learns by which factors a robot's energy model is off, from the measured energy of each leg.
 *
 * The prior of each factor is 1 with a deviation d:
 *
 *   factor = 1 + d x, x ~ N(0, I),    E − E(x) = f Δx + noise,    f = d/factor · change
 *
 * with the energy E and its changes by the relative change of each factor, of the model as learned so far: an extended
 * Kalman filter whose state stands still, in the square-root form of learner.h, with its forgetting, its outliers and
 * its test for changes. What the factors are says the robot's kind: skid_learner.h, four_wheel_learner.h.
 */
#ifndef JOULEPATH_FACTOR_LEARNING_H
#define JOULEPATH_FACTOR_LEARNING_H

#include <joulepath/learner.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Every factor stays within these. */
#define JP_FACTOR_MIN JP_Q16(0.25)
#define JP_FACTOR_MAX JP_Q16(4)

/** Robots of one kind. */
struct jp_factor_learning {
    jp_q16 deviation[JP_LEARNING_DIRECTIONS]; /**< d: standard deviations of the factors about 1; above 0, at most 1 */
    jp_q16 noise_relative; /**< standard deviation of a leg's energy about the model: share of it, 0…1, */
    jp_q16 noise;          /**< and J; above 0, at most 1 024. The two are independent. */
    /** What one leg takes too much, the next often takes too little, so that single legs are further from the model
     * than this noise, which makes forecasts of routes: by this factor; 1…16. */
    jp_q16 spread;
    uint32_t memory;   /**< legs after which a measurement counts 1/e; 8…1 024 */
    uint32_t identity; /**< of the numbers above, not 0: a state that was learned with others is invalid */
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. Not
 *  for ISRs. */
enum jp_status jp_factor_learning_check(const struct jp_factor_learning *learning, const char **field);

#ifdef __cplusplus
}
#endif

#endif
