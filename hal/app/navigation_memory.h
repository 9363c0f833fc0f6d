/**
 * Memory of a navigator, as large as the build says: JP_NAVIGATION_SIDE cells a side, JP_NAVIGATION_PLANNER KiB of the
 * planner. It may lie in two parts of a controller's memory.
 *
 * That of the way home is apart: 52 bytes a cell, 1.8 MiB for 192 cells a side. A host has it, and a Cortex-M7 with
 * memory on its bus; in the 192 KiB of an STM32F405 it would leave a map of 40 cells a side nothing to plan with.
 */
#ifndef JOULEPATH_HAL_APP_NAVIGATION_MEMORY_H
#define JOULEPATH_HAL_APP_NAVIGATION_MEMORY_H

#include "hal/app/navigation.h"

#ifndef JP_NAVIGATION_SIDE
#define JP_NAVIGATION_SIDE 192
#endif
#ifndef JP_NAVIGATION_PLANNER
#define JP_NAVIGATION_PLANNER 74
#endif

#define JP_NAVIGATION_LEGS 96U

/** Words of 64 bits of the two bit planes of a map, and of the three of a way on it. */
#define JP_NAVIGATION_WORDS     (((JP_NAVIGATION_SIDE + 31) / 32) * JP_NAVIGATION_SIDE)
#define JP_NAVIGATION_WAY_WORDS ((3 * JP_NAVIGATION_WORDS + 1) / 2)

/** Bytes of two bits for each cell that was seen. */
#define JP_NAVIGATION_SEEN ((JP_NAVIGATION_SIDE + 3) / 4 * JP_NAVIGATION_SIDE)

struct jp_navigation_ground {
    uint64_t map[JP_NAVIGATION_WORDS];
    uint64_t way[JP_NAVIGATION_WAY_WORDS];
    uint8_t seen[JP_NAVIGATION_SEEN];
    struct jp_course_leg legs[JP_NAVIGATION_LEGS];
};

struct jp_navigation_block {
    uint64_t words[JP_NAVIGATION_PLANNER * 1024 / 8];
};

/** Words of the field of the way home: three bytes and two bits for each cell and heading. */
#define JP_NAVIGATION_POSES (JP_NAVIGATION_SIDE * JP_NAVIGATION_SIDE * JP_HEADINGS)
#define JP_NAVIGATION_FIELD_WORDS                                                                                      \
    ((2 * JP_NAVIGATION_POSES + 7) / 8 + (JP_NAVIGATION_POSES + 7) / 8 +                                               \
     ((JP_NAVIGATION_SIDE * JP_HEADINGS + 31) / 32 * JP_NAVIGATION_SIDE * 4 + 7) / 8 +                                 \
     (JP_NAVIGATION_SIDE + 31) / 32 * JP_NAVIGATION_SIDE * JP_HEADINGS / 2)

struct jp_navigation_home_memory {
    struct jp_home home;
    struct jp_course_leg legs[JP_NAVIGATION_LEGS];
    uint64_t field[JP_NAVIGATION_FIELD_WORDS];
};

/** A home in this memory that does not turn back by itself. */
static inline struct jp_navigation_home jp_navigation_home_of(struct jp_navigation_home_memory *memory,
                                                              struct jp_ecu_battery *battery, jp_q31 confidence)
{
    return (struct jp_navigation_home){.home = &memory->home,
                                       .block = memory->field,
                                       .size = sizeof memory->field,
                                       .legs = memory->legs,
                                       .legs_max = JP_NAVIGATION_LEGS,
                                       .battery = battery,
                                       .confidence = confidence,
                                       .turns_back = false};
}

/** A configuration with this memory, and without a home. */
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
                                         .seen = ground->seen,
                                         .seen_size = sizeof ground->seen,
                                         .legs = ground->legs,
                                         .legs_max = JP_NAVIGATION_LEGS,
                                         .home = NULL};
}

#endif
