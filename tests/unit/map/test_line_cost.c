/* What straight lines over a map cost by the prices of a lattice. */
#include "src/map/line_cost.h"

#include <joulepath/tables.h>
#include <stdlib.h>

#define LEVEL_MAP_BYTES 1488 /* 24 × 24 cells with elevation and classes */
#include "tests/support/level_map.h"

enum { SIDE = 24 };

static struct jp_lattice prices;
static const struct jp_lattice *const lattice = &prices;

static void make_map(bool has_classes)
{
    const struct jp_terrain_config map = {.width = SIDE,
                                          .height = SIDE,
                                          .resolution = prices.resolution,
                                          .has_elevation = true,
                                          .has_classes = has_classes};

    make_level_map(&map);
}

void setUp(void)
{
    prices = jp_lattice_courier24;
    make_map(true);
}

void tearDown(void)
{
}

static struct jp_point centre(int32_t x, int32_t y)
{
    const jp_q16 cell = lattice->resolution;

    return (struct jp_point){(2 * x + 1) * cell / 2, (2 * y + 1) * cell / 2};
}

static jp_cost cost_of(int32_t x, int32_t y, int32_t to_x, int32_t to_y)
{
    const struct jp_point from = centre(x, y);
    const struct jp_point to = centre(to_x, to_y);

    return jp_line_cost(lattice, &terrain, &from, &to);
}

static jp_cost cost_of_step(int32_t rise)
{
    return jp_move_cost(&lattice->move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS], rise);
}

static void test_level_lines_cost_their_length(void)
{
    const jp_cost step = cost_of_step(0);

    TEST_ASSERT_EQUAL_UINT32(0, cost_of(5, 5, 5, 5));
    TEST_ASSERT_UINT32_WITHIN(1, 10 * step, cost_of(2, 3, 12, 3));
    TEST_ASSERT_UINT32_WITHIN(1, 10 * step, cost_of(2, 13, 2, 3));
    TEST_ASSERT_UINT32_WITHIN(1, 10 * step, cost_of(2, 3, 8, 11));
}

/* By 1/10 along x. */
static jp_elevation slope(int32_t x, int32_t y)
{
    (void)y;
    return (jp_elevation)(10 * x);
}

static void test_slopes_cost_as_the_steps_of_the_lattice(void)
{
    raise_map(slope);
    /* Eleven steps of ten elevenths of a cell. */
    TEST_ASSERT_UINT32_WITHIN(11 * 2, 10 * cost_of_step(10), cost_of(2, 3, 12, 3));
    TEST_ASSERT_UINT32_WITHIN(11 * 2, 10 * cost_of_step(-10), cost_of(12, 3, 2, 3));
    TEST_ASSERT_GREATER_THAN_UINT32(cost_of(12, 3, 2, 3), cost_of(2, 3, 12, 3));
    TEST_ASSERT_UINT32_WITHIN(1, 10 * cost_of_step(0), cost_of(5, 3, 5, 13));
}

/* Half of the way leads over ground that takes twice as much. */
static void test_lines_cost_by_the_ground_that_they_cross(void)
{
    const jp_cost step = cost_of_step(0);

    prices.ground[2].straight = JP_GROUND_ONE;
    for (int32_t y = 0; y < SIDE; y++) {
        for (int32_t x = 7; x < SIDE; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_class(&terrain, x, y, 2));
        }
    }
    TEST_ASSERT_UINT32_WITHIN(step, 15 * step + step / 2, cost_of(2, 3, 12, 3));
    TEST_ASSERT_UINT32_WITHIN(1, 20 * step, cost_of(10, 3, 20, 3));
    TEST_ASSERT_UINT32_WITHIN(1, 4 * step, cost_of(2, 3, 6, 3));
    make_map(false);
    prices.ground[0].straight = JP_GROUND_ONE; /* is not of this map */
    TEST_ASSERT_UINT32_WITHIN(1, 10 * step, cost_of(10, 3, 20, 3));
}

static jp_elevation step_up(int32_t x, int32_t y)
{
    (void)y;
    return (jp_elevation)(x < 10 ? 0 : 1024);
}

