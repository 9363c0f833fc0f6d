/** A map of the simulator's random hills. */
#ifndef JOULEPATH_TESTS_SUPPORT_SKID_HILLS_H
#define JOULEPATH_TESTS_SUPPORT_SKID_HILLS_H

#include <math.h>

#include "sim/skid_steer/skid_hills.h"
#include "unity.h"

/** Cells of a side of a map, and their side, m. */
#define SKID_MAP_SIDE 120
#define SKID_MAP_CELL 0.2

static uint64_t skid_map_block[SKID_MAP_SIDE * SKID_MAP_SIDE];

/** The hills, cell by cell. */
static inline void skid_make_map(struct jp_terrain *map, const struct skid_hills *hills)
{
    const struct jp_terrain_config config = {
        .width = SKID_MAP_SIDE, .height = SKID_MAP_SIDE, .resolution = JP_Q16(SKID_MAP_CELL), .has_elevation = true};
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(map, &config, skid_map_block, sizeof skid_map_block, &field));
    for (int32_t y = 0; y < SKID_MAP_SIDE; y++) {
        for (int32_t x = 0; x < SKID_MAP_SIDE; x++) {
            const struct skid_ground_point point =
                skid_on_hills(hills, (x + 0.5) * SKID_MAP_CELL, (y + 0.5) * SKID_MAP_CELL);
            const double units = fmin(fmax(point.elevation * JP_ELEVATION_ONE, -32000), 32000);
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(map, x, y, (jp_elevation)lround(units)));
        }
    }
}

#endif
