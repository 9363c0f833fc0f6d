/* The bound that a planner finds where its block has no room for the energy field beside the states. */
#include "tests/support/planner_rig.h"

enum { SMALL_BLOCK = 2400 };

void setUp(void)
{
    rig_reset();
    make_large_map();
    for (int32_t y = 0; y < HEIGHT_MAX; y++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, 8, y, 10)); /* a ridge to cross */
    }
}

void tearDown(void)
{
}

static void begin_in(size_t size)
{
    start_planner(size);
    TEST_ASSERT_EQUAL_UINT32(0, jp_planner_statistics(&planner)->field_bytes);
    go(&west, &east);
}

/* The bound of a schedule, in the small block. */
static uint16_t bound_of(uint16_t last_epsilon)
{
    config.epsilon[1] = JP_EPSILON(1.5);
    config.epsilon[2] = JP_EPSILON(1.2);
    config.epsilon[3] = last_epsilon;
    begin_in(SMALL_BLOCK);
    (void)finish();
    expect_drivable();
    return jp_planner_plan(&planner)->bound;
}

static void test_field_takes_the_place_of_the_states(void)
{
    const uint16_t without = bound_of(JP_EPSILON(1.1)); /* no proof is asked for */
    const uint16_t with = bound_of(JP_EPSILON_ONE);

    TEST_ASSERT_TRUE(without > JP_EPSILON_ONE);
    TEST_ASSERT_TRUE(with < without);
}

/* Around a wall no straight line and no field says what turning costs. */
static void build_wall(void)
{
    setUp();
    for (int32_t y = 0; y < 9; y++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, 8, y, JP_CELL_OCCUPIED));
    }
}

/* Until the bound is there. */
static void plan_with_lent_states(void)
{
    build_wall();
    begin_in(SMALL_BLOCK);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_WITHIN_BOUND, finish());
    TEST_ASSERT_TRUE(planner.internal.lent != JP_PLANNER_LENT_TO_NONE);
}

static void test_lent_states_are_not_told(void)
{
    struct jp_lattice_pose pose;
    uint32_t slot = 0;
    bool is_open;

    plan_with_lent_states();
    TEST_ASSERT_FALSE(jp_planner_next_state(&planner, &slot, &pose, &is_open));
    TEST_ASSERT_EQUAL_UINT32(0, slot);
}

static void expect_as_if_begun_anew(void)
{
    const enum jp_answer answer = finish();
    const struct jp_plan plan = *jp_planner_plan(&planner);

    expect_drivable();
    jp_planner_restart(&planner);
    TEST_ASSERT_EQUAL_INT(answer, finish());
    TEST_ASSERT_EQUAL_UINT32(plan.cost, jp_planner_plan(&planner)->cost);
}

static void test_obstacle_beside_the_route_leaves_plan_and_bound(void)
{
    plan_with_lent_states();
    const struct jp_plan plan = *jp_planner_plan(&planner);
    const uint32_t restarts = jp_planner_statistics(&planner)->restarts;

    occupy(15, 0);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_WITHIN_BOUND, finish());
    TEST_ASSERT_EQUAL_UINT32(plan.cost, jp_planner_plan(&planner)->cost);
    TEST_ASSERT_TRUE(jp_planner_plan(&planner)->bound <= plan.bound);
    TEST_ASSERT_EQUAL_UINT32(restarts, jp_planner_statistics(&planner)->restarts);
}

static void test_other_changes_begin_anew(void)
{
    plan_with_lent_states();
    occupy(8, 9); /* on the route round the wall */
    expect_as_if_begun_anew();
    plan_with_lent_states();
    raise(8, 12, -10); /* cheaper ground beside it: the route stays meanwhile */
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_WITHIN_BOUND, jp_planner_work(&planner, STEPS));
    expect_drivable();
    (void)finish();
    expect_drivable();
    plan_with_lent_states();
    expect_start(JP_OK, 5, 5, 0); /* off the route */
    expect_as_if_begun_anew();
}

/* Wherever the bound is, the plan stays and what is claimed of it holds. */
static void test_changes_while_the_bound_grows(void)
{
    for (int slices = 0; slices < 200; slices += 7) {
        struct jp_lattice_pose pose = west;
        plan_with_lent_states();
        jp_planner_restart(&planner);
        while (planner.internal.phase != JP_PLANNER_GROW_BOUND) {
            (void)jp_planner_work(&planner, 1);
        }
        for (int i = 0; i < slices; i++) {
            (void)jp_planner_work(&planner, 1);
        }
        occupy(15, 0);
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_WITHIN_BOUND, jp_planner_work(&planner, STEPS));
        TEST_ASSERT_NOT_NULL(jp_planner_step(&planner, 0, &pose));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &pose));
        (void)finish();
        expect_drivable();
        const struct jp_plan plan = *jp_planner_plan(&planner);
        TEST_ASSERT_TRUE(plan.bound < JP_BOUND_NONE);
        build_wall();
        start_planner(sizeof block);
        occupy(15, 0);
        go(&pose, &east);
        (void)finish(); /* no more than within a bound, too: the cost of the best that is known */
        TEST_ASSERT_TRUE((uint64_t)plan.cost * JP_EPSILON_ONE <=
                         (uint64_t)plan.bound * jp_planner_plan(&planner)->cost);
    }
}

/* The bound of the turns on the way to the goal is that of the turn field, over the goal's headings. */
static void test_turns_to_the_goal_are_those_of_the_field(void)
{
    static struct jp_turn_field field;
    static uint64_t field_block[64];
    jp_cost largest = 0;
    const uint16_t headings[] = {1U, 1U << 4, 1U << 12 | 1U << 3};

    for (unsigned i = 0; i < sizeof headings / sizeof headings[0]; i++) {
        const struct jp_goal goal = {east.x, east.y, headings[i]};
        jp_cost expected = JP_COST_MAX;
        unsigned looks = UINT32_MAX;
        unsigned first = 0;

        build_wall();
        TEST_ASSERT_TRUE(jp_turn_field_size(&map, JP_TURN_SCALE_MAX) <= sizeof field_block);
        start_planner(SMALL_BLOCK);
        go(&west, &goal);
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_WITHIN_BOUND, finish());
        while (((headings[i] >> first) & 1U) == 0U) {
            first++;
        }
        jp_turn_field_init(&field, lattice, config.cost, &terrain, JP_TURN_SCALE_MAX, field_block);
        jp_turn_field_start(&field, &planner.internal.turns, west.x, west.y, west.heading, goal.x, goal.y, first);
        TEST_ASSERT_TRUE(jp_turn_field_grow(&field, &looks));
        for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
            const jp_cost bound = jp_turn_field_bound(&field, goal.x, goal.y, heading);

            expected = ((headings[i] >> heading) & 1U) != 0U && bound < expected ? bound : expected;
        }
        TEST_ASSERT_EQUAL_UINT32(expected, planner.internal.turns_to_goal);
        largest = expected > largest ? expected : largest;
    }
    TEST_ASSERT_TRUE(largest > 0U);
}
