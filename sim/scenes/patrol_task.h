/** What a patrol robot is put into: the planner's map, what is really there, what moves, and a task. */
#ifndef JOULEPATH_SIM_SCENES_PATROL_TASK_H
#define JOULEPATH_SIM_SCENES_PATROL_TASK_H

#include <joulepath/obstacles.h>
#include <joulepath/terrain.h>

#include "sim/scenes/patrol_world.h"

enum patrol_scene_kind {
    PATROL_BESIDE_OBSTACLE, /**< goal beside an obstacle that the map does not show (paper, Fig. 10) */
    PATROL_L_PASSAGE,       /**< narrow passage round a corner (paper, Fig. 11) */
    PATROL_CORRIDOR,        /**< narrow corridor, entered across (paper, Fig. 11) */
    PATROL_DOORWAY,         /**< two rooms and a door */
    PATROL_PEDESTRIAN,      /**< a person crosses the robot's path */
    PATROL_WAREHOUSE,       /**< aisles between shelves, pallets that the map does not show */
    PATROL_PEOPLE,          /**< a hall in which people walk, stop and turn round, alone and in groups */
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
    struct walker people[PATROL_PEOPLE_MAX];
    size_t people_count;
    struct jp_plane_pose start; /**< m and rad from the south-west corner */
    struct jp_plane_pose goal;
    struct planar_pose corner; /**< the south-west one, in the map's frame */
    double limit_s;            /**< time in which a robot must arrive */
    void *block;               /**< of both maps */
    void *ground_block;        /**< of a ground that has parted from its map */
};

#endif
