/** One scenario driven by one strategy, in closed loop, with what it planned and what it spent. */
#ifndef JOULEPATH_SIM_MISSION_H
#define JOULEPATH_SIM_MISSION_H

#include <stdio.h>

#include "rig.h"
#include "scenario.h"

/** Log rows a second. */
#define MISSION_LOG_RATE 50

enum mission_strategy {
    MISSION_OPTIMAL,     /**< jp_robot_follow: each segment planned for least energy */
    MISSION_STRAIGHT,    /**< straight chords, with the times of the optimal mission */
    MISSION_BEZIER,      /**< energy-optimised cubic Bézier curves, one after the other */
    MISSION_BEZIER_ROUTE /**< energy-optimised cubic Bézier curves, the whole route together */
};
#define MISSION_STRATEGIES 4

/** One leg from waypoint to waypoint. */
struct mission_leg {
    struct bezier_point target;
    bool planned;            /**< one segment, planned before it was driven: the plan below holds */
    double planned_energy;   /**< J */
    double speed;            /**< v, m/s */
    double turn_rate;        /**< w, rad/s */
    double arc;              /**< γ, rad */
    double turn;             /**< σ, rad */
    double duration;         /**< T, s */
    double measured_energy;  /**< the robot's meter, the paper's definition, J */
    double plant_energy;     /**< the same from the plant's ledger in double, J */
    double battery_energy;   /**< the robot's meter, at the battery, J */
    struct bezier_point end; /**< where the robot was, m */
    double end_error;        /**< distance to the target, m */
};

struct mission {
    enum mission_strategy strategy;
    size_t leg_count;
    struct mission_leg legs[BEZIER_WAYPOINTS_MAX];
    struct mission_leg total; /**< sums; end and end_error of the last leg */
    uint64_t ticks;
    uint64_t saturated_ticks;
    double wall_seconds;
};

/** Who looks on; members that are NULL do not. */
struct mission_view {
    FILE *log;            /**< takes a row every 1/MISSION_LOG_RATE s */
    const char *progress; /**< name of the bar */
    /** Called every tick with where the robot is, m and rad. */
    void (*watch)(void *context, struct bezier_point position, double heading);
    void *context;
};

/**
 * Drives the scenario and fills *mission. `optimal` is the mission already driven by MISSION_OPTIMAL, whose times
 * MISSION_STRAIGHT takes; NULL for the others. `view` may be NULL. False after one line on stderr.
 */
bool mission_run(struct mission *mission, enum mission_strategy strategy, const struct scenario *scenario,
                 const struct mission *optimal, const struct mission_view *view);

#endif
