/* Ways of unit steps against a relaxation of all cells until nothing changes. */
#include <joulepath/lattice_way.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "tests/support/level_map.h"
#include "tests/support/way_oracle.h"
#include "tests/target/random.h"
#include "unity.h"

enum { SIDE = 24, SMALL_SIDE = 16, MAPS = 60, WORK_MAX = 4000, FREE_CELL_PERCENT = 96 };

static const struct jp_lattice *lattice = &jp_lattice_courier24;

static struct jp_terrain_config map;
static struct jp_lattice_way way;
static uint64_t block[3 * SIDE * SIDE / 64 + 1];
static uint32_t random_state = 1;

static uint32_t random_below(uint32_t bound)
{
    return target_random(&random_state) % bound;
}

static void make_map(int side, bool has_elevation)
{
    map = (struct jp_terrain_config){.width = (uint16_t)side,
                                     .height = (uint16_t)side,
                                     .resolution = lattice->resolution,
                                     .has_elevation = has_elevation};
    make_level_map(&map);
}

void setUp(void)
{
    lattice = &jp_lattice_courier24;
    make_map(SIDE, false);
}

void tearDown(void)
{
}

static enum jp_status start(int16_t x, int16_t y, int16_t goal_x, int16_t goal_y)
{
    return jp_lattice_way_start(&way, lattice, &terrain, &(struct jp_way_cell){x, y},
                                &(struct jp_way_cell){goal_x, goal_y}, block, sizeof block);
}

static enum jp_way_answer answer(unsigned looks)
{
    for (unsigned i = 0; i < WORK_MAX; i++) {
        const enum jp_way_answer now = jp_lattice_way_work(&way, looks);
        if (now != JP_WAY_WORKING) {
            return now;
        }
    }
    return JP_WAY_WORKING;
}

/* ---- Tests ---- */

static void test_size_is_three_bits_a_cell(void)
{
    TEST_ASSERT_EQUAL_UINT32(3 * 4 * (SIDE * SIDE / 32), jp_lattice_way_size(&map));
    map.width = 0;
    TEST_ASSERT_EQUAL_UINT32(0, jp_lattice_way_size(&map));
}

static void test_refuses(void)
{
    const struct jp_way_cell here = {4, 4};
    const struct jp_way_cell there = {9, 9};
    const size_t size = jp_lattice_way_size(&map);

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_way_start(NULL, lattice, &terrain, &here, &there, block, size));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_way_start(&way, NULL, &terrain, &here, &there, block, size));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_way_start(&way, lattice, NULL, &here, &there, block, size));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_way_start(&way, lattice, &terrain, NULL, &there, block, size));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_way_start(&way, lattice, &terrain, &here, NULL, block, size));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_way_start(&way, lattice, &terrain, &here, &there, NULL, size));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY,
                          jp_lattice_way_start(&way, lattice, &terrain, &here, &there, block, size - 1U));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ALIGNMENT, jp_lattice_way_start(&way, lattice, &terrain, &here, &there,
                                                                 (uint8_t *)block + 4, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, start(-1, 4, 9, 9));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, start(4, 4, 9, SIDE));
    TEST_ASSERT_EQUAL_INT(JP_OK, start(4, 4, 9, 9));
}

static void test_is_there_already(void)
{
    struct jp_way_cell cell = {5, 6};

    TEST_ASSERT_EQUAL_INT(JP_OK, start(5, 6, 5, 6));
    TEST_ASSERT_EQUAL_INT(JP_WAY_FOUND, jp_lattice_way_work(&way, 0)); /* without a look */
    TEST_ASSERT_EQUAL_INT(JP_OK, start(5, 6, 5, 7));
    TEST_ASSERT_EQUAL_INT(JP_WAY_WORKING, jp_lattice_way_work(&way, 0));
    TEST_ASSERT_EQUAL_INT(JP_OK, start(5, 6, 5, 6));
    TEST_ASSERT_EQUAL_INT(JP_WAY_FOUND, jp_lattice_way_work(&way, 1));
    TEST_ASSERT_FALSE(jp_lattice_way_next(&way, &cell));
    TEST_ASSERT_EQUAL_INT(5, cell.x);
}

static void test_nothing_is_known_where_nobody_has_looked(void)
{
    struct jp_way_cell cell = {20, 20};

    TEST_ASSERT_EQUAL_INT(JP_OK, start(4, 4, 5, 4));
    TEST_ASSERT_EQUAL_INT(JP_WAY_FOUND, answer(8));
    TEST_ASSERT_FALSE(jp_lattice_way_next(&way, &cell));
    TEST_ASSERT_EQUAL_INT(20, cell.x);
}

