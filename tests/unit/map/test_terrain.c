/* The map of the ground, against plain arrays with one entry a cell. */
#include <string.h>

#include <joulepath/terrain.h>

#include "tests/target/random.h"
#include "unity.h"

#define SEED        UINT32_C(20180900)
#define WIDTH_MAX   70
#define HEIGHT_MAX  9
#define BLOCK_WORDS 1024 /* 8 KiB: a map of 1 × 1024 cells without elevation */
#define EDGE        3    /* cells beyond the map that are looked at */

static struct jp_terrain_config config;
static struct jp_terrain terrain;
static uint64_t block[BLOCK_WORDS];
static uint32_t state;

/* The plain arrays. */
static uint8_t cells[HEIGHT_MAX][WIDTH_MAX];
static jp_elevation heights[HEIGHT_MAX][WIDTH_MAX];

void setUp(void)
{
    config = (struct jp_terrain_config){
        .width = WIDTH_MAX, .height = HEIGHT_MAX, .resolution = JP_Q16(0.2), .has_elevation = true};
    state = SEED;
}

void tearDown(void)
{
}

static enum jp_status init(const char **field)
{
    return jp_terrain_init(&terrain, &config, block, sizeof block, field);
}

static void start(void)
{
    const char *field = "";

    memset(block, 0x5A, sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_OK, init(&field));
    TEST_ASSERT_NULL(field);
    memset(cells, JP_CELL_UNKNOWN, sizeof cells);
    memset(heights, 0, sizeof heights);
}

static int32_t between(int32_t low, int32_t high)
{
    return low + (int32_t)(target_random(&state) % (uint32_t)(high - low + 1));
}

static bool is_inside(int32_t x, int32_t y)
{
    return x >= 0 && x < config.width && y >= 0 && y < config.height;
}

static bool is_drivable(int32_t x, int32_t y)
{
    return is_inside(x, y) &&
           (cells[y][x] == JP_CELL_FREE || (cells[y][x] == JP_CELL_UNKNOWN && config.unknown_is_free));
}

static bool is_clear(const struct jp_span *spans, size_t count, int32_t x, int32_t y)
{
    for (size_t i = 0; i < count; i++) {
        for (int32_t column = spans[i].first; column <= spans[i].last; column++) {
            if (!is_drivable(x + column, y + spans[i].y)) {
                return false;
            }
        }
    }
    return true;
}

static void set(int32_t x, int32_t y, enum jp_cell cell)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, cell));
    cells[y][x] = (uint8_t)cell;
}

static void set_all(enum jp_cell cell)
{
    for (int32_t y = 0; y < config.height; y++) {
        for (int32_t x = 0; x < config.width; x++) {
            set(x, y, cell);
        }
    }
}

/* Every cell of the map and some round it. */
static void expect_same(void)
{
    for (int32_t y = -EDGE; y < config.height + EDGE; y++) {
        for (int32_t x = -EDGE; x < config.width + EDGE; x++) {
            const bool inside = is_inside(x, y);
            TEST_ASSERT_TRUE(jp_terrain_contains(&terrain, x, y) == inside);
            TEST_ASSERT_EQUAL_INT(inside ? cells[y][x] : JP_CELL_OCCUPIED, jp_terrain_cell(&terrain, x, y));
            TEST_ASSERT_EQUAL_INT(inside ? heights[y][x] : 0, jp_terrain_elevation(&terrain, x, y));
        }
    }
}

static void expect_clear(int32_t x, int32_t y, int8_t first, int8_t last)
{
    const struct jp_span span = {0, first, last};

    TEST_ASSERT_TRUE(jp_terrain_is_clear(&terrain, &span, 1, x, y) == is_clear(&span, 1, x, y));
}

/* ---- Start ---- */

static void expect_config(const char *expected)
{
    const char *field = "";
    const enum jp_status status = init(&field);

    if (expected == NULL) {
        TEST_ASSERT_EQUAL_INT(JP_OK, status);
        TEST_ASSERT_NULL(field);
        TEST_ASSERT_NOT_EQUAL(0, jp_terrain_size(&config));
    } else {
        TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, status);
        TEST_ASSERT_EQUAL_STRING(expected, field);
        TEST_ASSERT_EQUAL_UINT32(0, jp_terrain_size(&config));
    }
    setUp();
}

