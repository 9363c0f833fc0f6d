/* What a flood over the cells reaches, against a relaxation of all cells until nothing changes. */
#include <joulepath/reach.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "tests/support/level_map.h"
#include "tests/target/random.h"
#include "unity.h"

enum { SIDE = 24, MAPS = 120, WORK_MAX = 4000, FREE_CELL_PERCENT = 94 };

static const struct jp_lattice *const lattice = &jp_lattice_courier24;

static struct jp_terrain_config map;
static struct jp_reach reach;
static uint64_t block[SIDE * SIDE / 32 + 1];
static bool oracle[SIDE][SIDE];
static uint32_t random_state = 1;

static uint32_t random_below(uint32_t bound)
{
    return target_random(&random_state) % bound;
}

void setUp(void)
{
    map = (struct jp_terrain_config){.width = SIDE, .height = SIDE, .resolution = lattice->resolution};
    make_level_map(&map);
}

void tearDown(void)
{
}

static enum jp_status start(int32_t x, int32_t y, int32_t target_x, int32_t target_y)
{
    return jp_reach_start(&reach, lattice, &terrain, x, y, target_x, target_y, block, sizeof block);
}

static enum jp_reach_answer answer(unsigned slice)
{
    for (unsigned i = 0; i < WORK_MAX; i++) {
        const enum jp_reach_answer now = jp_reach_work(&reach, slice);
        if (now != JP_REACH_WORKING) {
            return now;
        }
    }
    return JP_REACH_WORKING;
}

static void test_size_is_two_bits_a_cell(void)
{
    TEST_ASSERT_EQUAL_UINT32(2 * 4 * (SIDE * SIDE / 32), jp_reach_size(&map));
    map.width = 0;
    TEST_ASSERT_EQUAL_UINT32(0, jp_reach_size(&map));
}

