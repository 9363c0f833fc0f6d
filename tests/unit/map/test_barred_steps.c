/* Where steps cannot be driven, against looking at each cell that they sweep. */
#include "src/map/barred_steps.h"

#include <joulepath/tables.h>
#include <string.h>

#define LEVEL_MAP_BYTES 256
#include "src/map/unit_step.h"
#include "tests/support/level_map.h"
#include "tests/target/random.h"

enum { WIDTH = 75 /* more than two words */, HEIGHT = 9, MAPS = 6, BIT = 0x20, OTHER = 0x101 };

static uint32_t state;
static uint16_t row[WIDTH + 1];
static struct jp_lattice lattice;
static struct jp_pose_step step;

void setUp(void)
{
    state = 20261126;
    lattice = jp_lattice_courier24;
    memset(&step, 0, sizeof step);
}

void tearDown(void)
{
}

/* So many of a hundred cells are blocked. */
static void make_map(uint16_t width, uint32_t percent)
{
    const struct jp_terrain_config config = {.width = width, .height = HEIGHT, .resolution = JP_Q16(0.2)};

    make_level_map(&config);
    for (int32_t i = 0; i < width * HEIGHT; i++) {
        if (target_random(&state) % 100U < percent) {
            (void)jp_terrain_set_cell(&terrain, i % width, i / width, JP_CELL_OCCUPIED);
        }
    }
}

static bool is_barred(int32_t x, int32_t y)
{
    return step.primitive == NULL ||
           !jp_lattice_is_clear(&lattice, &terrain, step.primitive, x + step.begin.dx, y + step.begin.dy);
}

/* Bits of other headings stay, and what lies beyond the row. */
static unsigned expect_row(int32_t y)
{
    const int32_t width = terrain.config.width;
    unsigned barred = 0;

    for (int32_t x = 0; x <= width; x++) {
        row[x] = OTHER;
    }
    jp_barred_steps(&lattice, &terrain, &step, y, BIT, row);
    for (int32_t x = 0; x < width; x++) {
        barred += is_barred(x, y) ? 1U : 0U;
        TEST_ASSERT_EQUAL_UINT32(is_barred(x, y) ? OTHER | BIT : OTHER, row[x]);
    }
    TEST_ASSERT_EQUAL_UINT32(OTHER, row[width]);
    return barred;
}

/* Returns how many of its cells are barred. */
static unsigned expect_map(void)
{
    unsigned barred = 0;

    for (int32_t y = 0; y < HEIGHT; y++) {
        barred += expect_row(y);
    }
    return barred;
}

static void test_steps_of_every_heading_from_a_cell_and_to_it(void)
{
    for (unsigned i = 0; i < MAPS * JP_HEADINGS; i++) {
        const unsigned heading = i % JP_HEADINGS;
        const struct jp_cell_offset offset = jp_move_offsets[heading];

        make_map((uint16_t)(WIDTH - i / JP_HEADINGS), 3);
        step = (struct jp_pose_step){.primitive = jp_unit_step(&lattice, heading)};
        TEST_ASSERT_GREATER_THAN_UINT32(0, expect_map());
        step.begin = (struct jp_cell_offset){(int8_t)-offset.dx, (int8_t)-offset.dy};
        TEST_ASSERT_GREATER_THAN_UINT32(0, expect_map());
    }
}

/* One that ends with a word of bits, too. */
static void test_a_free_map_bars_at_its_sides_only(void)
{
    static const uint16_t widths[] = {32, 33, 64, WIDTH};

    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++) {
        make_map(widths[i], 0);
        step.primitive = jp_unit_step(&lattice, 0);
        TEST_ASSERT_LESS_THAN_UINT32(widths[i] * HEIGHT, expect_map());
    }
}

static void test_where_the_lattice_has_no_step_all_is_barred(void)
{
    make_map(WIDTH, 0);
    TEST_ASSERT_EQUAL_UINT32(WIDTH * HEIGHT, expect_map());
}

/* Of lengths that are joined in several ways, and of more cells than a word has. */
static void test_spans_of_any_length(void)
{
    struct jp_span span = {1, 0, 0};
    struct jp_primitive primitive = {.span_count = 1};

    lattice.spans = &span;
    step.primitive = &primitive;
    for (int first = -40; first <= 5; first += 3) {
        for (int length = 1; length <= 70; length += length < 6 ? 1 : 7) {
            span.first = (int8_t)first;
            span.last = (int8_t)(first + length - 1);
            make_map(WIDTH, 1);
            (void)expect_map();
        }
    }
}
