/** What the map does not show: boxes that stand in the way which the robot would take by the map. */
#ifndef JOULEPATH_SIM_MISSIONS_NAVIGATION_WORLD_H
#define JOULEPATH_SIM_MISSIONS_NAVIGATION_WORLD_H

#include "sim/files/map_file.h"
#include "sim/missions/plan_search.h"

struct navigation_world {
    struct jp_terrain solid;   /**< what can be touched */
    struct jp_terrain terrain; /**< that and what is too steep */
    void *blocks[2];
    jp_q24 steepest;      /**< ground on which the robot may be, rise over run */
    unsigned steep_cells; /**< of the map */
};

/** The world that a map shows, whose ground that is steeper than `steepest` is blocked then. False after one line on
 *  stderr: no memory. */
bool navigation_world_init(struct navigation_world *world, struct map_file *map, double steepest);

/** Puts `boxes` into it that the map does not show, 0.2 to 0.6 m a side, along the route over the map and beside it,
 * none within a metre of start and goal. False after one line on stderr: start or goal are blocked. */
bool navigation_world_hide(struct navigation_world *world, struct map_file *map, const struct jp_lattice *lattice,
                           const struct plan_task *task, unsigned boxes, uint64_t seed, size_t memory);

void navigation_world_free(struct navigation_world *world);

#endif
