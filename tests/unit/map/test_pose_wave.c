/* The order in which poses are handed out, against a list of those that are due. */
#include "src/map/pose_wave.h"

#include <string.h>

#include "tests/target/random.h"
#include "unity.h"

enum {
    WIDTH = 9,
    HEIGHT = 5,
    CELLS = WIDTH * HEIGHT,
    BLOCK_BYTES = (HEIGHT * 4 + 7) / 8 * 8 + (CELLS * (JP_HEADINGS * 3 + 2) + 7) / 8 * 8,
    GUARD_BYTES = 16,
    STEP = 100,
    LIMIT = 3000,
    SEEDS = 12,
    CALLS_MAX = 20000
};

static const struct jp_terrain_config map = {.width = WIDTH, .height = HEIGHT};
static struct jp_pose_wave wave;
static uint64_t block[(BLOCK_BYTES + GUARD_BYTES) / 8];
static uint16_t value[CELLS][JP_HEADINGS]; /* 0: none */
static uint16_t fresh[CELLS];
static uint32_t state;
static struct jp_pose_group group;

static void clear(jp_cost limit)
{
    jp_pose_wave_start(&wave, STEP, limit);
    for (uint16_t y = 0; y < HEIGHT; y++) {
        jp_pose_wave_clear_row(&wave, y);
    }
}

void setUp(void)
{
    memset(block, 0x5A, sizeof block);
    memset(value, 0, sizeof value);
    memset(fresh, 0, sizeof fresh);
    state = 20261126;
    jp_pose_wave_init(&wave, &map, block);
    clear(LIMIT);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_HEX32(0x5A5A5A5A, (uint32_t)block[BLOCK_BYTES / 8]);
}

static void lower(int32_t x, int32_t y, unsigned heading, uint16_t to)
{
    pose_lower(&wave, pose_cell(&wave, x, y), y, heading, to);
    value[y * WIDTH + x][heading] = to;
    fresh[y * WIDTH + x] |= (uint16_t)(1U << heading);
}

static enum jp_pose_wave_step next(unsigned slice)
{
    enum jp_pose_wave_step step = JP_POSE_WAVE_WAITING;

    for (unsigned i = 0; step == JP_POSE_WAVE_WAITING; i++) {
        unsigned poses = slice;

        TEST_ASSERT_TRUE(i < CALLS_MAX);
        step = jp_pose_wave_next(&wave, &poses, &group);
        TEST_ASSERT_TRUE(step != JP_POSE_WAVE_WAITING || poses == 0U);
    }
    return step;
}

static void deal(uint32_t headings)
{
    const size_t cell = pose_cell(&wave, group.x, group.y);

    pose_deal(&wave, cell, headings);
    fresh[cell] &= (uint16_t)~headings;
}

static void expect_next(int32_t x, int32_t y, uint32_t headings)
{
    TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_CELL, next(1));
    TEST_ASSERT_EQUAL_INT(x, group.x);
    TEST_ASSERT_EQUAL_INT(y, group.y);
    TEST_ASSERT_EQUAL_HEX32(headings, group.headings);
    deal(headings);
}

static void test_size_is_three_bytes_a_pose_and_two_a_cell_and_four_a_row(void)
{
    TEST_ASSERT_EQUAL_UINT32(BLOCK_BYTES, jp_pose_wave_size(&map));
}

static void test_a_cleared_wave_has_no_values_and_stops(void)
{
    for (unsigned i = 0; i < CELLS * JP_HEADINGS; i++) {
        TEST_ASSERT_EQUAL_HEX32(JP_COST_MAX, pose_value(&wave, i / JP_HEADINGS, i % JP_HEADINGS));
    }
    TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_STOPPED, next(1));
    TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_STOPPED, next(1));
}

static void test_values_have_24_bits(void)
{
    pose_settle(&wave, 7, 3, 0xABCDEF);
    pose_settle(&wave, 7, 4, 0x012345);
    TEST_ASSERT_EQUAL_HEX32(0xABCDEF, pose_value(&wave, 7, 3));
    TEST_ASSERT_EQUAL_HEX32(0x012345, pose_value(&wave, 7, 4));
    TEST_ASSERT_EQUAL_HEX32(JP_COST_MAX, pose_value(&wave, 7, 5));
    TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_STOPPED, next(1));
}

/* By steps of the threshold, not by the place. */
static void test_low_values_come_first(void)
{
    lower(0, 0, 2, 900);
    lower(8, 4, 0, 40);
    lower(3, 2, 15, 2500);
    lower(5, 1, 1, 450);
    expect_next(8, 4, 1);
    expect_next(5, 1, 1U << 1);
    expect_next(0, 0, 1U << 2);
    expect_next(3, 2, 1U << 15);
    TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_STOPPED, next(1));
}

