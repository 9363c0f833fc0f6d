/** Random ground for the plant of skid steer and differential drive: hills, and a map of them. */
#ifndef JOULEPATH_TESTS_SUPPORT_SKID_HILLS_H
#define JOULEPATH_TESTS_SUPPORT_SKID_HILLS_H

#include <math.h>

#include "sim/base/random.h"
#include "sim/skid_steer/skid_ground.h"
#include "unity.h"

#define SKID_HILLS 3

/** Cells of a side of a map, and their side, m. */
#define SKID_MAP_SIDE 120
#define SKID_MAP_CELL 0.2

/** Waves of 4 to 12 m. */
struct skid_hills {
    double height[SKID_HILLS];
    double number[SKID_HILLS]; /* rad/m */
    double turn[SKID_HILLS];
};

static inline struct skid_ground_point skid_on_hills(const void *context, double x, double y)
{
    const struct skid_hills *hills = context;
    struct skid_ground_point point = {0, 0, 0};

    for (int i = 0; i < SKID_HILLS; i++) {
        const double ahead = hills->number[i] * cos(hills->turn[i]);
        const double across = hills->number[i] * sin(hills->turn[i]);
        const double phase = ahead * x + across * y;
        point.elevation += hills->height[i] * sin(phase);
        point.slope_x += hills->height[i] * ahead * cos(phase);
        point.slope_y += hills->height[i] * across * cos(phase);
    }
    return point;
}

/** `steepest`: the slope that they cannot exceed. */
static inline struct skid_hills skid_random_hills(struct random *noise, double steepest)
{
    struct skid_hills hills;

    for (int i = 0; i < SKID_HILLS; i++) {
        hills.number[i] = 2 * M_PI / random_uniform(noise, 4, 12);
        hills.turn[i] = random_uniform(noise, -M_PI, M_PI);
        hills.height[i] = random_uniform(noise, 0, steepest / SKID_HILLS) / hills.number[i];
    }
    return hills;
}

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
