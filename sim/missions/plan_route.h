/** A route of the lattice with what it takes, step by step and in sum. */
#ifndef JOULEPATH_SIM_MISSIONS_PLAN_ROUTE_H
#define JOULEPATH_SIM_MISSIONS_PLAN_ROUTE_H

#include <stdio.h>

#include "sim/missions/plan_task.h"

/** Where the robot is after a primitive, and what it has taken so far. */
struct plan_step {
    struct jp_lattice_pose pose;
    double length; /**< m */
    double energy; /**< physical, J */
    double time;   /**< s */
};

struct plan_route {
    struct plan_step *steps; /**< the first is the start */
    size_t count;
    struct jp_lattice_pose *way; /**< every cell that its unit steps lead over, the first is the start */
    size_t way_count;
    double climb;          /**< sum of all rises, m */
    double turning_energy; /**< the part of the energy that turning takes, J */
    double level_energy;   /**< the energy, were the ground level, J */
};

/** Reads the plan that a planner has, over its lattice and its map; a plan without a route is the start alone. False
 * when there is no memory. */
bool plan_route_read(const struct jp_planner *planner, const struct jp_lattice *lattice,
                     const struct jp_terrain *terrain, const struct jp_lattice_pose *start, struct plan_route *route);

void plan_route_free(struct plan_route *route);

const struct plan_step *plan_route_end(const struct plan_route *route);

/** One row a step, in the map's frame. */
void plan_route_write(const struct plan_route *route, const struct map_file *map, const struct jp_lattice *lattice,
                      FILE *stream);

#endif
