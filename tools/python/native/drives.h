/** Drives in the simulator whose rows stay in memory. What a drive keeps is to be freed, done or not. */
#ifndef JOULEPATH_PYTHON_DRIVES_H
#define JOULEPATH_PYTHON_DRIVES_H

#include "sim/missions/mission.h"
#include "sim/missions/mission_log.h"
#include "sim/missions/patrol_mission.h"
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

/** Drives a scenario by a strategy of its robot's kind; rows of struct mission_row. False after one line (errors.h). */
bool drive_mission(struct rows *rows, struct mission *mission, enum mission_strategy strategy,
                   const struct scenario *scenario);

/** Drives the patrol robot through a scene; rows of struct patrol_row. False after one line (errors.h). */
bool drive_patrol(struct rows *rows, struct patrol_result *result, const struct four_wheel_file *robot,
                  enum patrol_scene_kind kind, enum patrol_method method, uint64_t seed);

#endif
