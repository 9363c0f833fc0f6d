/** A small map with any cells, where the analyser could not tell of a map of any size what lies on it. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_SMALL_MAP_H
#define JOULEPATH_TESTS_PROOF_ANY_SMALL_MAP_H

#include <joulepath/lattice.h>

#include "tests/proof/any_field.h"

/** Its cells a side, and their side. */
#define SMALL_SIDE 4
#define SMALL_CELL JP_Q16(0.05)

static inline struct jp_terrain *small_terrain(void)
{
    static struct jp_terrain terrain;
    struct jp_terrain_config config;
    const char *field;

    any_terrain_config(&config);
    config.width = SMALL_SIDE;
    config.height = SMALL_SIDE;
    config.resolution = SMALL_CELL;
    while (jp_terrain_init(&terrain, &config, terrain_block, sizeof terrain_block, &field) != JP_OK) {
        /* Its other members are refused. */
    }
    ANY(terrain_block);
    return &terrain;
}

/** On it. */
static inline void small_point(struct jp_point *point)
{
    point->x = any_between(0, SMALL_SIDE * SMALL_CELL - 1);
    point->y = any_between(0, SMALL_SIDE * SMALL_CELL - 1);
}

static inline void small_field_map(void)
{
    field_map = small_terrain();
    any_lattice(&field_lattice);
}

#endif
