/**
 * Learns the energy model of a skid-steered or differential-drive robot while it drives, from the measured energy of
 * each leg, and states the uncertainty of forecasts: factor_learning.h with the factors of skid_energy.h: rolling
 * resistance, friction, weight and electronics. The noise of a leg has a third part: a share of the work of its slopes,
 * on which robots slide and are led back.
 *
 * Payload, motors and ground are in these factors. A battery that sags is not: energies are those at its terminals,
 * where meter.h measures them, and bridges draw the same power at a lower voltage. What the battery's own resistance
 * burns besides is in none of them.
 *
 * How to use it: as a leg is driven, or from its plan, add its pieces to a struct jp_skid_drive on learner->model; at
 * its end hand over the drive with what the meter says. A leg ends where the robot drives on, or stands for good: what
 * turns on the spot on a slope slides down it, and climbs back by what it drives next. A plan's forecast is made of
 * drives on learner->model likewise. Energies in Q16 are in the unit of the built-in model.
 */
#ifndef JOULEPATH_SKID_LEARNER_H
#define JOULEPATH_SKID_LEARNER_H

#include <joulepath/factor_learning.h>
#include <joulepath/skid_energy.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Robots of one kind; made by tools/design/skid_identify.py. */
struct jp_skid_learning {
    struct jp_factor_learning factors; /**< whose identity is of noise_slopes, too */
    jp_q16 noise_slopes; /**< standard deviation of a leg's energy about the model: share of the work of its slopes,
                              0…1; independent of the other two */
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
 * jp_learner_update_leg() and five divisions.
 */
enum jp_status jp_skid_learner_update(struct jp_skid_learner *learner, const struct jp_skid_drive *drive,
                                      jp_q16 measured, enum jp_learned *learned);

/** The factors as learned, and their standard deviations; JP_FACTOR_MIN…JP_FACTOR_MAX. Eight multiplications; four
 *  square roots. */
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
