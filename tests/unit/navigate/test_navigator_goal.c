/* Where the navigator goes when its goal is blocked, against a look at every cell of the map. */
#include "src/navigate/navigator_goal.h"
#include "tests/support/navigator_rig.h"

/** A generator for maps: x ← 1664525 x + 1013904223. */
static uint32_t state;

static uint32_t chance(uint32_t below)
{
    state = state * 1664525U + 1013904223U;
    return (state >> 16) % below;
}

void setUp(void)
{
    rig_reset();
    init();
}

void tearDown(void)
{
}

static bool can_stand(int32_t x, int32_t y, uint16_t headings)
{
    bool can = false;

    for (uint8_t heading = 0; heading < JP_HEADINGS; heading++) {
        const bool is_allowed = (headings & (uint16_t)(1U << heading)) != 0U;
        can = can || (is_allowed && jp_lattice_can_stand(planner.internal.config.lattice, &terrain, x, y, heading));
    }
    return can;
}

/** The nearest within `reach` cells; of those as near the first of the lowest row. */
static struct jp_point nearest(int32_t goal_x, int32_t goal_y, uint16_t headings, int32_t reach)
{
    struct jp_point best = {goal_x, goal_y};
    int32_t least = reach * reach + 1;

    for (int32_t y = 0; y < SIDE; y++) {
        for (int32_t x = 0; x < SIDE; x++) {
            const int32_t square = (x - goal_x) * (x - goal_x) + (y - goal_y) * (y - goal_y);

            if (square < least && can_stand(x, y, headings)) {
                least = square;
                best = (struct jp_point){x, y};
            }
        }
    }
    return best;
}

static void expect_goal(int16_t x, int16_t y, uint16_t headings, int32_t reach)
{
    const struct jp_point expected = nearest(x, y, headings, reach);

    navigator.config.radius = reach * map.resolution + 1;
    navigator.internal.asked = (struct jp_goal){x, y, headings};

    const struct jp_goal goal = jp_navigator_choose_goal(&navigator);

    TEST_ASSERT_EQUAL_INT32(expected.x, goal.x);
    TEST_ASSERT_EQUAL_INT32(expected.y, goal.y);
    TEST_ASSERT_EQUAL_HEX16(headings, goal.headings);
}

static void scatter(uint32_t obstacles)
{
    for (uint32_t i = 0; i < obstacles; i++) {
        const int32_t x = (int32_t)chance(SIDE);

        put_column(x, (int32_t)chance(SIDE - 1), SIDE - 1, JP_CELL_FREE);
        put_column(x, SIDE / 2, SIDE / 2 + (int32_t)chance(3), JP_CELL_OCCUPIED);
    }
}

static void test_a_goal_with_room_stays(void)
{
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        navigator.internal.asked = (struct jp_goal){12, 12, (uint16_t)(1U << heading)};

        const struct jp_goal goal = jp_navigator_choose_goal(&navigator);

        TEST_ASSERT_EQUAL_INT16(12, goal.x);
        TEST_ASSERT_EQUAL_INT16(12, goal.y);
    }
}

static void test_the_nearest_place_that_covers_it_is_taken(void)
{
    state = 20261;
    for (unsigned i = 0; i < 40; i++) {
        make_level_map(&map);
        scatter(1U + chance(5));
        for (unsigned k = 0; k < 4; k++) {
            const int16_t x = (int16_t)(6U + chance(12));
            const int16_t y = (int16_t)(10U + chance(6));

            expect_goal(x, y, (uint16_t)(1U << chance(JP_HEADINGS)), 1 + (int32_t)chance(4));
        }
    }
}

/* A rectangle has room nearer to a wall along it than askew. */
static void test_only_headings_of_the_goal_count(void)
{
    struct jp_planner_config *plan = &planner.internal.config;
    unsigned differences = 0;

    plan->lattice = &jp_lattice_zhang2018;
    for (int16_t y = 12; y < 18; y++) {
        make_level_map(&map);
        for (int32_t x = 0; x < SIDE; x++) {
            put_column(x, 18, 18, JP_CELL_OCCUPIED);
        }
        expect_goal(12, y, 1U << 0, 4);
        expect_goal(12, y, 1U << 1, 4);
        differences += can_stand(12, y, 1U << 0) != can_stand(12, y, 1U << 1) ? 1U : 0U;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(0, differences);
}

/* Of places on either side the one in the lower row, and there the left one. */
static void test_of_places_as_near_the_first_is_taken(void)
{
    for (int32_t x = 0; x < SIDE; x++) {
        put_column(x, 12, 12, JP_CELL_OCCUPIED);
    }
    expect_goal(12, 12, JP_ANY_HEADING, 3);
    make_level_map(&map);
    put_column(12, 0, SIDE - 1, JP_CELL_OCCUPIED);
    expect_goal(12, 12, JP_ANY_HEADING, 3);
}
