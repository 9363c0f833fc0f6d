/** Drives in the simulator whose rows stay in memory. What a drive keeps is to be freed, done or not. */
#ifndef JOULEPATH_PYTHON_DRIVES_H
#define JOULEPATH_PYTHON_DRIVES_H

#include "sim/missions/mission.h"
#include "sim/missions/mission_log.h"
#include "sim/lattice/lattice_robot.h"
#include "sim/missions/navigation_task.h"
#include "sim/missions/patrol_mission.h"
#include "sim/missions/plan_task.h"
#include "tools/python/native/rows.h"

/** A cycle of the patrol robot. */
struct patrol_row {
    double time; /**< s */
    double x;    /**< where it is, m from the south-west corner, and rad */
    double y;
    double heading;
    double believed_x; /**< where it believes to be */
    double believed_y;
    double believed_heading;
    double speed;     /**< m/s, ahead */
    double turn_rate; /**< rad/s */
    double clearance; /**< of its true shape, m */
    double energy;    /**< J */
    int state;        /**< enum jp_patrol_state */
};

/** What the navigator is asked. */
struct navigator_drive {
    struct map_file *map; /**< that the robot has; it learns what it sees, and of ground that is too steep */
    const struct lattice_robot *robot;
    const struct jp_lattice *lattice;
    struct plan_task places;
    unsigned hidden; /**< boxes that the map does not show */
    double view_m;   /**< how far it sees */
    size_t memory;   /**< of the planner, bytes */
    uint64_t seed;   /**< of the boxes and the sensors' noise */
};

/** 20 times a second. */
struct navigator_row {
    double time; /**< s */
    double x;    /**< where it is, m from the south-west corner, and rad */
    double y;
    double heading;
    double energy; /**< J */
    double left;   /**< m to the goal, by its course */
    int state;     /**< enum jp_navigator_state */
    int replans;
};

/** Drives a scenario by a strategy of its robot's kind; rows of struct mission_row. False after one line (errors.h). */
bool drive_mission(struct rows *rows, struct mission *mission, enum mission_strategy strategy,
                   const struct scenario *scenario);

/** Drives the patrol robot through a scene; rows of struct patrol_row. False after one line (errors.h). */
bool drive_patrol(struct rows *rows, struct patrol_result *result, const struct four_wheel_file *robot,
                  enum patrol_scene_kind kind, enum patrol_method method, uint64_t seed);

/** Lets a robot find its way, as jp-navigate does; rows of struct navigator_row. False after one line (errors.h). */
bool drive_navigator(struct rows *rows, struct navigation_result *result, const struct navigator_drive *drive);

#endif
