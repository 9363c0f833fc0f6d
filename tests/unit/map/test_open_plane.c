/* The plane of open cells against jp_lattice_is_open(), cell by cell. */
#include "src/map/open_plane.h"

#include <joulepath/tables.h>

#include "tests/target/random.h"
#include "unity.h"

enum { WIDTH_MAX = 70, HEIGHT = 11, ROW_WORDS = 3, FREE_CELL_PERCENT = 92 };

static struct jp_terrain terrain;
static uint64_t map_block[2 * ROW_WORDS * HEIGHT / 2];
static uint32_t plane[ROW_WORDS * HEIGHT + 1];
static uint32_t random_state = 11;

void setUp(void)
{
}

void tearDown(void)
{
}

static void make_map(int32_t width, bool unknown_is_free)
{
    const struct jp_terrain_config config = {.width = (uint16_t)width,
                                             .height = HEIGHT,
                                             .resolution = jp_lattice_courier24.resolution,
                                             .unknown_is_free = unknown_is_free};
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &config, map_block, sizeof map_block, &field));
    for (int32_t i = 0; i < width * HEIGHT; i++) {
        const uint32_t draw = target_random(&random_state) % 100U;

        if (draw != 0U) {
            TEST_ASSERT_EQUAL_INT(JP_OK,
                                  jp_terrain_set_cell(&terrain, i % width, i / width,
                                                      draw < FREE_CELL_PERCENT ? JP_CELL_FREE : JP_CELL_OCCUPIED));
        }
    }
}

static void make_plane(const struct jp_lattice *lattice)
{
    const size_t words = jp_open_plane_size(&terrain.config) / sizeof *plane;
    unsigned core = 0;

    for (unsigned i = 0; i < lattice->core.span_count; i++) {
        const struct jp_span *span = &lattice->spans[lattice->core.first_span + i];
        core += (unsigned)(span->last - span->first) + 1U;
    }
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(sizeof plane / sizeof *plane - 1U, words);
    plane[words] = 0x5A5A5A5AU;
    for (int32_t y = 0; y < HEIGHT; y++) {
        TEST_ASSERT_EQUAL_UINT32(core * words / HEIGHT, jp_open_plane_make_row(plane, lattice, &terrain, y));
    }
    TEST_ASSERT_EQUAL_UINT32(0x5A5A5A5AU, plane[words]);
}

static void expect_as_the_lattice_says(const struct jp_lattice *lattice)
{
    for (int32_t y = -2; y < HEIGHT + 2; y++) {
        for (int32_t x = -40; x < WIDTH_MAX + 40; x++) {
            const uint32_t bits = jp_open_plane_look(plane, &terrain, x, y);

            for (int32_t i = 0; i < 32; i += 31) {
                TEST_ASSERT_EQUAL_UINT32(jp_lattice_is_open(lattice, &terrain, x + i, y), (bits >> i) & 1U);
            }
        }
    }
}

static void test_open_cells_of_maps_of_all_widths(void)
{
    for (int32_t width = 1; width <= WIDTH_MAX; width++) {
        make_map(width, width % 2 == 0);
        make_plane(&jp_lattice_courier24);
        expect_as_the_lattice_says(&jp_lattice_courier24);
    }
}

static void test_of_another_robot(void)
{
    make_map(WIDTH_MAX, true);
    make_plane(&jp_lattice_zhang2018);
    expect_as_the_lattice_says(&jp_lattice_zhang2018);
}

/* Also where the core reaches farther to one side than to the other. */
static void test_of_a_core_that_is_not_symmetric(void)
{
    static const struct jp_span spans[] = {{-1, 0, 2}, {0, -3, 0}, {2, 1, 1}};
    struct jp_lattice lattice = jp_lattice_courier24;

    lattice.spans = spans;
    lattice.core = (struct jp_cells){0, 3};
    make_map(WIDTH_MAX, true);
    make_plane(&lattice);
    expect_as_the_lattice_says(&lattice);
}