#define FIELD(member, value, expected)                                                                                 \
    do {                                                                                                               \
        config.member = (value);                                                                                       \
        expect_config(expected);                                                                                       \
    } while (0)

static void test_init_checks_every_field_at_its_limits(void)
{
    FIELD(width, 0, "width");
    FIELD(width, 1, NULL);
    FIELD(width, JP_TERRAIN_SIDE_MAX + 1, "width");
    FIELD(width, UINT16_MAX, "width");
    FIELD(height, 0, "height");
    FIELD(height, 1, NULL);
    FIELD(height, JP_TERRAIN_SIDE_MAX + 1, "height");
    FIELD(height, UINT16_MAX, "height");
    FIELD(cost_shift, 8, NULL);
    FIELD(cost_shift, 9, "cost_shift");
    FIELD(resolution, 0, "resolution");
    FIELD(resolution, -1, "resolution");
    FIELD(resolution, INT32_MIN, "resolution");
    FIELD(resolution, 1, NULL);
    FIELD(resolution, INT32_MAX, NULL);
    config.height = 0;
    FIELD(width, 0, "width"); /* the first of two */
    config.has_elevation = false;
    config.width = 1;
    FIELD(height, 1024, NULL);
    config.has_elevation = false;
    config.has_costs = false;
    config.height = 1;
    FIELD(width, JP_TERRAIN_SIDE_MAX, NULL);
    config.height = JP_TERRAIN_SIDE_MAX;
    const char *field = "";
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, init(&field)); /* no field is out of range */
}

static void test_size_is_two_bits_a_cell_in_words_two_bytes_an_elevation_one_a_cost_and_two_bits_a_class(void)
{
    static const struct {
        uint16_t width;
        uint16_t height;
        uint32_t planes; /* bytes */
    } sizes[] = {{1, 1, 8},   {31, 2, 16}, {32, 2, 16},       {33, 2, 32},
                 {64, 3, 48}, {65, 3, 72}, {300, 300, 24000}, {4096, 4096, 4194304}};

    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        config.width = sizes[i].width;
        config.height = sizes[i].height;
        config.has_elevation = false;
        TEST_ASSERT_EQUAL_UINT32(sizes[i].planes, jp_terrain_size(&config));
        config.has_elevation = true;
        const uint32_t count = (uint32_t)sizes[i].width * sizes[i].height;
        TEST_ASSERT_EQUAL_UINT32(sizes[i].planes + 2 * count, jp_terrain_size(&config));
        config.has_costs = true;
        TEST_ASSERT_EQUAL_UINT32(sizes[i].planes + 3 * count, jp_terrain_size(&config));
        config.has_elevation = false;
        TEST_ASSERT_EQUAL_UINT32(sizes[i].planes + count, jp_terrain_size(&config));
        config.has_classes = true;
        TEST_ASSERT_EQUAL_UINT32(sizes[i].planes + count + (count + 3U) / 4U, jp_terrain_size(&config));
        config.has_costs = false;
        config.has_classes = false;
    }
    TEST_ASSERT_EQUAL_UINT32(0, jp_terrain_size(NULL));
}

