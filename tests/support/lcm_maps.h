/** Packets of maps, cells and goals on a map, as a team on LCM sends them. */
#ifndef JOULEPATH_TESTS_SUPPORT_LCM_MAPS_H
#define JOULEPATH_TESTS_SUPPORT_LCM_MAPS_H

#include <jp_cells_t.h>
#include <jp_map_goal_t.h>
#include <jp_map_t.h>
#include <lcm/lcm.h>
#include <stdlib.h>

#include "unity.h"

struct long_packet {
    uint8_t *bytes;
    size_t size;
};

/** All of it free, with the robot at (1.05, 1.05) m. */
static inline jp_map_t free_map(int16_t width, int16_t height)
{
    jp_map_t map = {.map_id = 1,
                    .width = width,
                    .height = height,
                    .resolution = 0.1,
                    .origin = {1.05, 1.05},
                    .cells = calloc((size_t)height, sizeof(uint8_t *))};

    for (int16_t y = 0; y < height; y++) {
        map.cells[y] = calloc((size_t)width, 1);
    }
    return map;
}

static inline void free_cells(const jp_map_t *map)
{
    for (int16_t y = 0; y < map->height; y++) {
        free(map->cells[y]);
    }
    free(map->cells);
}

/** The caller frees its bytes. */
static inline struct long_packet map_packet(const jp_map_t *map)
{
    struct long_packet packet = {.size = (size_t)jp_map_t_encoded_size(map)};

    packet.bytes = malloc(packet.size);
    TEST_ASSERT_NOT_NULL(packet.bytes);
    TEST_ASSERT_EQUAL_INT(packet.size, jp_map_t_encode(packet.bytes, 0, (int)packet.size, map));
    return packet;
}

static inline void publish_map(lcm_t *lcm, const jp_map_t *map)
{
    TEST_ASSERT_EQUAL_INT(0, jp_map_t_publish(lcm, "JP_MAP", map));
}

/** `count` cells of a row from (x, y) on. */
static inline void publish_row(lcm_t *lcm, int16_t map_id, int16_t x, int16_t y, int16_t count, int8_t cell)
{
    jp_cell_t row[64];
    const jp_cells_t cells = {.map_id = map_id, .count = count, .cells = row};

    TEST_ASSERT_TRUE(count <= 64);
    for (int16_t i = 0; i < count; i++) {
        row[i] = (jp_cell_t){.x = (int16_t)(x + i), .y = y, .cell = cell};
    }
    TEST_ASSERT_EQUAL_INT(0, jp_cells_t_publish(lcm, "JP_CELLS", &cells));
}

static inline void publish_goal(lcm_t *lcm, int16_t map_id, double x, double y)
{
    const jp_map_goal_t goal = {.map_id = map_id, .point = {x, y}};

    TEST_ASSERT_EQUAL_INT(0, jp_map_goal_t_publish(lcm, "JP_MAP_GOAL", &goal));
}

#endif
