/** A grid planner on a small map that is drawn, for the tests of its parts. */
#ifndef JOULEPATH_TESTS_SUPPORT_GRID_RIG_H
#define JOULEPATH_TESTS_SUPPORT_GRID_RIG_H

#include <joulepath/grid_planner.h>
#include <string.h>

#include "src/search/grid_search.h"
#include "tests/support/level_map.h"
#include "unity.h"

enum {
    BLOCK_BYTES = 6 * 1024,
    SIDE = 12, /* units of a cell in the tests of lines */
    SLICES_MAX = 100000,
    ROWS_MAX = 16,
};

#define CELL JP_Q16(0.2)

static struct jp_terrain_config map;
static struct jp_grid_planner_config config;
static struct jp_grid_planner planner;
static uint64_t block[BLOCK_BYTES / sizeof(uint64_t)];

static inline void rig_reset(void)
{
    map = (struct jp_terrain_config){.width = 8, .height = 8, .resolution = CELL};
    config = (struct jp_grid_planner_config){.method = JP_GRID_ANY_ANGLE, .tube = 2};
    memset(block, 0x5A, sizeof block);
    make_level_map(&map);
}

/** Rows from north to south, '@' is occupied; a null ends them. */
static inline void draw(const char *const *rows)
{
    uint16_t height = 0;

    while (rows[height] != NULL) {
        height++;
    }
    map.width = (uint16_t)strlen(rows[0]);
    map.height = height;
    make_level_map(&map);
    for (int32_t y = 0; y < height; y++) {
        for (int32_t x = 0; x < map.width; x++) {
            if (rows[height - 1 - y][x] == '@') {
                put_column(x, y, y, JP_CELL_OCCUPIED);
            }
        }
    }
}

#define DRAW(...)                                                                                                      \
    do {                                                                                                               \
        static const char *const rows[] = {__VA_ARGS__, NULL};                                                         \
        draw(rows);                                                                                                    \
    } while (0)

static inline enum jp_status init(size_t size, const char **field)
{
    return jp_grid_planner_init(&planner, &config, &terrain, block, size, field);
}

static inline void start_planner(void)
{
    const char *field = "";

    TEST_ASSERT_TRUE(jp_grid_planner_size(&config, &map) <= sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_OK, init(jp_grid_planner_size(&config, &map), &field));
    TEST_ASSERT_NULL(field);
}

static inline enum jp_status start_task(int start_x, int start_y, int goal_x, int goal_y)
{
    const struct jp_grid_cell start = {(int16_t)start_x, (int16_t)start_y};
    const struct jp_grid_cell goal = {(int16_t)goal_x, (int16_t)goal_y};

    return jp_grid_planner_start(&planner, &start, &goal);
}

static inline enum jp_grid_answer finish(unsigned slice)
{
    enum jp_grid_answer answer = JP_GRID_SEARCHING;

    for (int i = 0; answer == JP_GRID_SEARCHING; i++) {
        TEST_ASSERT_TRUE(i < SLICES_MAX);
        answer = jp_grid_planner_work(&planner, slice);
    }
    return answer;
}

static inline void begin(enum jp_grid_method method, int start_x, int start_y, int goal_x, int goal_y)
{
    config.method = method;
    start_planner();
    TEST_ASSERT_EQUAL_INT(JP_OK, start_task(start_x, start_y, goal_x, goal_y));
}

/** Works in slices of one unit until a function of the phase would be next. */
static inline void work_until(bool (*is_there)(void))
{
    for (int i = 0; !is_there(); i++) {
        TEST_ASSERT_TRUE(i < SLICES_MAX);
        TEST_ASSERT_EQUAL_INT(JP_GRID_SEARCHING, jp_grid_planner_work(&planner, 1));
    }
}

static inline struct jp_point centre(int x, int y)
{
    return (struct jp_point){x * map.resolution + map.resolution / 2, y * map.resolution + map.resolution / 2};
}

static inline void expect_point(const struct jp_point *point, int x, int y)
{
    const struct jp_point expected = centre(x, y);

    TEST_ASSERT_EQUAL_INT32(expected.x, point->x);
    TEST_ASSERT_EQUAL_INT32(expected.y, point->y);
}

/** The way's ends, that its lines are free, and its length. */
static inline jp_q16 expect_way(int start_x, int start_y, int goal_x, int goal_y)
{
    size_t count = 0;
    const struct jp_point *way = jp_grid_planner_path(&planner, &count);
    uint64_t length = 0;

    TEST_ASSERT_NOT_NULL(way);
    TEST_ASSERT_TRUE(count >= 1);
    expect_point(&way[0], start_x, start_y);
    expect_point(&way[count - 1], goal_x, goal_y);
    for (size_t i = 1; i < count; i++) {
        const int64_t dx = way[i].x - way[i - 1].x;
        const int64_t dy = way[i].y - way[i - 1].y;
        TEST_ASSERT_TRUE(jp_grid_planner_line_is_free(&planner, &way[i - 1], &way[i]));
        length += jp_square_root((uint64_t)(dx * dx + dy * dy));
    }
    return (jp_q16)(length * 65536U / (uint64_t)map.resolution);
}

static inline size_t way_count(void)
{
    size_t count = 99;

    (void)jp_grid_planner_path(&planner, &count);
    return count;
}

/** The optimum of every method, in straight and diagonal steps; the any-angle way is no longer. */
static inline void expect_optimum(int start_x, int start_y, int goal_x, int goal_y, uint32_t straight,
                                  uint32_t diagonal)
{
    const jp_q16 cost = (jp_q16)(straight * GRID_STRAIGHT + diagonal * GRID_DIAGONAL);

    for (enum jp_grid_method method = JP_GRID_OCTILE; method <= JP_GRID_ANY_ANGLE; method++) {
        begin(method, start_x, start_y, goal_x, goal_y);
        TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(7));
        TEST_ASSERT_EQUAL_INT32(cost, jp_grid_planner_statistics(&planner)->octile_length);
        const jp_q16 length = expect_way(start_x, start_y, goal_x, goal_y);
        TEST_ASSERT_TRUE(length <= cost);
        if (method != JP_GRID_ANY_ANGLE) {
            TEST_ASSERT_INT32_WITHIN(100, cost, length);
        }
    }
}

#endif
