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

/** One row of the log. */
struct mission_row {
    double time; /**< since the start, s */
    struct bezier_point position;
    struct bezier_point reference;
    double heading;   /**< rad */
    double speed;     /**< m/s */
    double turn_rate; /**< rad/s */
    double reference_speed;
    double reference_turn_rate;
    double pitch_deg;
    double voltage_left; /**< V */
    double voltage_right;
    double current_left; /**< A */
    double current_right;
    double power;  /**< W, the paper's definition */
    double energy; /**< since the start, J */
    size_t leg;    /**< from 0 */
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

/** For missions that are driven otherwise: the log, the sums of the legs, the clock in seconds. */
void mission_log_header(FILE *log);
void mission_log_row(FILE *log, const struct mission_row *row);
void mission_sum_up(struct mission *mission);
double mission_wall_clock(void);

#endif