static void test_headings_of_a_cell_come_together_if_they_are_due(void)
{
    lower(4, 3, 2, 10);
    lower(4, 3, 9, 90);
    lower(4, 3, 12, 300);
    expect_next(4, 3, 1U << 2 | 1U << 9);
    expect_next(4, 3, 1U << 12);
    TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_STOPPED, next(1));
}

/* What is lowered ahead of a sweep is handed out by it, what is lowered behind it by the next one, which goes back. */
static void test_sweeps_go_to_and_fro(void)
{
    lower(4, 2, 0, 50);
    expect_next(4, 2, 1);
    lower(3, 2, 0, 60);
    lower(6, 2, 0, 60);
    lower(1, 4, 0, 60);
    lower(7, 0, 0, 60);
    expect_next(6, 2, 1);
    expect_next(1, 4, 1);
    expect_next(3, 2, 1);
    expect_next(7, 0, 1);
    TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_STOPPED, next(1));
}

static void test_values_beyond_the_limit_are_not_handed_out(void)
{
    lower(1, 1, 0, LIMIT);
    lower(2, 1, 0, LIMIT + 1);
    expect_next(1, 1, 1);
    TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_STOPPED, next(1));
    setUp();
    clear(STEP / 2);
    lower(1, 1, 0, STEP / 2);
    lower(2, 1, 0, STEP / 2 + 1);
    expect_next(1, 1, 1);
    TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_STOPPED, next(1));
}

/* A look in vain costs a part of a pose: here at all headings of the cells before the one that is due. */
static void test_looks_are_counted(void)
{
    const unsigned looks = (WIDTH - 1) * JP_HEADINGS;
    unsigned spent = 0;

    for (unsigned i = 0; i < looks; i++) {
        lower((int32_t)(i / JP_HEADINGS), 2, i % JP_HEADINGS, 2000);
    }
    lower(WIDTH - 1, 2, 0, 1);
    for (unsigned poses = 1; jp_pose_wave_next(&wave, &poses, &group) == JP_POSE_WAVE_WAITING; poses = 1) {
        spent++;
    }
    TEST_ASSERT_EQUAL_INT(WIDTH - 1, group.x);
    TEST_ASSERT_EQUAL_UINT32(looks / 32U, spent);
}

/* Cells without fresh poses are looked at, too: here all of the map but a column, by a sweep. */
static void test_looks_for_cells_are_counted(void)
{
    unsigned poses = CELLS;

    for (int32_t y = 0; y < HEIGHT; y++) {
        lower(WIDTH - 1, y, 0, 1);
    }
    while (jp_pose_wave_next(&wave, &poses, &group) == JP_POSE_WAVE_CELL) {
        deal(group.headings);
    }
    TEST_ASSERT_EQUAL_UINT32(CELLS - CELLS / 32U, poses);
}

/* None of the poses that are due stays behind. */
static void expect_all_dealt(void)
{
    for (unsigned i = 0; i < CELLS * JP_HEADINGS; i++) {
        const bool is_fresh = (((uint32_t)fresh[i / JP_HEADINGS] >> (i % JP_HEADINGS)) & 1U) != 0U;

        TEST_ASSERT_TRUE(!is_fresh || value[i / JP_HEADINGS][i % JP_HEADINGS] > LIMIT);
    }
}

/* As motions from what was handed out would. */
static void lower_others(uint16_t from)
{
    for (unsigned i = 0; i < 3U; i++) {
        const uint32_t pose = target_random(&state) % (CELLS * JP_HEADINGS);
        const uint16_t to = (uint16_t)(from + 1U + target_random(&state) % 400U);
        const uint16_t present = value[pose / JP_HEADINGS][pose % JP_HEADINGS];
        const int32_t cell = (int32_t)(pose / JP_HEADINGS);

        if (present == 0U || to < present) {
            lower(cell % WIDTH, cell / WIDTH, pose % JP_HEADINGS, to);
        }
    }
}

static void expect_group(void)
{
    const size_t cell = pose_cell(&wave, group.x, group.y);
    uint16_t least = UINT16_MAX;

    TEST_ASSERT_TRUE(group.headings != 0U && (group.headings & ~(uint32_t)fresh[cell]) == 0U);
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        if (((group.headings >> heading) & 1U) != 0U) {
            const uint16_t its = value[cell][heading];

            TEST_ASSERT_EQUAL_UINT32(its, pose_value(&wave, cell, heading));
            TEST_ASSERT_TRUE(its <= LIMIT);
            least = its < least ? its : least;
        }
    }
    deal(group.headings);
    lower_others(least);
}

