/* Waves over a grid, against relaxing all cells until nothing changes. */
#include <joulepath/wavefront.h>
#include <string.h>

#include "tests/target/random.h"
#include "unity.h"

enum {
    WIDTH = 40, /* more than a word of bits */
    HEIGHT = 7,
    BLOCK_BYTES = 920,
    GUARD_BYTES = 32,
    WALL = 0,
    WEIGHT_MAX = 9,
    SEEDS = 20
};

static const int8_t neighbours[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};

static struct jp_wavefront wave;
static uint64_t block[(BLOCK_BYTES + GUARD_BYTES) / 8];
static uint8_t weights[HEIGHT][WIDTH]; /* what it costs to enter a cell; WALL: it cannot be */
static uint32_t expected[HEIGHT][WIDTH];
static uint32_t unit; /* of the weights */
static uint32_t state;
static unsigned handed_out;
static unsigned waited;

void setUp(void)
{
    memset(block, 0x5A, sizeof block);
    memset(weights, 1, sizeof weights);
    state = 20050901;
    handed_out = 0;
    waited = 0;
    unit = 1;
    TEST_ASSERT_TRUE(jp_wavefront_size(WIDTH, HEIGHT, JP_WAVE_3_BYTES) <= BLOCK_BYTES);
    jp_wavefront_init(&wave, WIDTH, HEIGHT, JP_WAVE_2_BYTES, block);
}

/* So that the values need more than two bytes. */
static void use_three_bytes(void)
{
    unit = 50021;
    jp_wavefront_init(&wave, WIDTH, HEIGHT, JP_WAVE_3_BYTES, block);
}

void tearDown(void)
{
}

static uint32_t below(uint32_t n)
{
    return target_random(&state) % n;
}

static bool is_inside(int32_t x, int32_t y)
{
    return x >= 0 && y >= 0 && x < WIDTH && y < HEIGHT;
}

static void relax(int32_t x, int32_t y)
{
    for (int i = 0; i < 4; i++) {
        const int32_t nx = x + neighbours[i][0];
        const int32_t ny = y + neighbours[i][1];
        if (!is_inside(nx, ny) || weights[ny][nx] == WALL) {
            continue;
        }
        const uint32_t value = jp_wavefront_value(&wave, x, y) + weights[ny][nx] * unit;
        if (value < jp_wavefront_value(&wave, nx, ny)) {
            jp_wavefront_lower(&wave, nx, ny, value);
        }
    }
}

static void grow(void)
{
    int32_t x = -1;
    int32_t y = -1;

    while (true) {
        unsigned cells = 1;
        const enum jp_wave_step step = jp_wavefront_next(&wave, &cells, &x, &y);
        TEST_ASSERT_TRUE(step == JP_WAVE_STOPPED || cells == 0);
        if (step == JP_WAVE_STOPPED) {
            return;
        }
        if (step == JP_WAVE_WAITING) {
            waited++;
            continue;
        }
        TEST_ASSERT_TRUE(is_inside(x, y));
        TEST_ASSERT_TRUE(jp_wavefront_value(&wave, x, y) <= wave.threshold);
        handed_out++;
        relax(x, y);
    }
}

static void clear(void)
{
    while (!jp_wavefront_is_clear(&wave)) {
        jp_wavefront_clear(&wave);
    }
}

/* From cell (0, 0), as far as (target_x, target_y) and a quarter more. */
static void start(uint32_t step, uint16_t target_x, uint16_t target_y)
{
    jp_wavefront_start(&wave, step, target_x, target_y);
    clear();
    jp_wavefront_lower(&wave, 0, 0, 0);
}

static bool expect_better(int32_t x, int32_t y)
{
    bool is_better = false;

    for (int i = 0; i < 4; i++) {
        const int32_t nx = x + neighbours[i][0];
        const int32_t ny = y + neighbours[i][1];
        if (weights[y][x] != WALL && is_inside(nx, ny) && expected[ny][nx] != wave.not_reached &&
            expected[ny][nx] + weights[y][x] * unit < expected[y][x]) {
            expected[y][x] = expected[ny][nx] + weights[y][x] * unit;
            is_better = true;
        }
    }
    return is_better;
}

static void relax_all(void)
{
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        expected[i / WIDTH][i % WIDTH] = wave.not_reached;
    }
    expected[0][0] = 0;
    for (bool is_better = true; is_better;) {
        is_better = false;
        for (int32_t y = 0; y < HEIGHT; y++) {
            for (int32_t x = 0; x < WIDTH; x++) {
                is_better |= expect_better(x, y);
            }
        }
    }
}

