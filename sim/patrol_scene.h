/**
 * Scenes for the patrol robot from a seed: what the planner's map shows, what is really there, what moves, and a task.
 * A seed gives the same scene everywhere.
 */
#ifndef JOULEPATH_SIM_PATROL_SCENE_H
#define JOULEPATH_SIM_PATROL_SCENE_H

#include <joulepath/obstacles.h>
#include <joulepath/terrain.h>

#include "patrol_world.h"

enum patrol_scene_kind {
    PATROL_BESIDE_OBSTACLE, /**< goal beside an obstacle that the map does not show (paper, Fig. 10) */
    PATROL_L_PASSAGE,       /**< narrow passage round a corner (paper, Fig. 11) */
    PATROL_CORRIDOR,        /**< narrow corridor, entered across (paper, Fig. 11) */
    PATROL_DOORWAY,         /**< two rooms and a door */
    PATROL_PEDESTRIAN,      /**< somebody crosses the way */
    PATROL_WAREHOUSE,       /**< aisles between shelves, pallets that the map does not show */
    PATROL_SCENES           /**< the kind of a scene on a map of others */
};

#define PATROL_SCENE_NAME_SIZE 64

struct patrol_scene {
    char name[PATROL_SCENE_NAME_SIZE]; /**< of the kind, or of the map */
    enum patrol_scene_kind kind;
    uint64_t seed;
    struct jp_terrain map;    /**< what the planner knows */
    struct jp_terrain ground; /**< what is there */
    struct patrol_obstacle movers[PATROL_OBSTACLES_MAX];
    size_t mover_count;
    struct jp_plane_pose start; /**< m and rad from the south-west corner */
    struct jp_plane_pose goal;
    double limit_s; /**< time in which a robot must arrive */
    void *block;    /**< of both maps */
};

extern const char *const patrol_scene_names[PATROL_SCENES];

/**
 * Makes a scene. All of it holds on the ground, with what stands there: the robot's true shape has 0.1 m to spare at
 * start and goal; it can turn in place at the start, and at the goal or on the straight way into it, with 0.05 m to
 * spare; a disc 0.2 m wider than the robot gets from start to goal. Who walks keeps 1.5 m off start and goal.
 */
void patrol_scene_make(enum patrol_scene_kind kind, uint64_t seed, struct patrol_scene *scene);

/** A scene on a map of others (map_file.h), with a task in the map's frame. False after one line on stderr. */
bool patrol_scene_load(const char *map_path, const struct planar_pose *start, const struct planar_pose *goal,
                       struct patrol_scene *scene);

void patrol_scene_free(struct patrol_scene *scene);

#endif