static void test_refuses(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_reach_start(NULL, lattice, &terrain, 4, 4, 9, 9, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_reach_start(&reach, NULL, &terrain, 4, 4, 9, 9, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_reach_start(&reach, lattice, NULL, 4, 4, 9, 9, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_reach_start(&reach, lattice, &terrain, 4, 4, 9, 9, NULL, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY,
                          jp_reach_start(&reach, lattice, &terrain, 4, 4, 9, 9, block, jp_reach_size(&map) - 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ALIGNMENT,
                          jp_reach_start(&reach, lattice, &terrain, 4, 4, 9, 9, (uint8_t *)block + 4, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, start(-1, 4, 9, 9));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, start(4, 4, 9, SIDE));
}

static void test_a_cell_reaches_itself_and_the_other_end_of_free_ground(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, start(4, 4, 4, 4));
    TEST_ASSERT_EQUAL_INT(JP_REACH_CONNECTED, answer(1));
    TEST_ASSERT_EQUAL_INT(JP_OK, start(4, 4, SIDE - 5, SIDE - 5));
    TEST_ASSERT_EQUAL_INT(JP_REACH_CONNECTED, answer(7));
}

static void test_a_wall_is_in_the_way_until_it_has_a_gap_for_the_robot(void)
{
    put_column(12, 0, SIDE - 1, JP_CELL_OCCUPIED);
    TEST_ASSERT_EQUAL_INT(JP_OK, start(5, 5, SIDE - 5, SIDE - 5));
    TEST_ASSERT_EQUAL_INT(JP_REACH_NONE, answer(WORK_MAX));
    TEST_ASSERT_EQUAL_INT(JP_REACH_NONE, jp_reach_work(&reach, 1));

    /* The disc takes five cells. */
    put_column(12, 8, 11, JP_CELL_FREE);
    TEST_ASSERT_EQUAL_INT(JP_OK, start(5, 5, SIDE - 5, SIDE - 5));
    TEST_ASSERT_EQUAL_INT(JP_REACH_NONE, answer(3));

    put_column(12, 12, 12, JP_CELL_FREE);
    TEST_ASSERT_EQUAL_INT(JP_OK, start(5, 5, SIDE - 5, SIDE - 5));
    TEST_ASSERT_EQUAL_INT(JP_REACH_CONNECTED, answer(3));
}

static bool spreads_to(int32_t x, int32_t y)
{
    for (unsigned i = 0; i < JP_MOVE_DIRECTIONS; i++) {
        const int32_t u = x - jp_move_offsets[i].dx;
        const int32_t v = y - jp_move_offsets[i].dy;
        if (u >= 0 && u < SIDE && v >= 0 && v < SIDE && oracle[v][u] && jp_lattice_is_open(lattice, &terrain, x, y)) {
            return true;
        }
    }
    return false;
}

static void relax(int32_t x, int32_t y)
{
    bool has_changed = true;

    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        oracle[i / SIDE][i % SIDE] = false;
    }
    oracle[y][x] = true;
    while (has_changed) {
        has_changed = false;
        for (int32_t i = 0; i < SIDE * SIDE; i++) {
            if (!oracle[i / SIDE][i % SIDE] && spreads_to(i % SIDE, i / SIDE)) {
                oracle[i / SIDE][i % SIDE] = true;
                has_changed = true;
            }
        }
    }
}

static void test_random_maps(void)
{
    unsigned connected = 0;
    unsigned apart = 0;

    for (unsigned i = 0; i < MAPS; i++) {
        for (int32_t cell = 0; cell < SIDE * SIDE; cell++) {
            (void)jp_terrain_set_cell(&terrain, cell % SIDE, cell / SIDE,
                                      random_below(100) < FREE_CELL_PERCENT ? JP_CELL_FREE : JP_CELL_OCCUPIED);
        }
        const int32_t x = (int32_t)random_below(SIDE);
        const int32_t y = (int32_t)random_below(SIDE);
        const int32_t target_x = (int32_t)random_below(SIDE);
        const int32_t target_y = (int32_t)random_below(SIDE);

        relax(x, y);
        TEST_ASSERT_EQUAL_INT(JP_OK, start(x, y, target_x, target_y));
        TEST_ASSERT_EQUAL_INT(oracle[target_y][target_x] ? JP_REACH_CONNECTED : JP_REACH_NONE,
                              answer(1 + random_below(50)));
        connected += oracle[target_y][target_x];
        apart += !oracle[target_y][target_x];
    }
    TEST_ASSERT_GREATER_THAN_UINT32(MAPS / 20, connected);
    TEST_ASSERT_GREATER_THAN_UINT32(MAPS / 20, apart);
}

/* ---- A robot of a cell ---- */

static struct jp_lattice small;

static enum jp_status start_small(int32_t x, int32_t y, int32_t target_x, int32_t target_y)
{
    static const struct jp_span own_cell = {0, 0, 0};

    small = *lattice;
    small.spans = &own_cell;
    small.core = (struct jp_cells){0, 1};
    return jp_reach_start(&reach, &small, &terrain, x, y, target_x, target_y, block, jp_reach_size(&map));
}

/* In just as much memory as it says, and no more. */
static void test_block_of_its_size(void)
{
    block[jp_reach_size(&map) / 8U] = UINT64_C(0x5A5A5A5A5A5A5A5A);
    TEST_ASSERT_EQUAL_INT(JP_OK, start_small(0, 0, SIDE - 1, SIDE - 1));
    TEST_ASSERT_EQUAL_INT(JP_REACH_CONNECTED, answer(5));
    TEST_ASSERT_TRUE(block[jp_reach_size(&map) / 8U] == UINT64_C(0x5A5A5A5A5A5A5A5A));
}

/* Two looks over all words end it, the second one because it finds nothing new: of two cells, the one in an earlier
 * word is found in the first. */
static void test_it_ends_when_a_look_over_all_finds_nothing_new(void)
{
    const unsigned words = SIDE * SIDE / 32;
    unsigned spent = 0;

    for (int32_t x = 0; x < SIDE; x++) {
        put_column(x, 0, SIDE - 1, JP_CELL_OCCUPIED);
    }
    put_column(12, 10, 11, JP_CELL_FREE);
    TEST_ASSERT_TRUE((10 * SIDE + 12) / 32 < (11 * SIDE + 12) / 32);
    TEST_ASSERT_EQUAL_INT(JP_OK, start_small(12, 11, 0, 0));
    while (jp_reach_work(&reach, 1) == JP_REACH_WORKING) {
        spent++;
    }
    TEST_ASSERT_EQUAL_INT(JP_REACH_NONE, jp_reach_work(&reach, 1));
    TEST_ASSERT_EQUAL_UINT32(2U * words + 2U - 1U, spent);
}
