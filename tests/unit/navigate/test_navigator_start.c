/* The cell from which the navigator plans: its own, or one near it that it can get to in a straight line. A robot that
 * is much thinner than the planner's disc stands in a corridor of one cell, from whose mouth on there is room to plan.
 */
#include "tests/support/navigator_rig.h"

enum { AT = 4 };

void setUp(void)
{
    rig_reset();
    config.radius = JP_Q16(0.045);
    config.margin = JP_Q16(0.003);
    origin = (struct jp_place){centre(AT, AT), 0};
}

void tearDown(void)
{
}

static void put_obstacle(int32_t x, int32_t y)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, JP_CELL_OCCUPIED));
}

/** The cells on either side of it are occupied up to `last`, and those behind it. */
static void build_corridor(int32_t last, bool along_x)
{
    for (int32_t at = 0; at <= last; at++) {
        for (int32_t beside = 0; beside < SIDE; beside++) {
            if (beside != AT || at < AT - 1) {
                put_obstacle(along_x ? at : beside, along_x ? beside : at);
            }
        }
    }
}

static bool plans(void)
{
    begin(18, 18);
    return jp_navigator_work(&navigator) != JP_NAVIGATOR_FAILED;
}

static void expect_start(int32_t x, int32_t y)
{
    TEST_ASSERT_TRUE(plans());
    TEST_ASSERT_EQUAL_INT(x, navigator.internal.start.x);
    TEST_ASSERT_EQUAL_INT(y, navigator.internal.start.y);
}

/* The planner wants two free cells between it and a wall. */
static void test_looks_for_a_place_as_far_as_four_cells_away(void)
{
    build_corridor(AT + 1, true);
    expect_start(AT + 4, AT);
    setUp();
    build_corridor(AT + 1, false);
    expect_start(AT, AT + 4);
}

static void test_looks_no_farther(void)
{
    build_corridor(AT + 2, true);
    TEST_ASSERT_FALSE(plans());
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_HEMMED_IN, navigator.reason);
    setUp();
    build_corridor(AT + 2, false);
    TEST_ASSERT_FALSE(plans());
}

/* Posts leave it way through, and no room for the planner but from 4, 5 cells away on. */
static void test_looks_no_farther_in_any_direction(void)
{
    for (int32_t y = 0; y < SIDE; y += 2) {
        for (int32_t x = 0; x < SIDE; x += 2) {
            if ((x < AT + 2 || y < AT + 3) && (x + y) % 4 != 0) {
                put_obstacle(x, y);
            }
        }
    }
    TEST_ASSERT_FALSE(plans());
}

/* The wall is a cell thick, and the room behind it near. */
static void test_a_place_behind_a_wall_is_none(void)
{
    put_column(AT + 1, 0, SIDE - 1, JP_CELL_OCCUPIED);
    put_column(AT - 1, 0, SIDE - 1, JP_CELL_OCCUPIED);
    TEST_ASSERT_FALSE(plans());
}

/* Its disc has room at the left edge of its cell and not at the centre, as that of a long robot along a wall; but it is
 * there. */
static void test_its_own_cell_needs_no_way(void)
{
    config.radius = JP_Q16(0.27);
    origin.point.x = AT * map.resolution + 10;
    put_column(AT + 3, 0, SIDE - 1, JP_CELL_OCCUPIED);
    init();
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(3, 18, JP_ANY_HEADING));
    (void)jp_navigator_work(&navigator);
    TEST_ASSERT_EQUAL_INT(AT, navigator.internal.start.x);
    TEST_ASSERT_EQUAL_INT(AT, navigator.internal.start.y);
}