static void test_init_refuses_null_pointers(void)
{
    const char *field = "untouched";

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_terrain_init(NULL, &config, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_terrain_init(&terrain, NULL, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_terrain_init(&terrain, &config, NULL, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_terrain_init(&terrain, &config, block, sizeof block, NULL));
    TEST_ASSERT_EQUAL_STRING("untouched", field);
}

static void test_init_refuses_a_small_or_misaligned_block_and_leaves_it_alone(void)
{
    const char *field = "";
    unsigned char *bytes = (unsigned char *)block;
    const size_t size = jp_terrain_size(&config);

    memset(block, 0x5A, sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_terrain_init(&terrain, &config, block, 0, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_terrain_init(&terrain, &config, block, size - 1, &field));
    for (size_t shift = 1; shift < 8; shift++) {
        TEST_ASSERT_EQUAL_INT(JP_ERR_ALIGNMENT, jp_terrain_init(&terrain, &config, bytes + shift, size, &field));
    }
    for (size_t i = 0; i < sizeof block; i++) {
        TEST_ASSERT_EQUAL_INT(0x5A, bytes[i]);
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &config, block, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &config, bytes + 8, size, &field));
}

/* Whatever is set stays within the stated size. */
static void test_nothing_is_written_beyond_the_size(void)
{
    const unsigned char *bytes = (const unsigned char *)block;
    static const uint16_t widths[] = {1, 31, 32, 33, 64, 65, WIDTH_MAX};

    for (size_t i = 0; i < sizeof widths / sizeof widths[0]; i++) {
        for (int elevation = 0; elevation < 2; elevation++) {
            config.width = widths[i];
            config.has_elevation = elevation != 0;
            start();
            set_all(JP_CELL_OCCUPIED);
            for (int32_t x = 0; x < config.width && config.has_elevation; x++) {
                TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, x, config.height - 1, INT16_MIN));
            }
            for (size_t k = jp_terrain_size(&config); k < sizeof block; k++) {
                TEST_ASSERT_EQUAL_INT(0x5A, bytes[k]);
            }
        }
    }
}

static void test_starts_unknown_and_level(void)
{
    for (int free = 0; free < 2; free++) {
        config.unknown_is_free = free != 0;
        start();
        expect_same();
        TEST_ASSERT_EQUAL_UINT32(0, terrain.version);
        expect_clear(0, 0, 0, WIDTH_MAX - 1);
    }
}

/* ---- Cells ---- */

static void test_keeps_every_cell_apart(void)
{
    static const enum jp_cell kinds[] = {JP_CELL_FREE, JP_CELL_OCCUPIED, JP_CELL_UNKNOWN};

    start();
    for (int32_t y = 0; y < config.height; y++) {
        for (int32_t x = 0; x < config.width; x++) {
            set(x, y, kinds[(x + 2 * y) % 3]);
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)(100 * x - 999 * y)));
            heights[y][x] = (jp_elevation)(100 * x - 999 * y);
        }
    }
    expect_same();
}

static void test_changes_a_cell_between_all_kinds(void)
{
    start();
    for (int from = JP_CELL_FREE; from <= JP_CELL_UNKNOWN; from++) {
        for (int to = JP_CELL_FREE; to <= JP_CELL_UNKNOWN; to++) {
            for (int32_t x = 30; x <= 34; x++) {
                set(x, 4, (enum jp_cell)from);
                set(x, 4, (enum jp_cell)to);
                expect_clear(x, 4, 0, 0);
            }
        }
    }
    expect_same();
}

static void test_refuses_cells_outside_and_unknown_kinds(void)
{
    static const int32_t places[][2] = {
        {-1, 0},        {0, -1},        {WIDTH_MAX, 0}, {0, HEIGHT_MAX}, {INT32_MIN, 0},
        {INT32_MAX, 0}, {0, INT32_MIN}, {0, INT32_MAX}, {-1, -1},        {WIDTH_MAX, HEIGHT_MAX}};

    start();
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        const int32_t x = places[i][0];
        const int32_t y = places[i][1];
        TEST_ASSERT_FALSE(jp_terrain_contains(&terrain, x, y));
        TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_terrain_set_cell(&terrain, x, y, JP_CELL_FREE));
        TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_terrain_set_elevation(&terrain, x, y, 1));
        TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, jp_terrain_cell(&terrain, x, y));
        TEST_ASSERT_EQUAL_INT(0, jp_terrain_elevation(&terrain, x, y));
    }
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_terrain_set_cell(&terrain, 0, 0, (enum jp_cell)3));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_terrain_set_cell(&terrain, -1, 0, (enum jp_cell)3));
    expect_same();
    TEST_ASSERT_EQUAL_UINT32(0, terrain.version);
}