static void test_all_that_falls_is_handed_out_in_slices_of_any_size(void)
{
    for (uint32_t seed = 1; seed <= SEEDS; seed++) {
        unsigned groups = 0;

        setUp();
        state = seed;
        lower(4, 2, 5, 1);
        while (next(1U + seed % 5U) == JP_POSE_WAVE_CELL) {
            expect_group();
            groups++;
        }
        TEST_ASSERT_TRUE(groups > 20U);
        expect_all_dealt();
    }
}

/* A sweep takes what is up to a step above the least that is left, in the order of the cells. */
static void test_a_step_above_the_least_is_taken_together(void)
{
    const uint16_t least = 4 * STEP;

    lower(1, 1, 3, (uint16_t)(least + STEP)); /* before the least in the order of the cells */
    lower(WIDTH - 1, 1, 2, least);
    lower(0, HEIGHT - 1, 5, (uint16_t)(least + STEP + 1));
    TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_CELL, next(1));
    TEST_ASSERT_EQUAL_UINT32(least + STEP, wave.threshold);
    deal(group.headings);
    TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_CELL, next(1));
    TEST_ASSERT_EQUAL_UINT32(least + STEP, wave.threshold);
    deal(group.headings);
    expect_next(0, HEIGHT - 1, 1U << 5);
    TEST_ASSERT_EQUAL_UINT32(least + 2 * STEP + 1, wave.threshold);
}

/* Wherever a wave is left, the next one begins as the first. */
static void test_a_wave_starts_anew_from_anywhere(void)
{
    for (int32_t left = 0; left < 6; left++) {
        clear(LIMIT);
        memset(fresh, 0, sizeof fresh);
        for (int32_t i = 0; i < 6; i++) {
            lower(i, i % HEIGHT, 0, (uint16_t)(150 * i + 1));
        }
        for (int32_t i = 0; i <= left; i++) {
            TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_CELL, next(1));
            deal(group.headings);
        }
        clear(LIMIT);
        lower(2, 1, 0, 1);
        lower(7, 1, 0, 2);
        lower(4, 3, 0, 3);
        expect_next(2, 1, 1);
        expect_next(7, 1, 1);
        expect_next(4, 3, 1);
        TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_STOPPED, next(1));
    }
}

/* To and fro over the same cells, with one of them that is due in each sweep: each way takes as many looks. */
static void test_looks_of_both_directions_are_counted(void)
{
    unsigned spent = 0;

    for (unsigned i = 0; i < 64U; i++) {
        lower(i % 2U == 0U ? WIDTH - 1 : 0, 2, 0, (uint16_t)(i + 1U));
        for (unsigned poses = 1; jp_pose_wave_next(&wave, &poses, &group) == JP_POSE_WAVE_WAITING; poses = 1) {
            spent++;
        }
        deal(group.headings);
    }
    /* Of a sweep 8 cells and a heading, and the four other rows. */
    TEST_ASSERT_UINT32_WITHIN(6, 64U * (WIDTH - 1U + 1U + HEIGHT - 1U) / 32U, spent);
}

/* A row whose least pose has been dealt with meanwhile keeps what else it holds. */
static void test_a_row_of_which_the_least_is_dealt_with_is_looked_at_again(void)
{
    lower(2, 1, 0, STEP / 2);
    lower(6, 1, 4, 5 * STEP);
    pose_deal(&wave, pose_cell(&wave, 2, 1), 1);
    fresh[WIDTH + 2] = 0;
    expect_next(6, 1, 1U << 4);
    TEST_ASSERT_EQUAL_INT(JP_POSE_WAVE_STOPPED, next(1));
}

/* Of a sweep over three cells that are due what lies between them counts, either way, from wherever it goes on. */
static void test_looks_between_cells_are_counted(void)
{
    const unsigned sweeps = 64;
    unsigned spent = 0;

    for (unsigned i = 0; i < sweeps; i++) {
        for (int32_t x = 2; x < WIDTH; x += 3) {
            lower(x, 2, 0, (uint16_t)(i + 1U));
        }
        for (unsigned cells = 0; cells < 3U; cells++) {
            for (unsigned poses = 1; jp_pose_wave_next(&wave, &poses, &group) == JP_POSE_WAVE_WAITING; poses = 1) {
                spent++;
            }
            deal(group.headings);
        }
    }
    /* 6 cells and three headings; and the four other rows. */
    TEST_ASSERT_UINT32_WITHIN(6, sweeps * (WIDTH - 3U + 3U + HEIGHT - 1U) / 32U, spent);
}
