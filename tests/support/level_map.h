/** A small map, free and level, for the tests of the planner's parts. */
#ifndef JOULEPATH_TESTS_SUPPORT_LEVEL_MAP_H
#define JOULEPATH_TESTS_SUPPORT_LEVEL_MAP_H

#include <joulepath/terrain.h>

#include "unity.h"

/** 16 × 16 cells with elevation, if the test does not say otherwise. */
#ifndef LEVEL_MAP_BYTES
#define LEVEL_MAP_BYTES 768
#endif

static struct jp_terrain terrain;
static uint64_t terrain_block[LEVEL_MAP_BYTES / sizeof(uint64_t)];

static inline void make_level_map(const struct jp_terrain_config *config)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, config, terrain_block, sizeof terrain_block, &field));
    for (int32_t y = 0; y < config->height; y++) {
        for (int32_t x = 0; x < config->width; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, JP_CELL_FREE));
        }
    }
}

/** Occupies or frees a column of the map. */
static inline void put_column(int32_t x, int32_t first_y, int32_t last_y, enum jp_cell cell)
{
    for (int32_t y = first_y; y <= last_y; y++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, cell));
    }
}

/** Raises cells by a function of their place, in units of jp_elevation. */
static inline void raise_map(jp_elevation (*elevation)(int32_t x, int32_t y))
{
    for (int32_t y = 0; y < terrain.config.height; y++) {
        for (int32_t x = 0; x < terrain.config.width; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, x, y, elevation(x, y)));
        }
    }
}

#endif