static void test_counts_the_changes(void)
{
    start();
    set(3, 3, JP_CELL_FREE);
    TEST_ASSERT_EQUAL_UINT32(1, terrain.version);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, 3, 3, 7));
    TEST_ASSERT_EQUAL_UINT32(2, terrain.version);
    (void)jp_terrain_cell(&terrain, 3, 3);
    (void)jp_terrain_elevation(&terrain, 3, 3);
    expect_clear(3, 3, 0, 0);
    TEST_ASSERT_EQUAL_UINT32(2, terrain.version);
}

/* ---- Elevation ---- */

static void test_elevation_takes_its_whole_range(void)
{
    static const jp_elevation values[] = {INT16_MIN, INT16_MAX, -1, 0, 1};

    start();
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, (int32_t)i, 2, values[i]));
        heights[2][i] = values[i];
    }
    expect_same();
}

static void test_a_map_without_elevation_is_level(void)
{
    config.has_elevation = false;
    start();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_terrain_set_elevation(&terrain, 1, 1, 5));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_terrain_set_elevation(&terrain, -1, 1, 5));
    TEST_ASSERT_EQUAL_UINT32(0, terrain.version);
    set_all(JP_CELL_FREE);
    expect_same();
}

/* ---- Costs ---- */

static void test_costs_stay_apart_from_elevations(void)
{
    const unsigned char *bytes = (const unsigned char *)block;

    config = (struct jp_terrain_config){.width = 5, .height = 4, .resolution = JP_Q16(0.2), .has_costs = true};
    for (int elevation = 0; elevation < 2; elevation++) {
        config.has_elevation = elevation != 0;
        start();
        for (int32_t i = 0; i < 20; i++) {
            TEST_ASSERT_EQUAL_INT(0, jp_terrain_cost(&terrain, i % 5, i / 5));
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cost(&terrain, i % 5, i / 5, (uint8_t)(255 - i)));
            (void)jp_terrain_set_elevation(&terrain, i % 5, i / 5, (jp_elevation)(-100 * i));
        }
        for (int32_t i = 0; i < 20; i++) {
            TEST_ASSERT_EQUAL_INT(255 - i, jp_terrain_cost(&terrain, i % 5, i / 5));
            TEST_ASSERT_EQUAL_INT(elevation * -100 * i, jp_terrain_elevation(&terrain, i % 5, i / 5));
        }
        TEST_ASSERT_EQUAL_UINT32(elevation != 0 ? 40 : 20, terrain.version);
        TEST_ASSERT_EQUAL_INT(0x5A, bytes[jp_terrain_size(&config)]);
    }
}

/* Four cells share a byte, also with those of the next row. */
static void test_classes_stay_apart_from_costs_and_from_each_other(void)
{
    static const bool has_costs[2] = {false, true};

    for (unsigned i = 0; i < 2U; i++) {
        config = (struct jp_terrain_config){
            .width = 5, .height = 3, .resolution = JP_Q16(0.2), .has_costs = has_costs[i], .has_classes = true};
        start();
        for (int32_t cell = 0; cell < 15; cell++) {
            TEST_ASSERT_EQUAL_INT(0, jp_terrain_class(&terrain, cell % 5, cell / 5));
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_class(&terrain, cell % 5, cell / 5, (uint8_t)(cell % 4)));
            (void)jp_terrain_set_cost(&terrain, cell % 5, cell / 5, UINT8_MAX);
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_class(&terrain, 2, 1, 0));
        for (int32_t cell = 0; cell < 15; cell++) {
            TEST_ASSERT_EQUAL_INT(cell == 7 ? 0 : cell % 4, jp_terrain_class(&terrain, cell % 5, cell / 5));
            TEST_ASSERT_EQUAL_INT(has_costs[i] ? UINT8_MAX : 0, jp_terrain_cost(&terrain, cell % 5, cell / 5));
        }
    }
}

