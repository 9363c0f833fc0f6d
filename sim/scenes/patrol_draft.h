/**
 * A patrol scene in the making: laid out in cells of 0.05 m in a frame of its own, which a symmetry of the square puts
 * onto the map, so that every layout comes with both hands and in all four directions.
 */
#ifndef JOULEPATH_SIM_SCENES_PATROL_DRAFT_H
#define JOULEPATH_SIM_SCENES_PATROL_DRAFT_H

#include "sim/base/random.h"
#include "sim/scenes/patrol_task.h"

/** Of sim/robots/patrol.cfg. */
#define PATROL_ROBOT_LENGTH_M 0.8
#define PATROL_ROBOT_WIDTH_M  0.6

struct patrol_draft {
    struct patrol_scene *scene;
    struct random random;
    int width;         /**< of the layout, cells */
    int height;        /**< cells */
    unsigned symmetry; /**< bits: mirrored in x, mirrored in y, axes exchanged */
};

/** A rectangle of the layout. */
struct patrol_area {
    int x; /**< of its south-west cell */
    int y;
    int width; /**< cells */
    int height;
};

enum patrol_layer {
    PATROL_BOTH, /**< the planner's map and the ground */
    PATROL_GROUND
};

/** Uniform in low…high. */
int patrol_draft_between(struct patrol_draft *draft, int low, int high);

/** True once in `times`. */
bool patrol_draft_once_in(struct patrol_draft *draft, int times);

/** A side by lot: -1 or 1. */
int patrol_draft_side(struct patrol_draft *draft);

/** Begins anew with solid ground, a symmetry by lot, and nobody there. */
void patrol_draft_begin(struct patrol_draft *draft, int width, int height);

/** Sets all cells of an area of the layout. */
void patrol_draft_fill(struct patrol_draft *draft, enum patrol_layer layer, const struct patrol_area *area,
                       enum jp_cell cell);

/** From cells of the layout, and degrees there, to a pose on the map. */
struct jp_plane_pose patrol_draft_pose(const struct patrol_draft *draft, double x, double y, int heading);

/** Makes solid what a shape covers, its pose on the map; only on the ground. */
void patrol_draft_hide(struct patrol_draft *draft, const struct planar_shape *shape);

/** Adds something that stands or walks on the map. */
void patrol_draft_add(struct patrol_draft *draft, const struct patrol_obstacle *mover);

/** Adds somebody who walks; false: there are as many as can be. */
bool patrol_draft_add_person(struct patrol_draft *draft, const struct walker *person);

/** Whether a disc around a pose touches nothing on the ground and nothing that stands there. `radius`, m: 0…0.9. */
bool patrol_draft_has_room(const struct patrol_draft *draft, const struct jp_plane_pose *pose, double radius);

/** Whether the scene keeps the promises of patrol_scene.h. Work: some hundred times the cells. */
bool patrol_draft_is_sound(const struct patrol_draft *draft);

#endif