/* Exact up to the horizon; beyond it not too low. */
static void expect_values(void)
{
    relax_all();
    for (int32_t y = 0; y < HEIGHT; y++) {
        for (int32_t x = 0; x < WIDTH; x++) {
            if (expected[y][x] <= wave.horizon) {
                TEST_ASSERT_EQUAL_UINT32(expected[y][x], jp_wavefront_value(&wave, x, y));
            } else {
                TEST_ASSERT_TRUE(jp_wavefront_value(&wave, x, y) >= expected[y][x]);
            }
        }
    }
}

static void randomise(unsigned wall_percent)
{
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            weights[y][x] = below(100) < wall_percent ? WALL : (uint8_t)(1 + below(WEIGHT_MAX));
        }
    }
}

static void expect_size(uint16_t width, uint16_t height, enum jp_wave_format format)
{
    const size_t size = jp_wavefront_size(width, height, format);
    const size_t cells = (size_t)width * height;

    TEST_ASSERT_EQUAL_UINT32(0, size % 8);
    TEST_ASSERT_TRUE(size * 8 >= (8U * (unsigned)format + 1U) * cells);
    TEST_ASSERT_TRUE(size <= (unsigned)format * cells + 4U * height * ((width + 31U) / 32) + 24);
}

static void test_size(void)
{
    for (uint16_t width = 1; width < 100; width += 13) {
        for (uint16_t height = 1; height < 100; height += 17) {
            expect_size(width, height, JP_WAVE_2_BYTES);
            expect_size(width, height, JP_WAVE_3_BYTES);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(2 * 1024 * 1024 + 1024 * 1024 / 8, jp_wavefront_size(1024, 1024, JP_WAVE_2_BYTES));
    TEST_ASSERT_EQUAL_UINT32(3 * 1024 * 1024 + 1024 * 1024 / 8, jp_wavefront_size(1024, 1024, JP_WAVE_3_BYTES));
}

static void test_nothing_reached_without_a_root(void)
{
    int32_t x = 0;
    int32_t y = 0;

    jp_wavefront_start(&wave, 1, 3, 3);
    clear();
    unsigned cells = 1;
    TEST_ASSERT_EQUAL_INT(JP_WAVE_STOPPED, jp_wavefront_next(&wave, &cells, &x, &y));
    TEST_ASSERT_EQUAL_UINT32(1, cells);
    TEST_ASSERT_TRUE(jp_wavefront_is_exhausted(&wave));
    TEST_ASSERT_EQUAL_UINT32(wave.not_reached, jp_wavefront_value(&wave, 0, 0));
    TEST_ASSERT_EQUAL_UINT32(wave.not_reached, jp_wavefront_value(&wave, WIDTH - 1, HEIGHT - 1));
}

static void expect_to_stay_in(enum jp_wave_format format)
{
    const uint8_t *bytes = (const uint8_t *)block;

    start(3, WIDTH - 1, HEIGHT - 1);
    grow();
    for (size_t i = jp_wavefront_size(WIDTH, HEIGHT, format); i < sizeof block; i++) {
        TEST_ASSERT_EQUAL_UINT8(0x5A, bytes[i]);
    }
}

static void test_stays_in_its_block(void)
{
    expect_to_stay_in(JP_WAVE_2_BYTES);
    use_three_bytes();
    expect_to_stay_in(JP_WAVE_3_BYTES);
}

static void test_reaches_all_of_an_open_grid(void)
{
    start(1, WIDTH - 1, HEIGHT - 1);
    grow();
    for (int32_t y = 0; y < HEIGHT; y++) {
        for (int32_t x = 0; x < WIDTH; x++) {
            TEST_ASSERT_EQUAL_UINT32(x + y, jp_wavefront_value(&wave, x, y));
        }
    }
    TEST_ASSERT_TRUE(jp_wavefront_is_exhausted(&wave));
}

/* With a step of the neighbours' difference each cell is handed out about once. */
static void test_hands_out_in_the_order_of_the_values(void)
{
    start(1, WIDTH - 1, HEIGHT - 1);
    grow();
    TEST_ASSERT_TRUE(handed_out <= WIDTH * HEIGHT * 3 / 2);
}

static void expect_least_on_random_grids(void)
{
    for (unsigned seed = 0; seed < SEEDS; seed++) {
        randomise(seed % 4 * 12);
        start((1 + below(30)) * unit, (uint16_t)below(WIDTH), (uint16_t)below(HEIGHT));
        grow();
        expect_values();
    }
}

static void test_is_least_on_random_grids(void)
{
    expect_least_on_random_grids();
    use_three_bytes();
    expect_least_on_random_grids();
}

/* Each cell of the far corner is 46 · 50 021 or more from the root. */
static void test_values_of_three_bytes(void)
{
    use_three_bytes();
    start(unit, WIDTH - 1, HEIGHT - 1);
    grow();
    TEST_ASSERT_EQUAL_UINT32((WIDTH + HEIGHT - 2) * unit, jp_wavefront_value(&wave, WIDTH - 1, HEIGHT - 1));
    TEST_ASSERT_EQUAL_UINT32(0xFFFFFE, jp_wavefront_value_max(&wave));
    expect_values();
}

static void test_stops_a_quarter_beyond_the_target(void)
{
    start(2, 8, 0);
    grow();
    TEST_ASSERT_EQUAL_UINT32(8 + 2 + 2, wave.horizon);
    expect_values();
    TEST_ASSERT_FALSE(jp_wavefront_is_exhausted(&wave));
    TEST_ASSERT_EQUAL_UINT32(wave.not_reached, jp_wavefront_value(&wave, WIDTH - 1, 0));
}

/* With a step near the end of the range the horizon would be beyond it. */
static void test_horizon_ends_with_the_range(void)
{
    start(UINT16_MAX - 1, WIDTH - 1, HEIGHT - 1);
    grow();
    TEST_ASSERT_EQUAL_UINT32(UINT16_MAX - 1, wave.horizon);
    TEST_ASSERT_TRUE(jp_wavefront_is_exhausted(&wave));
    expect_values();
}

static void test_target_behind_a_wall(void)
{
    for (int y = 0; y < HEIGHT; y++) {
        weights[y][20] = WALL;
    }
    start(4, 30, 3);
    grow();
    TEST_ASSERT_TRUE(jp_wavefront_is_exhausted(&wave));
    TEST_ASSERT_EQUAL_UINT32(UINT16_MAX - 1, wave.horizon);
    TEST_ASSERT_EQUAL_UINT32(wave.not_reached, jp_wavefront_value(&wave, 30, 3));
    TEST_ASSERT_EQUAL_UINT32(19, jp_wavefront_value(&wave, 19, 0));
    expect_values();
}

static void test_root_at_the_target(void)
{
    start(5, 0, 0);
    grow();
    TEST_ASSERT_EQUAL_UINT32(5, wave.horizon);
    expect_values();
}

/* To look through the bits in vain is work, too: the wave waits for more budget then. */
static void test_looking_for_cells_takes_budget(void)
{
    for (unsigned seed = 0; seed < SEEDS; seed++) {
        randomise(20);
        start(1, WIDTH - 1, HEIGHT - 1);
        grow();
        expect_values();
    }
    TEST_ASSERT_TRUE(waited > 0);
}

/* A row of them is paid for by several calls. */
static void test_looks_beyond_the_budget_are_paid_later(void)
{
    enum { LONG = 280 };
    static uint64_t row[(LONG * 2 + 40) / 8 + 1];
    int32_t x = 0;
    int32_t y = 0;
    unsigned cells = 1;
    unsigned calls = 1;

    TEST_ASSERT_TRUE(jp_wavefront_size(LONG, 1, JP_WAVE_2_BYTES) <= sizeof row);
    jp_wavefront_init(&wave, LONG, 1, JP_WAVE_2_BYTES, row);
    start(1, LONG - 1, 0);
    for (int32_t i = 1; i < LONG; i++) {
        jp_wavefront_lower(&wave, i, 0, 1000);
    }
    TEST_ASSERT_EQUAL_INT(JP_WAVE_CELL, jp_wavefront_next(&wave, &cells, &x, &y));
    for (cells = 1; jp_wavefront_next(&wave, &cells, &x, &y) == JP_WAVE_WAITING; cells = 1) {
        TEST_ASSERT_EQUAL_UINT32(0, cells);
        calls++;
    }
    TEST_ASSERT_EQUAL_UINT32(LONG / 128 + 1, calls);
}

/* Through a door that opens later. */
static void test_touched_cells_are_handed_out_again(void)
{
    test_target_behind_a_wall();
    const unsigned before = handed_out;
    grow();
    TEST_ASSERT_EQUAL_UINT32(before, handed_out);
    weights[3][20] = 1;
    jp_wavefront_touch(&wave, 19, 3);
    jp_wavefront_touch(&wave, 21, 3); /* not reached: nothing to hand out */
    jp_wavefront_resume(&wave);
    grow();
    TEST_ASSERT_TRUE(handed_out > before);
    TEST_ASSERT_EQUAL_UINT32(33, jp_wavefront_value(&wave, 30, 3));
    expect_values();
}

static void test_touching_changes_no_value(void)
{
    start(1, WIDTH - 1, HEIGHT - 1);
    grow();
    const unsigned before = handed_out;
    jp_wavefront_touch(&wave, 7, 3);
    jp_wavefront_touch(&wave, WIDTH - 1, HEIGHT - 1);
    jp_wavefront_resume(&wave);
    grow();
    TEST_ASSERT_EQUAL_UINT32(before + 2, handed_out);
    expect_values();
}

/* Cells become cheaper, one after the other and while the wave grows. */
static void test_repair_after_falling_weights(void)
{
    for (unsigned seed = 0; seed < SEEDS; seed++) {
        randomise(20);
        start(1 + below(20), WIDTH - 1, HEIGHT - 1);
        for (int edit = 0; edit < 10; edit++) {
            int32_t x = (int32_t)below(WIDTH);
            int32_t y = (int32_t)below(HEIGHT);
            weights[y][x] = 1;
            for (int i = 0; i < 4; i++) {
                const int32_t nx = x + neighbours[i][0];
                const int32_t ny = y + neighbours[i][1];
                if (is_inside(nx, ny)) {
                    jp_wavefront_touch(&wave, nx, ny);
                }
            }
            jp_wavefront_resume(&wave);
            unsigned slice = below(50);
            while (jp_wavefront_next(&wave, &slice, &x, &y) == JP_WAVE_CELL) {
                relax(x, y);
            }
        }
        grow();
        expect_values();
    }
}

/* Whatever was in its memory before. */
static void test_begins_in_any_memory(void)
{
    memset(&wave, 0xA5, sizeof wave);
    jp_wavefront_init(&wave, WIDTH, HEIGHT, JP_WAVE_2_BYTES, block);
    TEST_ASSERT_EQUAL_UINT32(0, wave.looks);
    start(1, WIDTH - 1, HEIGHT - 1);
    grow();
    expect_values();
}

/* Rows in which there is nothing take budget, a cell's for every 128 looks and words. */
static void test_empty_rows_take_budget(void)
{
    enum { ROWS = 300 };
    static uint64_t rows[(ROWS * 2 + ROWS * 4 + 16) / 8];
    int32_t x = 0;
    int32_t y = 0;
    unsigned cells = 100;

    TEST_ASSERT_TRUE(jp_wavefront_size(1, ROWS, JP_WAVE_2_BYTES) <= sizeof rows);
    jp_wavefront_init(&wave, 1, ROWS, JP_WAVE_2_BYTES, rows);
    start(1, 0, ROWS - 1);
    jp_wavefront_lower(&wave, 0, ROWS - 1, 0);
    TEST_ASSERT_EQUAL_INT(JP_WAVE_CELL, jp_wavefront_next(&wave, &cells, &x, &y));
    const int32_t first = y;
    TEST_ASSERT_EQUAL_UINT32(99, cells);
    TEST_ASSERT_EQUAL_INT(JP_WAVE_CELL, jp_wavefront_next(&wave, &cells, &x, &y));
    TEST_ASSERT_EQUAL_INT(ROWS - 1, first + y); /* the other one */
    TEST_ASSERT_EQUAL_UINT32(98 - ROWS / 128, cells);
}

/* Of rows that are wider than what is cleared at once, one. */
static void test_wide_rows_are_cleared(void)
{
    enum { WIDE = 400 };
    static uint64_t rows[(2 * WIDE * 2 + 2 * 52 + 16) / 8];

    TEST_ASSERT_TRUE(jp_wavefront_size(WIDE, 2, JP_WAVE_2_BYTES) <= sizeof rows);
    jp_wavefront_init(&wave, WIDE, 2, JP_WAVE_2_BYTES, rows);
    jp_wavefront_start(&wave, 1, 0, 0);
    for (int i = 0; i < 2; i++) {
        TEST_ASSERT_FALSE(jp_wavefront_is_clear(&wave));
        jp_wavefront_clear(&wave);
    }
    TEST_ASSERT_TRUE(jp_wavefront_is_clear(&wave));
}

/* Rows where a wave has been before are looked at no more than others: of a new one, those of its root. */
static void test_a_new_wave_looks_at_the_rows_of_its_root(void)
{
    for (int32_t row = HEIGHT - 1; row >= 0; row--) {
        start(1, WIDTH - 1, HEIGHT - 1);
        grow();
        jp_wavefront_start(&wave, 1, WIDTH - 1, HEIGHT - 1);
        clear();
        jp_wavefront_lower(&wave, 3, row, 0);
        TEST_ASSERT_EQUAL_INT(row, wave.first_row);
        TEST_ASSERT_EQUAL_INT(row, wave.last_row);
    }
}