static void test_a_class_is_a_change_of_the_map(void)
{
    config.has_classes = true;
    start();

    const uint32_t before = terrain.version;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_class(&terrain, 0, 0, JP_GROUND_CLASSES - 1U));
    TEST_ASSERT_EQUAL_UINT32(before + 1U, terrain.version);
}

static void test_classes_that_cannot_be_set(void)
{
    config.has_classes = true;
    start();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_terrain_set_class(&terrain, 0, 0, JP_GROUND_CLASSES));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_terrain_set_class(&terrain, -1, 0, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_terrain_set_class(&terrain, 0, config.height, 1));
    TEST_ASSERT_EQUAL_INT(0, jp_terrain_class(&terrain, -1, 0));
    config.has_classes = false;
    start();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_terrain_set_class(&terrain, 0, 0, 1));
    TEST_ASSERT_EQUAL_INT(0, jp_terrain_class(&terrain, 0, 0));
}

static void test_costs_that_cannot_be_set(void)
{
    config.has_elevation = false;
    config.has_costs = true;
    start();
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_terrain_set_cost(&terrain, -1, 0, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_terrain_set_cost(&terrain, 0, config.height, 1));
    TEST_ASSERT_EQUAL_INT(0, jp_terrain_cost(&terrain, -1, 0));
    config.has_costs = false;
    start();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_terrain_set_cost(&terrain, 0, 0, 1));
    TEST_ASSERT_EQUAL_INT(0, jp_terrain_cost(&terrain, 0, 0));
    TEST_ASSERT_EQUAL_UINT32(0, terrain.version);
}

/* ---- Clear spans ---- */

/* One blocked cell, and every span of its row. */
static void test_finds_one_blocked_cell_in_every_span(void)
{
    static const int32_t blocked[] = {0, 1, 30, 31, 32, 33, 62, 63, 64, 65, WIDTH_MAX - 1};

    start();
    set_all(JP_CELL_FREE);
    for (size_t i = 0; i < sizeof blocked / sizeof blocked[0]; i++) {
        set(blocked[i], 5, JP_CELL_OCCUPIED);
        for (int32_t first = -2; first < WIDTH_MAX + 2; first++) {
            for (int32_t last = first; last < WIDTH_MAX + 2; last++) {
                expect_clear(0, 5, (int8_t)first, (int8_t)last);
            }
        }
        set(blocked[i], 5, JP_CELL_FREE);
    }
}

/* One free cell in an occupied row. */
static void test_finds_one_free_cell(void)
{
    start();
    set_all(JP_CELL_OCCUPIED);
    for (int32_t x = 0; x < WIDTH_MAX; x++) {
        set(x, 5, JP_CELL_FREE);
        for (int32_t at = 0; at < WIDTH_MAX; at++) {
            expect_clear(at, 5, 0, 0);
            expect_clear(at, 5, 0, 1);
        }
        set(x, 5, JP_CELL_OCCUPIED);
    }
}

static void test_neighbouring_rows_do_not_matter(void)
{
    start();
    set_all(JP_CELL_OCCUPIED);
    for (int32_t x = 0; x < WIDTH_MAX; x++) {
        set(x, 4, JP_CELL_FREE);
    }
    expect_clear(0, 4, 0, WIDTH_MAX - 1);
    expect_clear(0, 3, 0, WIDTH_MAX - 1);
    expect_clear(0, 5, 0, WIDTH_MAX - 1);
}

static void test_beyond_the_map_is_blocked_and_no_spans_are_clear(void)
{
    const struct jp_span rows[] = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}};

    start();
    set_all(JP_CELL_FREE);
    for (int32_t y = -2; y < HEIGHT_MAX + 2; y++) {
        TEST_ASSERT_TRUE(jp_terrain_is_clear(&terrain, rows, 3, 10, y) == (y >= 1 && y <= HEIGHT_MAX - 2));
    }
    for (int32_t x = -130; x < WIDTH_MAX + 130; x++) {
        expect_clear(x, 0, -1, 1);
        expect_clear(x, HEIGHT_MAX - 1, INT8_MIN, INT8_MAX);
    }
    TEST_ASSERT_TRUE(jp_terrain_is_clear(&terrain, rows, 0, -5, -5));
}

