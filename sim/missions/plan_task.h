/** Where a plan starts and ends: given in m of the map's frame, or chosen far apart. */
#ifndef JOULEPATH_SIM_MISSIONS_PLAN_TASK_H
#define JOULEPATH_SIM_MISSIONS_PLAN_TASK_H

#include <joulepath/planner.h>

#include "sim/base/clearance.h"
#include "sim/files/map_file.h"

/** In the map's frame. */
struct plan_place {
    double x; /**< m */
    double y;
    double heading_deg;
    bool has_heading;
};

struct plan_task {
    struct jp_lattice_pose start;
    struct jp_goal goal;
    bool is_chosen; /**< by plan_task_choose() */
};

/** Reads "x,y" or "x,y,degrees"; false when `text` is neither. */
bool plan_place_parse(const char *text, struct plan_place *place);

/** The cells and the nearest headings of two places; a goal without a heading is good to reach with any. False after
 *  one line on stderr when a place is off the map. */
bool plan_task_set(const struct map_file *map, const struct jp_lattice *lattice, const struct plan_place *start,
                   const struct plan_place *goal, struct plan_task *task);

/** Two cells far apart in the largest part of the map in which the robot can turn round everywhere, the start's heading
 *  towards the goal. Every time the same. False after one line on stderr when there are none. */
bool plan_task_choose(const struct map_file *map, const struct jp_lattice *lattice, struct plan_task *task);

/** Centre of a cell with a heading of the lattice, in the grid's frame. */
struct clearance_pose plan_grid_pose(const struct map_file *map, const struct jp_lattice *lattice,
                                     const struct jp_lattice_pose *pose);

/** The same place in the map's frame. */
struct plan_place plan_map_place(const struct map_file *map, const struct clearance_pose *pose);

#endif
