/**
 * Memory of a navigator, as large as the build says: JP_NAVIGATION_SIDE cells a side, JP_NAVIGATION_PLANNER KiB of the
 * planner. It may lie in two parts of a controller's memory.
 */
#ifndef JOULEPATH_HAL_APP_NAVIGATION_MEMORY_H
#define JOULEPATH_HAL_APP_NAVIGATION_MEMORY_H

#include "hal/app/navigation.h"

#ifndef JP_NAVIGATION_SIDE
#define JP_NAVIGATION_SIDE 192
#endif
#ifndef JP_NAVIGATION_PLANNER
#define JP_NAVIGATION_PLANNER 83
#endif

#define JP_NAVIGATION_LEGS 96U

/** Words of 64 bits of the two bit planes of a map, and of the three of a way on it. */
#define JP_NAVIGATION_WORDS     (((JP_NAVIGATION_SIDE + 31) / 32) * JP_NAVIGATION_SIDE)
#define JP_NAVIGATION_WAY_WORDS ((3 * JP_NAVIGATION_WORDS + 1) / 2)

struct jp_navigation_ground {
    uint64_t map[JP_NAVIGATION_WORDS];
    uint64_t way[JP_NAVIGATION_WAY_WORDS];
    struct jp_course_leg legs[JP_NAVIGATION_LEGS];
};

struct jp_navigation_block {
    uint64_t words[JP_NAVIGATION_PLANNER * 1024 / 8];
};

/** A configuration with this memory. */
static inline struct jp_navigation_config jp_navigation_config_of(const struct jp_lattice *lattice,
                                                                  const struct jp_navigator_body *body,
                                                                  struct jp_navigation_ground *ground,
                                                                  struct jp_navigation_block *block)
{
    return (struct jp_navigation_config){.lattice = lattice,
                                         .body = body,
                                         .map = ground->map,
                                         .map_size = sizeof ground->map,
                                         .planner = block->words,
                                         .planner_size = sizeof block->words,
                                         .way = ground->way,
                                         .way_size = sizeof ground->way,
                                         .legs = ground->legs,
                                         .legs_max = JP_NAVIGATION_LEGS};
}

#endif
