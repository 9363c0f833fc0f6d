/** What the map does not show: boxes that stand in the way which the robot would take by the map. */
#ifndef JOULEPATH_SIM_MISSIONS_NAVIGATION_WORLD_H
#define JOULEPATH_SIM_MISSIONS_NAVIGATION_WORLD_H

#include "sim/files/map_file.h"
#include "sim/missions/plan_search.h"

struct navigation_world {
    struct jp_terrain terrain;
    void *block;
};

/** The map with `boxes` more on it, 0.2 to 0.6 m a side, along the route over the map and beside it, none within a
 * metre of start and goal. False after one line on stderr: no memory, or start or goal are blocked. */
bool navigation_world_make(struct navigation_world *world, struct map_file *map, const struct jp_lattice *lattice,
                           const struct plan_task *task, unsigned boxes, uint64_t seed, size_t memory);

void navigation_world_free(struct navigation_world *world);

#endif
