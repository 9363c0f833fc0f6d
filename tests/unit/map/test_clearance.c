/* A box between obstacles: where it fits to the micrometre, at every angle, and at the map's edge. */
#include "src/map/clearance.h"

#include "unity.h"

enum { SIDE = 40, CENTRE = 20 };

static struct jp_terrain terrain;
static uint64_t block[2 * SIDE * SIDE / 8];

void setUp(void)
{
    const struct jp_terrain_config config = {
        .width = SIDE, .height = SIDE, .resolution = JP_Q16(0.1), .unknown_is_free = true};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &config, block, sizeof block, &field));
}

void tearDown(void)
{
}

static void occupy(int32_t x, int32_t y)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, JP_CELL_OCCUPIED));
}

/* In thousandths of a cell. */
static bool is_clear(int32_t x, int32_t y, jp_angle heading, int32_t half_length, int32_t half_width)
{
    const int32_t one = JP_CELLS_ONE;
    const struct jp_box box = {.x = (jp_cells_q20)((int64_t)x * one / 1000),
                               .y = (jp_cells_q20)((int64_t)y * one / 1000),
                               .heading = heading,
                               .half_length = (jp_cells_q20)((int64_t)half_length * one / 1000),
                               .half_width = (jp_cells_q20)((int64_t)half_width * one / 1000)};

    return jp_box_is_clear(&terrain, &box);
}

static void test_an_empty_map_is_clear_up_to_its_edge(void)
{
    TEST_ASSERT_TRUE(is_clear(20000, 20000, 0, 5000, 3000));
    TEST_ASSERT_TRUE(is_clear(5001, 3001, 0, 5000, 3000));
    TEST_ASSERT_FALSE(is_clear(4999, 20000, 0, 5000, 3000));
    TEST_ASSERT_FALSE(is_clear(20000, 2999, 0, 5000, 3000));
    TEST_ASSERT_FALSE(is_clear(35001, 20000, 0, 5000, 3000));
    TEST_ASSERT_FALSE(is_clear(20000, 37001, 0, 5000, 3000));
    TEST_ASSERT_FALSE(is_clear(-50000, 20000, 0, 5000, 3000));
    TEST_ASSERT_TRUE(is_clear(36000, 20000, JP_ANGLE_DEGREES(90), 5000, 3000));
}

static void test_along_the_axes_it_fits_to_a_thousandth(void)
{
    occupy(CENTRE, CENTRE);
    for (int quarter = 0; quarter < 4; quarter++) {
        const jp_angle heading = (jp_angle)quarter << 30;
        const int32_t across = quarter % 2 == 0 ? 3000 : 5000;
        const int32_t along = 8000 - across;

        TEST_ASSERT_TRUE(is_clear(20000 - along - 1, 20500, heading, 5000, 3000));
        TEST_ASSERT_FALSE(is_clear(20000 - along + 1, 20500, heading, 5000, 3000));
        TEST_ASSERT_TRUE(is_clear(21000 + along + 1, 20500, heading, 5000, 3000));
        TEST_ASSERT_FALSE(is_clear(21000 + along - 1, 20500, heading, 5000, 3000));
        TEST_ASSERT_TRUE(is_clear(20500, 20000 - across - 1, heading, 5000, 3000));
        TEST_ASSERT_FALSE(is_clear(20500, 20000 - across + 1, heading, 5000, 3000));
        TEST_ASSERT_TRUE(is_clear(20500, 21000 + across + 1, heading, 5000, 3000));
        TEST_ASSERT_FALSE(is_clear(20500, 21000 + across - 1, heading, 5000, 3000));
    }
}

/* Its corner, √2 · 3 cells from the centre, or its side, 3 cells, touches the cell first. */
static void test_across_it_fits_by_its_own_sides(void)
{
    const jp_angle diagonal = JP_ANGLE_DEGREES(45);

    occupy(CENTRE, CENTRE);
    TEST_ASSERT_TRUE(is_clear(20000 - 4244, 20500, diagonal, 3000, 3000));
    TEST_ASSERT_FALSE(is_clear(20000 - 4241, 20500, diagonal, 3000, 3000));
    TEST_ASSERT_TRUE(is_clear(21000 + 4244, 20500, diagonal, 3000, 3000));
    TEST_ASSERT_FALSE(is_clear(21000 + 4241, 20500, diagonal, 3000, 3000));
    TEST_ASSERT_TRUE(is_clear(20500, 20000 - 4244, diagonal, 3000, 3000));
    TEST_ASSERT_FALSE(is_clear(20500, 20000 - 4241, diagonal, 3000, 3000));
    TEST_ASSERT_TRUE(is_clear(20500, 21000 + 4244, diagonal, 3000, 3000));
    TEST_ASSERT_FALSE(is_clear(20500, 21000 + 4241, diagonal, 3000, 3000));
    TEST_ASSERT_TRUE(is_clear(20000 - 2122, 20000 - 2122, diagonal, 3000, 9000));
    TEST_ASSERT_FALSE(is_clear(20000 - 2120, 20000 - 2120, diagonal, 3000, 9000));
    TEST_ASSERT_TRUE(is_clear(21000 + 2122, 20000 - 2122, diagonal, 9000, 3000));
    TEST_ASSERT_FALSE(is_clear(21000 + 2120, 20000 - 2120, diagonal, 9000, 3000));
}

static void test_a_cell_inside_is_found(void)
{
    occupy(CENTRE, CENTRE);
    for (int degrees = 0; degrees < 360; degrees += 5) {
        TEST_ASSERT_FALSE(is_clear(20500, 20500, JP_ANGLE_DEGREES(degrees), 4000, 600));
        TEST_ASSERT_FALSE(is_clear(22000, 19000, JP_ANGLE_DEGREES(degrees), 9000, 8000));
        TEST_ASSERT_TRUE(is_clear(26000, 26000, JP_ANGLE_DEGREES(degrees), 5000, 4000));
    }
}
