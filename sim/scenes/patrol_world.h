/**
 * What the patrol robot moves among: a map, moving obstacles, people, and whether and how nearly it touched any.
 *
 * People (walker.h) do not look where the robot is, and stand where it is in their way. A touch with one of them is the
 * robot's doing where contact.h says so; any other touch always is.
 *
 * Shapes are true: the robot's rectangle, discs, boxes and the map's solid cells. Where their distance is 0 they touch.
 */
#ifndef JOULEPATH_SIM_SCENES_PATROL_WORLD_H
#define JOULEPATH_SIM_SCENES_PATROL_WORLD_H

#include <stdbool.h>

#include "sim/base/planar.h"
#include "sim/four_wheel/solid_map.h"
#include "sim/scenes/contact.h"
#include "sim/scenes/walker.h"

#define PATROL_OBSTACLES_MAX 32
#define PATROL_WAYPOINTS_MAX 8
#define PATROL_PEOPLE_MAX    CONTACT_PEOPLE
#define PATROL_SHAPES_MAX    (PATROL_OBSTACLES_MAX + PATROL_PEOPLE_MAX)

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

enum patrol_touch { PATROL_TOUCH_NONE, PATROL_TOUCH_MAP, PATROL_TOUCH_OBSTACLE, PATROL_TOUCH_PERSON };

enum patrol_meeting { PATROL_APART, PATROL_TOUCHING, PATROL_COLLIDING };

/** Touches with people, each counted once while it lasts. */
struct patrol_contacts {
    unsigned touches;
    unsigned moved_into; /**< of them, collisions of this kind */
    unsigned avoidable;  /**< of this kind: both is possible */
    unsigned collisions;
};

struct patrol_world {
    struct solid_map map;
    struct planar_shape robot;
    struct patrol_obstacle obstacles[PATROL_OBSTACLES_MAX];
    size_t obstacle_count;
    struct walker people[PATROL_PEOPLE_MAX];
    struct walker_state walks[PATROL_PEOPLE_MAX];
    size_t people_count;
    struct planar_shape shapes[PATROL_SHAPES_MAX]; /**< obstacles that are there now, in their order, then the people */
    struct planar_point velocities[PATROL_SHAPES_MAX]; /**< of the shapes, m/s */
    size_t thing_count;                                /**< of the shapes, without people */
    size_t shape_count;
    double time;         /**< s */
    double deceleration; /**< of the robot at its limit, m/s² */

    enum patrol_touch touch;       /**< now */
    enum patrol_touch first_touch; /**< PATROL_TOUCH_NONE: not yet */
    double first_touch_time;       /**< s */
    double distance_min;           /**< from things so far, m; at most PATROL_DISTANCE_MAX, 0 after a touch */
    double person_distance_min;    /**< from people, while the robot's own motion brought it nearer, likewise */
    struct patrol_contacts contacts;
    enum patrol_meeting touched[PATROL_PEOPLE_MAX];
    struct contact_history history;
    double slack; /**< the robot cannot touch anything before this much motion, m */
};

/** The map as it is now, nobody there, time 0, a robot of this size at `pose` that can brake at 1 m/s². False without
 *  memory. */
bool patrol_world_init(struct patrol_world *world, const struct jp_terrain *terrain, double length, double width,
                       const struct planar_pose *pose);

void patrol_world_free(struct patrol_world *world);

/** False when there are PATROL_OBSTACLES_MAX already. Before the first step. */
bool patrol_world_add(struct patrol_world *world, const struct patrol_obstacle *obstacle);

/** False when there are PATROL_PEOPLE_MAX already. Before the first step. */
bool patrol_world_add_person(struct patrol_world *world, const struct walker *person);

/** Obstacles and people move on for `seconds`, the robot is at `pose` then; touches and distances at that instant are
 * kept. */
void patrol_world_step(struct patrol_world *world, const struct planar_pose *pose, double seconds);

/** Whether the robot touches a solid cell, an obstacle or a person now. */
enum patrol_touch patrol_world_touch(const struct patrol_world *world);

/** Least distance of the robot from solid cells and obstacles now, not from people, m; at most `limit`, 0 when they
 *  overlap. */
double patrol_world_distance(const struct patrol_world *world, double limit);

#endif