static void test_unknown_cells_follow_the_configuration(void)
{
    for (int free = 0; free < 2; free++) {
        config.unknown_is_free = free != 0;
        start();
        set_all(JP_CELL_FREE);
        set(31, 2, JP_CELL_UNKNOWN);
        const struct jp_span span = {0, 0, 0};
        TEST_ASSERT_TRUE(jp_terrain_is_clear(&terrain, &span, 1, 31, 2) == (free != 0));
        TEST_ASSERT_EQUAL_INT(JP_CELL_UNKNOWN, jp_terrain_cell(&terrain, 31, 2));
    }
}

/* ---- Heights and slopes ---- */

/* Of cells of 0.25 m that rise by 1/4 to the east and fall by 1/8 to the north, m. */
static void make_slope(void)
{
    config.width = 8;
    config.height = 6;
    config.resolution = JP_Q16(0.25);
    config.has_elevation = true;
    start();
    set_all(JP_CELL_FREE);
    for (int32_t y = 0; y < 6; y++) {
        for (int32_t x = 0; x < 8; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)(64 * x - 32 * y)));
        }
    }
}

static jp_q16 height_at(jp_q16 x, jp_q16 y)
{
    const struct jp_point point = {x, y};

    return jp_terrain_height(&terrain, &point);
}

static void test_heights_lie_between_those_of_the_cells(void)
{
    make_slope();
    TEST_ASSERT_EQUAL_INT32(0, height_at(JP_Q16(0.125), JP_Q16(0.125)));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.25), height_at(JP_Q16(1.125), JP_Q16(0.125)));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.25 - 0.0625), height_at(JP_Q16(1.125), JP_Q16(0.625)));
    TEST_ASSERT_INT32_WITHIN(1, JP_Q16(0.225 - 0.0125), height_at(JP_Q16(1.025), JP_Q16(0.225)));
}

static void test_heights_beyond_the_middles_of_the_outermost_cells(void)
{
    const jp_q16 north_east = JP_Q16(7 * 0.0625 - 5 * 0.03125);

    make_slope();
    TEST_ASSERT_EQUAL_INT32(0, height_at(JP_Q16(-3), JP_Q16(0.01)));
    TEST_ASSERT_EQUAL_INT32(north_east, height_at(JP_Q16(1.999), JP_Q16(1.499)));
    TEST_ASSERT_EQUAL_INT32(north_east, height_at(INT32_MAX, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(0, height_at(INT32_MIN, INT32_MIN));
}

static void test_level_maps_have_no_height(void)
{
    config.has_elevation = false;
    start();
    set_all(JP_CELL_FREE);
    TEST_ASSERT_EQUAL_INT32(0, height_at(JP_Q16(0.3), JP_Q16(0.4)));
    TEST_ASSERT_EQUAL_UINT32(0, jp_terrain_block_steep(&terrain, 0));
}

/* Of 1/4 and 1/8 together: 0.2795. */
static void test_ground_that_is_too_steep_is_blocked(void)
{
    make_slope();
    TEST_ASSERT_EQUAL_UINT32(0, jp_terrain_block_steep(&terrain, JP_Q24(0.28)));
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, jp_terrain_cell(&terrain, 3, 3));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, 2, 2, JP_CELL_UNKNOWN));
    TEST_ASSERT_EQUAL_UINT32(8 * 6 - 1, jp_terrain_block_steep(&terrain, JP_Q24(0.279)));
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, jp_terrain_cell(&terrain, 3, 3));
    TEST_ASSERT_EQUAL_INT(JP_CELL_UNKNOWN, jp_terrain_cell(&terrain, 2, 2));
    TEST_ASSERT_EQUAL_UINT32(0, jp_terrain_block_steep(&terrain, JP_Q24(0.1)));
}

