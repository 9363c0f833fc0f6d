/**
 * What the navigator asks of a robot, whatever its kind. Points and headings count from the origin of its odometry.
 * All of it runs in the background, between the ticks of the robot.
 */
#ifndef JOULEPATH_VEHICLE_H
#define JOULEPATH_VEHICLE_H

#include <joulepath/ground.h>
#include <joulepath/learner.h>
#include <joulepath/trajectory.h>

#ifdef __cplusplus
extern "C" {
#endif

enum jp_vehicle_phase {
    JP_VEHICLE_OFF,      /**< its motors are off; it must be enabled before it can be driven */
    JP_VEHICLE_STANDING, /**< still, and nothing of what it was told is left to do */
    JP_VEHICLE_MOVING
};

/** Steps by which a run can be slowed down. */
#define JP_VEHICLE_SLOWER_MAX 8U

/** Where it is. */
struct jp_vehicle_view {
    enum jp_vehicle_phase phase;
    struct jp_point position;
    jp_angle heading;
    jp_q16 spent; /**< since any moment, J in the unit of the vehicle's energy model, wrapping; always the same: it does
                       not count, and the navigator learns nothing of what drives take */
};

/** From a stand to a stand: a turn towards the first target, then along straight lines, but for the corners. */
struct jp_vehicle_run {
    struct jp_point start;
    jp_angle heading; /**< before the turn */
    const struct jp_point *targets;
    uint16_t count;                 /**< at least 1 */
    uint8_t slower;                 /**< than as costs least, by so many steps; 0…JP_VEHICLE_SLOWER_MAX */
    const struct jp_ground *ground; /**< null: level */
};

/** A kind of robot. `context` is handed to each function. */
struct jp_vehicle {
    void *context;
    void (*look)(void *context, struct jp_vehicle_view *view);
    /** A slice of its own background work. Fails when what it was told cannot be done; it then stands, or will. */
    enum jp_status (*work)(void *context);
    /** Turns on the spot, on ground that may be null; a large turn may take several calls, each from a stand.
     *  JP_ERR_STATE: it is not standing. */
    enum jp_status (*turn)(void *context, jp_angle heading, const struct jp_ground *ground);
    /** Drives a run, towards whose first target it looks; start and heading are as it stands. The targets must stay.
     *  JP_ERR_STATE: it is not standing. */
    enum jp_status (*follow)(void *context, const struct jp_vehicle_run *run);
    /** Brakes to a stand. */
    void (*stop)(void *context);
    /** Begins to survey a run, after those that were surveyed to their ends; `anew`: it is the first. One that starts
     *  where the last one did takes its place: it is surveyed again. The targets must stay until it is surveyed.
     * JP_ERR_INFEASIBLE: as survey_leg. */
    enum jp_status (*survey)(void *context, const struct jp_vehicle_run *run, bool anew);
    /** Surveys the next leg of the run: what ground it takes. JP_ERR_INFEASIBLE: it cannot drive the
     *  run without a stand, nor one of one leg at any pace. JP_ERR_ZERO_LENGTH: a leg is shorter than 1 mm. */
    enum jp_status (*survey_leg)(void *context, struct jp_leg_extent *extent);
    /** What the runs that were surveyed take: s, and J in the unit of the vehicle's energy model. */
    void (*forecast)(void *context, jp_q16 *duration, struct jp_forecast *energy);
};

#ifdef __cplusplus
}
#endif

#endif
