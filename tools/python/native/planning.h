/** A planner with its map, its block and its task: one call for what takes several in C. */
#ifndef JOULEPATH_PYTHON_PLANNING_H
#define JOULEPATH_PYTHON_PLANNING_H

#include <joulepath/planner.h>
#include <stdbool.h>
#include <stddef.h>

#include "sim/files/map_file.h"
#include "sim/missions/plan_route.h"
#include "sim/missions/plan_task.h"

struct planning {
    struct jp_planner planner;
    struct map_file *map;
    const struct jp_lattice *lattice;
    struct plan_task task;
    enum jp_answer answer; /**< of the last work */
    void *block;
};

/** `epsilon` falls from level to level, 1 to JP_EPSILON_LEVELS of them; `memory`: of the block, bytes. False after one
 * line (errors.h); planning_free() in any case. */
bool planning_begin(struct planning *planning, struct map_file *map, const struct jp_lattice *lattice,
                    enum jp_cost_kind cost, const double *epsilon, size_t levels, size_t memory);

/** From x and y, m, and heading, degrees, to x and y with or without a heading. False after one line (errors.h). */
bool planning_set_task(struct planning *planning, const double start[3], const double *goal, size_t goal_count);

/** Two places far apart. False after one line (errors.h). */
bool planning_choose_task(struct planning *planning);

/** Searches on. True: more work cannot improve the answer. */
bool planning_work(struct planning *planning, unsigned expansions);

/** To be freed by plan_route_free(). False after one line (errors.h). */
bool planning_read(const struct planning *planning, struct plan_route *route);

void planning_free(struct planning *planning);

#endif