static void test_no_way_through_a_wall(void)
{
    put_column(12, 0, SIDE - 1, JP_CELL_OCCUPIED);
    TEST_ASSERT_EQUAL_INT(JP_OK, start(4, 4, 19, 4));
    TEST_ASSERT_EQUAL_INT(JP_WAY_NONE, answer(7));
    TEST_ASSERT_EQUAL_INT(JP_WAY_NONE, jp_lattice_way_work(&way, 7));
}

static void test_stays_in_its_block(void)
{
    const size_t words = (jp_lattice_way_size(&map) + 7U) / 8U;

    block[words] = UINT64_C(0x5A5A5A5A5A5A5A5A);
    TEST_ASSERT_EQUAL_INT(JP_OK, start(4, 4, 19, 19));
    TEST_ASSERT_EQUAL_INT(JP_WAY_FOUND, answer(1000));
    TEST_ASSERT_TRUE(block[words] == UINT64_C(0x5A5A5A5A5A5A5A5A));
}

static void block_some(void)
{
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        const bool is_free = random_below(100) < FREE_CELL_PERCENT;

        TEST_ASSERT_EQUAL_INT(
            JP_OK, jp_terrain_set_cell(&terrain, i % SIDE, i / SIDE, is_free ? JP_CELL_FREE : JP_CELL_OCCUPIED));
    }
}

static int16_t anywhere(void)
{
    return (int16_t)(3U + random_below((uint32_t)map.width - 6U));
}

static bool expect_as_oracle(unsigned looks)
{
    const int16_t x = anywhere();
    const int16_t y = anywhere();
    const int16_t goal_x = anywhere();
    const int16_t goal_y = anywhere();

    way_oracle_solve(lattice, &terrain, &(struct jp_way_cell){goal_x, goal_y});
    TEST_ASSERT_EQUAL_INT(JP_OK, start(x, y, goal_x, goal_y));
    if (*way_oracle_at(&terrain, x, y) == WAY_ORACLE_FAR) {
        TEST_ASSERT_EQUAL_INT(JP_WAY_NONE, answer(looks));
        return false;
    }
    TEST_ASSERT_EQUAL_INT(JP_WAY_FOUND, answer(looks));
    way_oracle_expect(&terrain, &way, (struct jp_way_cell){x, y});
    return true;
}

static void test_as_few_steps_as_there_are(void)
{
    unsigned found = 0;

    for (unsigned i = 0; i < MAPS; i++) {
        block_some();
        found += expect_as_oracle(1U + random_below(300)) ? 1U : 0U;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(MAPS / 8, found);
    TEST_ASSERT_LESS_THAN_UINT32(MAPS, found);
}

/* This lattice sweeps other cells there than back. */
static void test_on_slopes_and_with_another_lattice(void)
{
    unsigned found = 0;

    lattice = &jp_lattice_zhang2018;
    make_map(SMALL_SIDE, true);
    for (unsigned i = 0; i < MAPS; i++) {
        for (int32_t cell = 0; cell < SMALL_SIDE * SMALL_SIDE; cell++) {
            const jp_elevation height = (jp_elevation)random_below(10 + i * i);
            TEST_ASSERT_EQUAL_INT(JP_OK,
                                  jp_terrain_set_elevation(&terrain, cell % SMALL_SIDE, cell / SMALL_SIDE, height));
        }
        found += expect_as_oracle(50) ? 1U : 0U;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(MAPS / 8, found);
    TEST_ASSERT_LESS_THAN_UINT32(MAPS, found);
}

static void test_without_unit_steps_there_is_no_way(void)
{
    struct jp_lattice curves = *lattice;
    static struct jp_primitive primitives[JP_HEADINGS * 9];

    for (unsigned i = 0; i < sizeof primitives / sizeof *primitives; i++) {
        primitives[i] = lattice->primitives[i];
        primitives[i].move_count = (uint8_t)(primitives[i].move_count == 1U ? 2U : primitives[i].move_count);
    }
    curves.primitives = primitives;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_way_start(&way, &curves, &terrain, &(struct jp_way_cell){4, 4},
                                                      &(struct jp_way_cell){9, 9}, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_WAY_NONE, answer(100));
}

/* The ends of its front are far apart in memory. */
static void test_along_a_corridor(void)
{
    struct jp_way_cell cell = {12, 20};
    unsigned steps = 0;

    for (int32_t x = 0; x < SIDE; x++) {
        put_column(x, 0, SIDE - 1, x < 10 || x > 14 ? JP_CELL_OCCUPIED : JP_CELL_FREE);
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, start(12, 20, 12, 11));
    TEST_ASSERT_EQUAL_INT(JP_WAY_FOUND, answer(3));
    while (jp_lattice_way_next(&way, &cell)) {
        steps++;
    }
    TEST_ASSERT_EQUAL_UINT32(9, steps);
}

static void test_size_of_maps_out_of_range(void)
{
    map.width = JP_TERRAIN_SIDE_MAX + 1;
    TEST_ASSERT_EQUAL_UINT32(0, jp_lattice_way_size(&map));
}

/* In just as much memory as it says; with steps that sweep the same there and back, so that one look does for both. */
static void test_block_of_its_size(void)
{
    const struct jp_way_cell here = {4, 4};
    const struct jp_way_cell there = {9, 9};

    TEST_ASSERT_EQUAL_INT(
        JP_OK, jp_lattice_way_start(&way, lattice, &terrain, &here, &there, block, jp_lattice_way_size(&map)));
    TEST_ASSERT_EQUAL_UINT32(0xFFFF, way.alike);
    TEST_ASSERT_EQUAL_INT(JP_WAY_FOUND, answer(7));
}

/* ---- A robot of a cell ---- */

static struct jp_lattice small;
static struct jp_primitive steps[JP_HEADINGS];
static struct jp_span spans[2 * JP_HEADINGS];

/* A step sweeps the cells where it begins and ends, in the same order there and back. */
static void make_small(void)
{
    static uint8_t own_moves[JP_HEADINGS];

    small = *lattice;
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const struct jp_cell_offset to = jp_move_offsets[heading];
        const struct jp_span end = {to.dy, to.dx, to.dx};
        const unsigned first = heading < JP_HEADINGS / 2U ? 0U : 1U;

        own_moves[heading] = (uint8_t)heading;
        steps[heading] = (struct jp_primitive){.start = (uint8_t)heading,
                                               .end = (uint8_t)heading,
                                               .dx = to.dx,
                                               .dy = to.dy,
                                               .first_move = (uint16_t)heading,
                                               .move_count = 1,
                                               .first_span = (uint16_t)(2U * heading),
                                               .span_count = 2};
        spans[2U * heading + first] = (struct jp_span){0, 0, 0};
        spans[2U * heading + 1U - first] = end;
        small.first_from[heading + 1U] = (uint16_t)(heading + 1U);
    }
    small.primitives = steps;
    small.moves = own_moves;
    small.spans = spans;
    lattice = &small;
}

static void block_half(void)
{
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        const bool is_free = random_below(100) < 55U;

        TEST_ASSERT_EQUAL_INT(
            JP_OK, jp_terrain_set_cell(&terrain, i % SIDE, i / SIDE, is_free ? JP_CELL_FREE : JP_CELL_OCCUPIED));
    }
}

