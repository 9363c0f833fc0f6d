/** A map of any size that fits its block, with any cells. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_TERRAIN_H
#define JOULEPATH_TESTS_PROOF_ANY_TERRAIN_H

#include <joulepath/terrain.h>

#include "tests/proof/any.h"

static uint64_t terrain_block[128];

static void any_terrain_config(struct jp_terrain_config *config)
{
    ANY(*config);
    config->has_elevation = any_bool();
    config->unknown_is_free = any_bool();
    config->has_costs = any_bool();
    config->has_classes = any_bool();
}

/** Of any cell, on the map and beside it. */
static void any_cell(struct jp_terrain *terrain)
{
    const int32_t x = any_int();
    const int32_t y = any_int();

    (void)jp_terrain_set_cell(terrain, x, y, (enum jp_cell)any_between(JP_CELL_FREE, JP_CELL_UNKNOWN + 1));
    (void)jp_terrain_set_elevation(terrain, x, y, (jp_elevation)any_between(INT16_MIN, INT16_MAX));
    (void)jp_terrain_set_cost(terrain, x, y, (uint8_t)any_unsigned(UINT8_MAX));
    (void)jp_terrain_set_class(terrain, x, y, (uint8_t)any_unsigned(UINT8_MAX));
}

static bool is_side(uint16_t cells)
{
    return cells >= 1U && cells <= JP_TERRAIN_SIDE_MAX;
}

/** As wide and as high as its block has room for. */
static struct jp_terrain *any_terrain(void)
{
    static struct jp_terrain terrain;
    struct jp_terrain_config config;
    const char *field;

    any_terrain_config(&config);
    while (jp_terrain_init(&terrain, &config, terrain_block, sizeof terrain_block, &field) != JP_OK) {
        /* Another configuration. */
    }
    while (!is_side(terrain.config.width) || !is_side(terrain.config.height)) {
        /* It has refused these; the analyser forgets that. */
    }
    ANY_TIMES
    {
        any_cell(&terrain);
    }
    return &terrain;
}

#endif
