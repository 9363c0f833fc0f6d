/** A route of the lattice driven by a balancer in closed loop: waypoints, the simulator, and what became of it. */
#ifndef JOULEPATH_SIM_MISSIONS_PLAN_DRIVE_H
#define JOULEPATH_SIM_MISSIONS_PLAN_DRIVE_H

#include <joulepath/waypoints.h>

#include "sim/lattice/lattice_robot.h"
#include "sim/missions/mission.h"
#include "sim/missions/plan_search.h"

#define PLAN_SCENARIO_FILE "scenario.cfg"
#define PLAN_LOG_FILE      "drive.csv"

/** J, m and s. */
struct plan_sums {
    double energy;
    double length;
    double time;
};

/** What became of a route that was driven, by a robot of any kind. */
struct plan_driven {
    const struct clearance_pose *places; /**< that it was led to, in the grid's frame; the first is the start */
    size_t place_count;
    double margin_m; /**< least that a predicted segment keeps to obstacles */
    struct plan_sums predicted;
    struct plan_sums driven;
    double battery_energy;
    double end_error; /**< m from the goal */
    bool is_clear;    /**< it touched no obstacle */
    bool is_level;    /**< the simulated ground was */
};

struct plan_drive {
    const struct jp_energy_model *model;
    size_t waypoint_count;
    struct jp_waypoint waypoints[BEZIER_WAYPOINTS_MAX];
    struct clearance_pose places[BEZIER_WAYPOINTS_MAX]; /**< theirs in the grid's frame; the heading is the route's */
    double margin_m;                                    /**< least that a predicted segment keeps to obstacles */
    struct scenario scenario;                           /**< the same waypoints, as the robot's odometry sees them */
    struct mission mission;
    double length; /**< driven, m */
    bool is_clear; /**< the driven path touched no obstacle */
};

/** Turns a route into waypoints and a scenario. False after one line on stderr. */
bool plan_drive_prepare(const struct map_file *map, const struct jp_lattice *lattice, const struct lattice_robot *robot,
                        const struct plan_route *route, struct plan_drive *drive);

/** The scenario as a file for jp-mission. */
void plan_drive_write(const struct plan_drive *drive, const char *robot_path, FILE *stream);

/** Drives it, with the log of a mission. False after one line on stderr. */
bool plan_drive_run(const struct map_file *map, const struct lattice_robot *robot, struct plan_drive *drive, FILE *log);

/** Of the drive that was made. */
struct plan_driven plan_drive_result(const struct plan_drive *drive);

#endif
