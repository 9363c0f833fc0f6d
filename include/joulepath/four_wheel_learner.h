/**
 * Learns the energy model of a robot with four steered wheels while it drives, from the measured energy of each leg,
 * and states the uncertainty of forecasts: factor_learning.h with the factors of four_wheel_energy.h, rolling
 * resistance, weight, steering and electronics.
 *
 * How to use it: as a leg is driven, or from its plan, add its pieces to a struct jp_four_wheel_drive on
 * learner->model; at its end hand over the drive with what the meter says. A plan's forecast is made of drives on
 * learner->model likewise. Energies in Q16 are in the unit of the built-in model.
 */
#ifndef JOULEPATH_FOUR_WHEEL_LEARNER_H
#define JOULEPATH_FOUR_WHEEL_LEARNER_H

#include <joulepath/factor_learning.h>
#include <joulepath/four_wheel_energy.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Private but for the members with a comment. */
struct jp_four_wheel_learner {
    const struct jp_factor_learning *learning;
    const struct jp_four_wheel_energy_model *built_in;
    struct jp_learned_state state;           /**< to be stored */
    struct jp_four_wheel_energy_model model; /**< as learned */
    uint32_t outliers;                       /**< since the start, saturating */
    uint32_t changes;                        /**< of robot or ground since the start, saturating */
    struct jp_learned_watch watch;
};

/** Starts with nothing learned. Both must have passed their checks; their pointers are kept. Constant time. */
void jp_four_wheel_learner_start(struct jp_four_wheel_learner *learner, const struct jp_factor_learning *learning,
                                 const struct jp_four_wheel_energy_model *built_in);

/** Continues from a stored state, after jp_four_wheel_learner_start(). Failures as jp_learner_restore(). */
enum jp_status jp_four_wheel_learner_restore(struct jp_four_wheel_learner *learner,
                                             const struct jp_learned_state *state, const char **field);

/**
 * Learns from a leg that was driven: `drive` on learner->model, and `measured` by jp_energy_to_q16(). Not for ISRs.
 * *learned says what became of it; learner->model follows. JP_ERR_ARGUMENT: a pointer is null. JP_ERR_OVERFLOW: the
 * energy or a change of it exceeds its format. Then nothing is learned and *learned not written. Work: that of
 * jp_learner_update_leg() and five divisions.
 */
enum jp_status jp_four_wheel_learner_update(struct jp_four_wheel_learner *learner,
                                            const struct jp_four_wheel_drive *drive, jp_q16 measured,
                                            enum jp_learned *learned);

/** The factors as learned, and their standard deviations; JP_FACTOR_MIN…JP_FACTOR_MAX. Eight multiplications; four
 *  square roots. */
void jp_four_wheel_learner_factors(const struct jp_four_wheel_learner *learner, jp_q16 factor[JP_FOUR_WHEEL_FACTORS]);
void jp_four_wheel_learner_deviations(const struct jp_four_wheel_learner *learner,
                                      jp_q16 deviation[JP_FOUR_WHEEL_FACTORS]);

/** Adds a drive on learner->model to a forecast, whose sum is all zero at first. Failures as
 *  jp_four_wheel_learner_update(): *sum is not written. At most 65 536 drives, with no update between them. */
enum jp_status jp_four_wheel_forecast_add(const struct jp_four_wheel_learner *learner, struct jp_forecast_sum *sum,
                                          const struct jp_four_wheel_drive *drive);

/** Expectation and standard deviation of the sum; failures as jp_forecast_total(). Whether the battery suffices says
 *  jp_forecast_reserve(). */
enum jp_status jp_four_wheel_forecast_total(const struct jp_four_wheel_learner *learner,
                                            const struct jp_forecast_sum *sum, struct jp_forecast *forecast);

#ifdef __cplusplus
}
#endif

#endif