static void test_steps_that_are_too_steep(void)
{
    raise_map(step_up);
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, cost_of(2, 3, 12, 3));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, cost_of(12, 3, 2, 3));
    TEST_ASSERT_LESS_THAN_UINT32(JP_COST_MAX, cost_of(2, 3, 8, 3));
    TEST_ASSERT_LESS_THAN_UINT32(JP_COST_MAX, cost_of(12, 3, 20, 20));
}

/* Where what comes back is more than the way takes. */
static void test_no_line_costs_less_than_nothing(void)
{
    static struct jp_lattice free;

    free = *lattice;
    free.move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS] = (struct jp_slope_cost){
        .climb = {10 * 65536, 65536, 0}, .descend = {10 * 65536, 2 * 65536, 0}, .bend = 0, .rise_max = 20, .floor = 1};
    raise_map(slope);
    const struct jp_point from = centre(12, 3);
    const struct jp_point to = {centre(11, 3).x + lattice->resolution / 2, centre(11, 3).y};

    TEST_ASSERT_EQUAL_UINT32(0, jp_line_cost(&free, &terrain, &from, &to));
}

/* Where the wheels of one side alone are on ground that takes twice as much, the line takes half as much again. */
static void test_each_side_pays_for_its_ground(void)
{
    const jp_cost half_more = 12 * cost_of_step(0) + 12 * cost_of_step(0) / 2;

    prices.ground[2].straight = JP_GROUND_ONE;
    prices.half_track = lattice->resolution;
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_class(&terrain, i % SIDE, i / SIDE, i / SIDE >= 12 ? 2 : 0));
    }
    TEST_ASSERT_UINT32_WITHIN(2, half_more, cost_of(4, 11, 16, 11));
    TEST_ASSERT_UINT32_WITHIN(2, half_more, cost_of(16, 12, 4, 12));
    TEST_ASSERT_UINT32_WITHIN(2, 12 * cost_of_step(0), cost_of(4, 10, 16, 10));
    TEST_ASSERT_UINT32_WITHIN(2, 24 * cost_of_step(0), cost_of(4, 13, 16, 13));
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_class(&terrain, i % SIDE, i / SIDE, i % SIDE >= 12 ? 2 : 0));
    }
    TEST_ASSERT_UINT32_WITHIN(2, half_more, cost_of(11, 4, 11, 16));
    TEST_ASSERT_UINT32_WITHIN(2, half_more, cost_of(12, 16, 12, 4));
    TEST_ASSERT_UINT32_WITHIN(2, 12 * cost_of_step(0), cost_of(10, 4, 10, 16));
    TEST_ASSERT_UINT32_WITHIN(2, 24 * cost_of_step(0), cost_of(13, 4, 13, 16));
}

/* On a slanted line the wheels of its left side are on its left, by as much along both axes. */
static void test_sides_of_slanted_lines(void)
{
    const struct {
        int32_t x;
        int32_t y;
    } ends[] = {{16, 16}, {8, 16}, {8, 8}, {16, 8}};
    const jp_cost level = cost_of(12, 12, 16, 16);

    prices.ground[2].straight = JP_GROUND_ONE;
    prices.half_track = 4 * lattice->resolution;
    for (unsigned i = 0; i < 4U; i++) {
        const int32_t dx = ends[i].x - 12;
        const int32_t dy = ends[i].y - 12;

        for (int32_t cell = 0; cell < SIDE * SIDE; cell++) {
            const int32_t left = dx * (cell / SIDE - 12) - dy * (cell % SIDE - 12);
            const int32_t ahead = dx * (cell % SIDE - 12) + dy * (cell / SIDE - 12);

            TEST_ASSERT_EQUAL_INT(
                JP_OK, jp_terrain_set_class(&terrain, cell % SIDE, cell / SIDE, left > 0 && ahead > -16 ? 2 : 0));
        }
        TEST_ASSERT_UINT32_WITHIN(2, level + level / 2, cost_of(12, 12, ends[i].x, ends[i].y));
    }
}