static void expect_ways(uint16_t alike)
{
    unsigned found = 0;

    for (unsigned i = 0; i < MAPS; i++) {
        block_half();
        found += expect_as_oracle(1U + random_below(50)) ? 1U : 0U;
        TEST_ASSERT_EQUAL_HEX32(alike, way.alike);
    }
    TEST_ASSERT_GREATER_THAN_UINT32(MAPS / 8, found);
    TEST_ASSERT_LESS_THAN_UINT32(MAPS, found);
}

/* Steps that sweep the same there and back are known by all of their cells. */
static void test_steps_that_sweep_more_on_the_way_back(void)
{
    make_small();
    expect_ways(0xFFFF);
    spans[2 * 8 + 1].last = 1; /* west of the step to the west its begin, and the cell behind it */
    expect_ways(0xFFFF & ~(1U << 8 | 1U << 0));
    make_small();
    spans[2 * 4 + 1].first = -1; /* north, beside its end */
    expect_ways(0xFFFF & ~(1U << 4 | 1U << 12));
    make_small();
    spans[2 * 14 + 1].y = 1;
    expect_ways(0xFFFF & ~(1U << 14 | 1U << 6));
    make_small();
    steps[3].span_count = 1;
    expect_ways(0xFFFF & ~(1U << 3 | 1U << 11));
}

/* A front of a single cell that is the first of its word, with empty words before and behind. */
static void test_along_the_first_cells_of_the_words(void)
{
    const struct jp_terrain_config narrow = {.width = 32, .height = 18, .resolution = lattice->resolution};
    struct jp_way_cell cell = {0, 0};

    make_small();
    map = narrow;
    make_level_map(&map);
    for (int32_t x = 1; x < map.width; x++) {
        put_column(x, 0, map.height - 1, JP_CELL_OCCUPIED);
    }
    for (unsigned looks = 1; looks < 40; looks += 6) {
        cell = (struct jp_way_cell){0, 0};
        TEST_ASSERT_EQUAL_INT(JP_OK, start(0, 0, 0, 17));
        TEST_ASSERT_EQUAL_INT(JP_WAY_FOUND, answer(looks));
        for (int16_t y = 1; y <= 17; y++) {
            TEST_ASSERT_TRUE(jp_lattice_way_next(&way, &cell));
            TEST_ASSERT_EQUAL_INT(y, cell.y);
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, start(0, 17, 0, 0));
        TEST_ASSERT_EQUAL_INT(JP_WAY_FOUND, answer(looks));
    }
}
