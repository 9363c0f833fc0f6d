/**
 * What the patrol robot moves among: a map, moving obstacles, and whether and how nearly it touched any.
 *
 * Nobody walks into the robot: who would within 0.4 m waits. So a touch is the robot's doing.
 *
 * Shapes are true: the robot's rectangle, discs, boxes and the map's solid cells. libccd decides whether they touch.
 */
#ifndef JOULEPATH_SIM_SCENES_PATROL_WORLD_H
#define JOULEPATH_SIM_SCENES_PATROL_WORLD_H

#include <stdbool.h>

#include "sim/base/planar.h"
#include "sim/four_wheel/solid_map.h"

#define PATROL_OBSTACLES_MAX 32
#define PATROL_WAYPOINTS_MAX 8

/** Larger distances are told as this, m. */
#define PATROL_DISTANCE_MAX 1.0

enum patrol_end {
    PATROL_STOPS,   /**< at the last waypoint */
    PATROL_RETURNS, /**< goes back along the same path, for ever */
    PATROL_LOOPS    /**< goes on to the first waypoint, for ever */
};

struct patrol_obstacle {
    struct planar_shape shape; /**< its pose is not used; a box looks where it goes */
    struct planar_point waypoints[PATROL_WAYPOINTS_MAX];
    size_t waypoint_count; /**< at least 1; with 1 it stands, heading 0 */
    double speed;          /**< m/s; 0 or more */
    double appears;        /**< when it is there, s */
    double starts;         /**< when it starts from the first waypoint, s */
    enum patrol_end end;
};

enum patrol_touch { PATROL_TOUCH_NONE, PATROL_TOUCH_MAP, PATROL_TOUCH_OBSTACLE };

struct patrol_world {
    struct solid_map map;
    struct planar_shape robot;
    struct patrol_obstacle obstacles[PATROL_OBSTACLES_MAX];
    size_t obstacle_count;
    struct planar_shape shapes[PATROL_OBSTACLES_MAX];     /**< those that are there now, in the order of `obstacles` */
    struct planar_point velocities[PATROL_OBSTACLES_MAX]; /**< of the shapes, m/s */
    size_t shape_count;
    double time; /**< s */

    enum patrol_touch touch;       /**< now */
    enum patrol_touch first_touch; /**< PATROL_TOUCH_NONE: not yet */
    double first_touch_time;       /**< s */
    double distance_min;           /**< so far, m; at most PATROL_DISTANCE_MAX, 0 after a touch */
    double slack;                  /**< the robot cannot touch anything before this much motion, m */
};

/** The map as it is now, no obstacles, time 0, a robot of this size at `pose`. False without memory. */
bool patrol_world_init(struct patrol_world *world, const struct jp_terrain *terrain, double length, double width,
                       const struct planar_pose *pose);

void patrol_world_free(struct patrol_world *world);

/** False when there are PATROL_OBSTACLES_MAX already. Before the first step. */
bool patrol_world_add(struct patrol_world *world, const struct patrol_obstacle *obstacle);

/** Obstacles move on for `seconds`, the robot is at `pose` then; touches and distances at that instant are kept. */
void patrol_world_step(struct patrol_world *world, const struct planar_pose *pose, double seconds);

/** Whether the robot touches a solid cell or an obstacle now, by libccd alone. */
enum patrol_touch patrol_world_touch(const struct patrol_world *world);

/** Least distance of the robot from solid cells and obstacles now, m; at most `limit`, 0 when they overlap. */
double patrol_world_distance(const struct patrol_world *world, double limit);

#endif
