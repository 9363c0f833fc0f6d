/**
 * Scenes for the patrol robot from a seed: what the planner's map shows, what is really there, what moves, and a task.
 * A seed gives the same scene everywhere.
 */
#ifndef JOULEPATH_SIM_SCENES_PATROL_SCENE_H
#define JOULEPATH_SIM_SCENES_PATROL_SCENE_H

#include "sim/four_wheel/four_wheel_file.h"
#include "sim/scenes/patrol_task.h"

extern const char *const patrol_scene_names[PATROL_SCENES];

/**
 * Makes a scene. All of it holds on the ground, with what stands there: the robot's true shape has 0.1 m to spare at
 * start and goal; it can turn in place at the start, and at the goal or on the straight path into it, with 0.05 m to
 * spare; a disc 0.2 m wider than the robot gets from start to goal. Who walks keeps 1.5 m off start and goal.
 */
void patrol_scene_make(enum patrol_scene_kind kind, uint64_t seed, struct patrol_scene *scene);

/** A scene on a map of others (map_file.h), with a task in the map's frame. False after one line on stderr. */
bool patrol_scene_load(const char *map_path, const struct planar_pose *start, const struct planar_pose *goal,
                       struct patrol_scene *scene);

/** Gives a scene on a map of others a ground of its own, which may be changed: what is put on it the map does not show.
 *  False without memory. */
bool patrol_scene_part_ground(struct patrol_scene *scene);

/** Another place in the map's frame, from the scene's south-west corner. */
struct jp_plane_pose patrol_scene_place(const struct patrol_scene *scene, const struct planar_pose *place);

void patrol_scene_free(struct patrol_scene *scene);

/** The world of a scene: its ground, what moves, who walks, and the robot at its start. The scene stays in use. False
 *  without memory. */
bool patrol_scene_enter(const struct patrol_scene *scene, const struct four_wheel_file *robot,
                        struct patrol_world *world);

#endif
