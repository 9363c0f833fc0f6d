/**
 * What a skid-steered or differential-drive robot knows of the grounds that a map tells apart: an energy model of each
 * class, by what its own learner knows of the robot (skid_learner.h) and ground_learner.h of the ground.
 *
 * A leg on class 0 alone teaches the robot's learner, one that crosses others teaches those; one of which more than
 * 1/16 is where the wheels may as well be on another class teaches nothing. Energies in Q16 are in the unit of the
 * models. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_SKID_GROUNDS_H
#define JOULEPATH_SKID_GROUNDS_H

#include <joulepath/ground_learner.h>
#include <joulepath/skid_learner.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The members but `learner` are private; its states are worth storing. */
struct jp_skid_grounds {
    struct jp_ground_learner learner;
    struct jp_skid_energy_model models[JP_GROUND_CLASSES]; /**< as learned, by class */
};

/** A drive by the ground on which its parts are; all zero at first. */
struct jp_skid_ground_drive {
    struct jp_skid_drive on[JP_GROUND_CLASSES];
    int64_t at_edges; /**< of the energy, what is taken where the wheels may be on another class, 2ⁿ J, Q16 */
};

/** Sum of forecasts; all zero at first. Private. */
struct jp_skid_ground_sum {
    struct jp_forecast_sum robot;
    struct jp_ground_change ground;
};

/** Starts with nothing learned of the grounds, of a robot whose learner has started. The learning must have passed its
 *  check; its pointer is kept. */
void jp_skid_grounds_start(struct jp_skid_grounds *grounds, const struct jp_factor_learning *learning,
                           const struct jp_skid_learner *robot);

/** Makes the models anew: after either learner was restored, or learned elsewhere. Work: a scaled model a class. */
void jp_skid_grounds_follow(struct jp_skid_grounds *grounds, const struct jp_skid_learner *robot);

/** The model of a class; of class 0, and where nothing is known of grounds, null, that of the robot. Constant time. */
const struct jp_skid_energy_model *jp_skid_grounds_model(const struct jp_skid_grounds *grounds,
                                                         const struct jp_skid_learner *robot, uint8_t ground);

/** Adds a share of a drive to another one: 1/parts. */
void jp_skid_drive_add(struct jp_skid_drive *sum, const struct jp_skid_drive *drive, int64_t parts);

/** The whole of a drive. */
void jp_skid_ground_drive_total(const struct jp_skid_ground_drive *drive, struct jp_skid_drive *total);

/** Learns from a leg that was driven, whose parts are on jp_skid_grounds_model(), and makes the models anew. `grounds`
 *  may be null: then the robot's learner learns from every leg. Failures as jp_skid_learner_update() and
 *  jp_ground_learner_update(). */
enum jp_status jp_skid_grounds_update(struct jp_skid_grounds *grounds, struct jp_skid_learner *robot,
                                      const struct jp_skid_ground_drive *drive, jp_q16 measured,
                                      enum jp_learned *learned);

/** Adds a drive to a forecast, and tells its sum; `grounds` may be null. Failures as jp_skid_forecast_add(), and as
 *  jp_skid_forecast_total() and jp_ground_learner_widen(). */
enum jp_status jp_skid_grounds_forecast_add(const struct jp_skid_learner *robot, struct jp_skid_ground_sum *sum,
                                            const struct jp_skid_ground_drive *drive);
enum jp_status jp_skid_grounds_forecast_total(const struct jp_skid_grounds *grounds,
                                              const struct jp_skid_learner *robot, const struct jp_skid_ground_sum *sum,
                                              struct jp_forecast *forecast);

#ifdef __cplusplus
}
#endif

#endif
