/** A map of any size with any cells, and the shapes of a robot's lattice with any prices that pass. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_LATTICE_H
#define JOULEPATH_TESTS_PROOF_ANY_LATTICE_H

#include <joulepath/tables.h>

#include "tests/proof/any.h"

static uint64_t terrain_block[128];

/** As wide and as high as its block has room for. */
static struct jp_terrain *any_terrain(void)
{
    static struct jp_terrain terrain;
    struct jp_terrain_config config;
    const char *field;

    ANY(config);
    config.has_elevation = any_bool();
    config.unknown_is_free = any_bool();
    config.has_costs = any_bool();
    config.has_classes = any_bool();
    while (jp_terrain_init(&terrain, &config, terrain_block, sizeof terrain_block, &field) != JP_OK) {
        /* Another configuration. */
    }
    ANY_TIMES
    {
        const int32_t x = any_int();
        const int32_t y = any_int();

        (void)jp_terrain_set_cell(&terrain, x, y, (enum jp_cell)any_between(JP_CELL_FREE, JP_CELL_UNKNOWN));
        (void)jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)any_between(INT16_MIN, INT16_MAX));
        (void)jp_terrain_set_cost(&terrain, x, y, (uint8_t)any_unsigned(UINT8_MAX));
        (void)jp_terrain_set_class(&terrain, x, y, (uint8_t)any_unsigned(UINT8_MAX));
    }
    return &terrain;
}

static void any_lattice(struct jp_lattice *lattice)
{
    *lattice = jp_lattice_burger;
    for (unsigned kind = 0; kind < (unsigned)JP_COST_KINDS; kind++) {
        for (unsigned move = 0; move < (unsigned)JP_MOVE_KINDS; move++) {
            do {
                ANY(lattice->move_costs[kind][move]);
            } while (!jp_slope_cost_is_valid(&lattice->move_costs[kind][move]));
        }
    }
    for (unsigned i = 0; i < JP_GROUND_CLASSES; i++) {
        lattice->ground[i].straight = (uint16_t)any_unsigned(JP_GROUND_SHARE_MAX);
        lattice->ground[i].turning = (uint16_t)any_unsigned(JP_GROUND_SHARE_MAX);
    }
}

#endif