/* A step in the middle of level ground; a map of one cell has no slope. */
static void test_only_the_edges_of_a_step_are_steep(void)
{
    make_slope();
    for (int32_t y = 0; y < 6; y++) {
        for (int32_t x = 0; x < 8; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)(x < 4 ? 0 : 32767)));
        }
    }
    TEST_ASSERT_EQUAL_UINT32(2 * 6, jp_terrain_block_steep(&terrain, JP_Q24(1)));
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, jp_terrain_cell(&terrain, 3, 0));
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, jp_terrain_cell(&terrain, 4, 5));
    config.width = 1;
    config.height = 1;
    start();
    set_all(JP_CELL_FREE);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, 0, 0, 1000));
    TEST_ASSERT_EQUAL_UINT32(0, jp_terrain_block_steep(&terrain, 0));
    TEST_ASSERT_INT32_WITHIN(1, JP_Q16(1000.0 / 1024), height_at(JP_Q16(0.1), JP_Q16(7)));
}

/* ---- Random ---- */

static struct jp_span random_span(void)
{
    const int32_t first = between(-20, 20);

    return (struct jp_span){
        .y = (int8_t)between(-4, 4), .first = (int8_t)first, .last = (int8_t)(first + between(0, 20))};
}

static void random_change(void)
{
    const int32_t x = between(-1, config.width);
    const int32_t y = between(-1, config.height);
    const jp_elevation height = (jp_elevation)between(INT16_MIN, INT16_MAX);
    /* Mostly free, or no span would be clear. */
    const enum jp_cell cell = between(0, 19) < 18 ? JP_CELL_FREE : (enum jp_cell)between(0, 2);
    const enum jp_status expected = is_inside(x, y) ? JP_OK : JP_ERR_OUTSIDE;

    TEST_ASSERT_EQUAL_INT(expected, jp_terrain_set_cell(&terrain, x, y, cell));
    TEST_ASSERT_EQUAL_INT(config.has_elevation ? expected : JP_ERR_STATE,
                          jp_terrain_set_elevation(&terrain, x, y, height));
    if (expected == JP_OK) {
        cells[y][x] = (uint8_t)cell;
        heights[y][x] = config.has_elevation ? height : 0;
    }
}

static int random_look(void)
{
    const struct jp_span spans[] = {random_span(), random_span()};
    const int32_t x = between(-5, config.width + 5);
    const int32_t y = between(-5, config.height + 5);
    const size_t count = (size_t)between(0, 2);
    const bool clear = is_clear(spans, count, x, y);

    TEST_ASSERT_TRUE(jp_terrain_is_clear(&terrain, spans, count, x, y) == clear);
    return clear && count > 0;
}

static void test_random_maps_agree_with_plain_arrays(void)
{
    int clear = 0;

    for (int map = 0; map < 40; map++) {
        config.width = (uint16_t)between(1, WIDTH_MAX);
        config.height = (uint16_t)between(1, HEIGHT_MAX);
        config.has_elevation = between(0, 1) != 0;
        config.unknown_is_free = between(0, 1) != 0;
        start();
        set_all(JP_CELL_FREE);
        for (int i = 0; i < 800; i++) {
            random_change();
            clear += random_look();
        }
        expect_same();
    }
    TEST_ASSERT_GREATER_THAN_INT(1000, clear);
}

/* Before anything is known, nothing is free where unknown is not. */
static void test_unknown_cells_of_a_new_map(void)
{
    const char *field = "";
    const struct jp_span here = {0, 0, 0};

    for (int is_free = 0; is_free < 2; is_free++) {
        config.unknown_is_free = is_free != 0;
        TEST_ASSERT_EQUAL_INT(JP_OK, init(&field));
        for (int32_t i = 0; i < WIDTH_MAX * HEIGHT_MAX; i++) {
            TEST_ASSERT_EQUAL_INT(JP_CELL_UNKNOWN, jp_terrain_cell(&terrain, i % WIDTH_MAX, i / WIDTH_MAX));
            TEST_ASSERT_EQUAL_INT(is_free, jp_terrain_is_clear(&terrain, &here, 1, i % WIDTH_MAX, i / WIDTH_MAX));
        }
    }
}

/* On a plane the height is that of the plane, exactly at the cells' middles, as far as the map goes; beyond the last
 * middles it is level. */
