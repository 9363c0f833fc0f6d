#include <joulepath/skid_grounds.h>

#include <stddef.h>

#include "src/base/compiler.h"

/** Nothing is learned of a leg of which more than one of so many joules is taken at edges. */
#define EDGES_MAX 16

void jp_skid_grounds_follow(struct jp_skid_grounds *grounds, const struct jp_skid_learner *robot)
{
    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        jp_q16 factor[JP_SKID_FACTORS] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE};
        jp_q16 of_ground[JP_GROUND_FACTORS];

        jp_ground_learner_factors(&grounds->learner, (uint8_t)k, of_ground);
        factor[JP_SKID_ROLLING] = of_ground[JP_GROUND_ROLLING];
        factor[JP_SKID_FRICTION] = of_ground[JP_GROUND_FRICTION];
        jp_skid_energy_scale(&robot->model, factor, &grounds->models[k]);
    }
}

void jp_skid_grounds_start(struct jp_skid_grounds *grounds, const struct jp_factor_learning *learning,
                           const struct jp_skid_learner *robot)
{
    jp_ground_learner_start(&grounds->learner, learning);
    jp_skid_grounds_follow(grounds, robot);
}

const struct jp_skid_energy_model *jp_skid_grounds_model(const struct jp_skid_grounds *grounds,
                                                         const struct jp_skid_learner *robot, uint8_t ground)
{
    return grounds == NULL || ground == 0U || ground >= JP_GROUND_CLASSES ? &robot->model : &grounds->models[ground];
}

/* ---- Drives ---- */

void jp_skid_drive_add(struct jp_skid_drive *sum, const struct jp_skid_drive *drive, int64_t parts)
{
    sum->energy += drive->energy / parts;
    for (int j = 0; j < (int)JP_SKID_FACTORS; j++) {
        sum->change[j] += drive->change[j] / parts;
    }
    sum->slope_work += drive->slope_work / parts;
}

void jp_skid_ground_drive_total(const struct jp_skid_ground_drive *drive, struct jp_skid_drive *total)
{
    *total = drive->on[0];
    for (unsigned k = 1; k < JP_GROUND_CLASSES; k++) {
        jp_skid_drive_add(total, &drive->on[k], 1);
    }
}

static JP_INLINE_FOR_SPEED void set_change(struct jp_ground_change *change, const struct jp_skid_ground_drive *drive)
{
    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        change->by_factor[k][JP_GROUND_ROLLING] = drive->on[k].change[JP_SKID_ROLLING];
        change->by_factor[k][JP_GROUND_FRICTION] = drive->on[k].change[JP_SKID_FRICTION];
    }
}

static bool crosses_others(const struct jp_skid_ground_drive *drive)
{
    for (unsigned k = 1; k < JP_GROUND_CLASSES; k++) {
        if (drive->on[k].energy != 0) {
            return true;
        }
    }
    return false;
}

/* ---- Update ---- */

/** What is not known of the robot is noise to the grounds. */
static enum jp_status learn_grounds(struct jp_skid_grounds *grounds, const struct jp_skid_learner *robot,
                                    const struct jp_skid_ground_drive *drive, jp_q16 measured, enum jp_learned *learned)
{
    struct jp_ground_change change;
    struct jp_skid_ground_sum sum = {.robot = {.energy = 0}};
    struct jp_forecast expected;

    set_change(&change, drive);

    enum jp_status status = jp_skid_grounds_forecast_add(robot, &sum, drive);

    if (status == JP_OK) {
        status = jp_skid_forecast_total(robot, &sum.robot, &expected);
    }
    return status == JP_OK ? jp_ground_learner_update(&grounds->learner, &expected, &change, measured, learned)
                           : status;
}

enum jp_status jp_skid_grounds_update(struct jp_skid_grounds *grounds, struct jp_skid_learner *robot,
                                      const struct jp_skid_ground_drive *drive, jp_q16 measured,
                                      enum jp_learned *learned)
{
    if (robot == NULL || drive == NULL || learned == NULL) {
        return JP_ERR_ARGUMENT;
    }
    struct jp_skid_drive total;
    enum jp_status status = JP_OK;

    jp_skid_ground_drive_total(drive, &total);
    if (grounds != NULL && drive->at_edges * EDGES_MAX > total.energy) {
        *learned = JP_LEARNED_NOTHING;
    } else if (grounds != NULL && crosses_others(drive)) {
        status = learn_grounds(grounds, robot, drive, measured, learned);
    } else {
        status = jp_skid_learner_update(robot, &total, measured, learned);
    }
    if (grounds != NULL && status == JP_OK) {
        jp_skid_grounds_follow(grounds, robot);
    }
    return status;
}

/* ---- Forecast ---- */

enum jp_status jp_skid_grounds_forecast_add(const struct jp_skid_learner *robot, struct jp_skid_ground_sum *sum,
                                            const struct jp_skid_ground_drive *drive)
{
    if (robot == NULL || sum == NULL || drive == NULL) {
        return JP_ERR_ARGUMENT;
    }
    struct jp_ground_change change;
    struct jp_skid_drive total;

    set_change(&change, drive);
    jp_skid_ground_drive_total(drive, &total);

    const enum jp_status status = jp_skid_forecast_add(robot, &sum->robot, &total);

    if (status == JP_OK) {
        jp_ground_change_add(&sum->ground, &change);
    }
    return status;
}

enum jp_status jp_skid_grounds_forecast_total(const struct jp_skid_grounds *grounds,
                                              const struct jp_skid_learner *robot, const struct jp_skid_ground_sum *sum,
                                              struct jp_forecast *forecast)
{
    if (robot == NULL || sum == NULL || forecast == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const enum jp_status status = jp_skid_forecast_total(robot, &sum->robot, forecast);

    return status == JP_OK && grounds != NULL ? jp_ground_learner_widen(&grounds->learner, &sum->ground, forecast)
                                              : status;
}
