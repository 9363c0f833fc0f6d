/**
 * Learns the energy model of a skid-steered or differential-drive robot while it drives, from the measured energy of
 * each leg, and states the uncertainty of forecasts.
 *
 * Robots and grounds of a kind differ by the factors of skid_energy.h: rolling resistance, friction, weight and
 * electronics. Their prior is 1 with the deviations d of struct jp_skid_learning:
 *
 *   factor = 1 + d x, x ~ N(0, I),    E − E(x) = f Δx + noise,    f = d/factor · change
 *
 * with the energy E and its changes by jp_skid_energy_add() on the model as learned so far. So each step is linear, and
 * products of factors are as they are: an extended Kalman filter whose state stands still, in the square-root form of
 * learner.h, with its forgetting, its outliers and its test for changes.
 *
 * The noise of a leg has three parts: so many joules, a share of its energy, and a share of the work of its slopes, on
 * which robots slide and are led back.
 *
 * How to use it: as a leg is driven, or from its plan, add its pieces to a struct jp_skid_drive on learner->model; at
 * its end hand over the drive with what the meter says. A leg ends where the robot drives on, or stands for good: what
 * turns on the spot on a slope slides down it, and climbs back by what it drives next. A plan's forecast is made of
 * drives on learner->model likewise. Energies in Q16 are in the unit of the built-in model.
 */
#ifndef JOULEPATH_SKID_LEARNER_H
#define JOULEPATH_SKID_LEARNER_H

#include <joulepath/learner.h>
#include <joulepath/skid_energy.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Every factor stays within these. */
#define JP_SKID_FACTOR_MIN JP_Q16(0.25)
#define JP_SKID_FACTOR_MAX JP_Q16(4)

/** Robots of one kind; made by tools/design/skid_identify.py. */
struct jp_skid_learning {
    jp_q16 deviation[JP_SKID_FACTORS]; /**< d: standard deviations of the factors about 1; above 0, at most 1 */
    jp_q16 noise;          /**< standard deviation of a leg's energy about the model: J; above 0, ≤ 1 024, */
    jp_q16 noise_relative; /**< share of the energy, 0…1, */
    jp_q16 noise_slopes;   /**< and share of the work of slopes, 0…1. The three are independent. */
    /** What one leg takes too much, the next often takes too little, so that single legs are further from the model
     * than this noise, which makes forecasts of routes: by this factor; 1…16. */
    jp_q16 spread;
    uint32_t memory;   /**< legs after which a measurement counts 1/e; 8…1 024 */
    uint32_t identity; /**< of the numbers above, not 0: a state that was learned with others is invalid */
};

/** Private but for the members with a comment. */
struct jp_skid_learner {
    const struct jp_skid_learning *learning;
    const struct jp_skid_energy_model *built_in;
    struct jp_learned_state state;     /**< to be stored */
    struct jp_skid_energy_model model; /**< as learned */
    uint32_t outliers;                 /**< since the start, saturating */
    uint32_t changes;                  /**< of robot or ground since the start, saturating */
    struct jp_learned_watch watch;
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. Not
 *  for ISRs. */
enum jp_status jp_skid_learning_check(const struct jp_skid_learning *learning, const char **field);

/** Starts with nothing learned. Both must have passed their checks; their pointers are kept. Constant time. */
void jp_skid_learner_start(struct jp_skid_learner *learner, const struct jp_skid_learning *learning,
                           const struct jp_skid_energy_model *built_in);

/** Continues from a stored state, after jp_skid_learner_start(). Failures as jp_learner_restore(). */
enum jp_status jp_skid_learner_restore(struct jp_skid_learner *learner, const struct jp_learned_state *state,
                                       const char **field);

/**
 * Learns from a leg that was driven: `drive` on learner->model, and `measured` by jp_energy_to_q16(). Not for ISRs.
 * *learned says what became of it; learner->model follows. JP_ERR_ARGUMENT: a pointer is null. JP_ERR_OVERFLOW: the
 * energy or a change of it exceeds its format. Then nothing is learned and *learned not written. Work: that of
 * jp_learner_update_leg() and four divisions.
 */
enum jp_status jp_skid_learner_update(struct jp_skid_learner *learner, const struct jp_skid_drive *drive,
                                      jp_q16 measured, enum jp_learned *learned);

/** The factors as learned, and their standard deviations; JP_SKID_FACTOR_MIN…JP_SKID_FACTOR_MAX. Eight
 *  multiplications; four square roots. */
void jp_skid_learner_factors(const struct jp_skid_learner *learner, jp_q16 factor[JP_SKID_FACTORS]);
void jp_skid_learner_deviations(const struct jp_skid_learner *learner, jp_q16 deviation[JP_SKID_FACTORS]);

/** Adds a drive on learner->model to a forecast, whose sum is all zero at first. Failures as jp_skid_learner_update():
 *  *sum is not written. At most 65 536 drives, with no update between them. */
enum jp_status jp_skid_forecast_add(const struct jp_skid_learner *learner, struct jp_forecast_sum *sum,
                                    const struct jp_skid_drive *drive);

/** Expectation and standard deviation of the sum; failures as jp_forecast_total(). Whether the battery suffices says
 *  jp_forecast_reserve(). */
enum jp_status jp_skid_forecast_total(const struct jp_skid_learner *learner, const struct jp_forecast_sum *sum,
                                      struct jp_forecast *forecast);

#ifdef __cplusplus
}
#endif

#endif