static void test_heights_on_a_steep_plane(void)
{
    const char *field = "";
    const jp_q16 cell = JP_Q16(0.25);
    const int32_t unit = JP_Q16_ONE / JP_ELEVATION_ONE;

    config.resolution = cell;
    TEST_ASSERT_EQUAL_INT(JP_OK, init(&field));
    for (int32_t y = 0; y < HEIGHT_MAX; y++) {
        for (int32_t x = 0; x < WIDTH_MAX; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)(400 * x + 200 * y)));
        }
    }
    for (int32_t y = 0; y < HEIGHT_MAX; y++) {
        for (int32_t x = 0; x < WIDTH_MAX; x++) {
            const struct jp_point middle = {x * cell + cell / 2, y * cell + cell / 2};
            const struct jp_point corner = {(x + 1) * cell, (y + 1) * cell};
            const int32_t across = x + 1 < WIDTH_MAX ? 200 : 0;
            const int32_t along = y + 1 < HEIGHT_MAX ? 100 : 0;
            const int32_t here = 400 * x + 200 * y;
            TEST_ASSERT_EQUAL_INT32(here * unit, jp_terrain_height(&terrain, &middle));
            TEST_ASSERT_EQUAL_INT32((here + across + along) * unit, jp_terrain_height(&terrain, &corner));
        }
    }
}

/* Along both axes between the middles of four cells, to a unit of the map. */
static int32_t height_between(int32_t x, int32_t y, jp_q16 cell)
{
    const int64_t along = 2 * x > cell ? 2 * (int64_t)x - cell : 0; /* half units from the first middle */
    const int64_t up = 2 * y > cell ? 2 * (int64_t)y - cell : 0;
    const int32_t i = (int32_t)(along / (2 * cell));
    const int32_t j = (int32_t)(up / (2 * cell));
    const int64_t east = along % (2 * cell);
    const int64_t north = up % (2 * cell);
    const int64_t west = 2 * (int64_t)cell - east;
    const int64_t south = 2 * (int64_t)cell - north;
    const int64_t sum =
        (jp_terrain_elevation(&terrain, i, j) * west + jp_terrain_elevation(&terrain, i + 1, j) * east) * south +
        (jp_terrain_elevation(&terrain, i, j + 1) * west + jp_terrain_elevation(&terrain, i + 1, j + 1) * east) * north;

    return (int32_t)(sum * (JP_Q16_ONE / JP_ELEVATION_ONE) / (4 * (int64_t)cell * cell));
}

/* On ground as steep as it comes, close to the middles of the cells, to their borders and anywhere. */
static void test_heights_anywhere(void)
{
    static const jp_q16 sides[] = {JP_Q16(1), JP_Q16(0.05), JP_Q16(0.2), 24000};
    const char *field = "";

    for (size_t k = 0; k < sizeof sides / sizeof *sides; k++) {
        const jp_q16 cell = sides[k];

        config.resolution = cell;
        TEST_ASSERT_EQUAL_INT(JP_OK, init(&field));
        for (int32_t i = 0; i < WIDTH_MAX * HEIGHT_MAX; i++) {
            const jp_elevation elevation = (jp_elevation)((i * 7919) % 4001 - 2000);

            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, i % WIDTH_MAX, i / WIDTH_MAX, elevation));
        }
        for (int32_t i = 0; i < 600; i++) {
            const int32_t off = i % 3 == 0 ? i % 5 - 2 : i % 3 == 1 ? (i * 37) % cell : cell / 2 + i % 5 - 2;
            const int32_t x = cell / 2 + (i % (WIDTH_MAX - 2)) * cell + off;
            const int32_t y = cell / 2 + (i % (HEIGHT_MAX - 2)) * cell + (i % 2 == 0 ? off : (i * 91) % cell);

            TEST_ASSERT_INT32_WITHIN(cell == JP_Q16_ONE ? 4 : 16, height_between(x, y, cell),
                                     jp_terrain_height(&terrain, &(struct jp_point){x, y}));
        }
    }
}
