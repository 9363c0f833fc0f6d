/* The planner's scout, in blocks that are large enough for one: more than the RAM of the smallest core. */
#include <stddef.h>

#include "tests/support/planner_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

/* In a block with room for a scout. */
static void begin_with_scout(const struct jp_goal *to)
{
    static uint64_t large_block[40 * 1024 / sizeof(uint64_t)];
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_init(&planner, &config, &terrain, large_block, sizeof large_block, &field));
    TEST_ASSERT_TRUE(planner.internal.resting.state_count_max > 0);
    go(&west, to);
}

/* After the scout's route the proof ends as that of a new search. */
static void test_scout_goes_ahead(void)
{
    make_large_map();
    begin_with_scout(&east);
    expect_optimal();
    for (int32_t y = 1; y < 8; y++) {
        occupy(8, y);
        while (jp_planner_work(&planner, 1) == JP_ANSWER_OUT_OF_BUDGET) {
            TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
        }
        expect_drivable();
        expect_optimal();
        release(8, y);
        expect_as_if_new();
    }
}

/* The map changes, or the robot, wherever the scout is. */
static void test_scout_is_called_back(void)
{
    for (int slices = 0; slices < 40; slices++) {
        make_large_map();
        begin_with_scout(&east);
        expect_optimal();
        occupy(8, 4);
        for (int i = 0; i < slices; i++) {
            (void)jp_planner_work(&planner, 1);
        }
        if (slices % 2 == 0) {
            occupy(10, 8);
        } else {
            expect_start(JP_OK, 4, 5, 0);
        }
        expect_as_if_new();
    }
}

/** What is said of each answer until the search has ended; the last one is the optimum. */
static void expect_bounds(jp_cost optimum)
{
    const struct jp_plan *plan = jp_planner_plan(&planner);

    while (!jp_planner_is_idle(&planner)) {
        const enum jp_answer answer = jp_planner_work(&planner, 1);
        if (answer == JP_ANSWER_OPTIMAL || (answer == JP_ANSWER_WITHIN_BOUND && plan->bound != JP_BOUND_NONE)) {
            TEST_ASSERT_TRUE((uint64_t)plan->cost * JP_EPSILON_ONE <= (uint64_t)plan->bound * optimum);
        }
    }
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, plan->answer);
    TEST_ASSERT_EQUAL_UINT32(optimum, plan->cost);
}

/* The robot is elsewhere after any slice of the first search, also while a field grows, of which no bound holds yet. */
static void test_robot_that_jumps(void)
{
    static const struct jp_lattice_pose here = {2, 14, 1};
    static const struct jp_lattice_pose elsewhere = {8, 14, 9};
    static const struct jp_goal goal = {2, 2, 0x95B3};
    bool was_idle = false;

    config.lattice = &jp_lattice_gao2018;
    config.epsilon[0] = JP_EPSILON(3);
    map = (struct jp_terrain_config){.width = 12, .height = 16, .resolution = config.lattice->resolution};
    make_level_map(&map);
    begin_with_scout(&goal);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &elsewhere));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, finish());
    const jp_cost optimum = jp_planner_plan(&planner)->cost;

    for (unsigned slices = 0; !was_idle; slices++) {
        begin_with_scout(&goal);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &here));
        for (unsigned i = 0; i < slices; i++) {
            (void)jp_planner_work(&planner, 1);
        }
        was_idle = jp_planner_is_idle(&planner);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &elsewhere));
        expect_bounds(optimum);
    }
}

/* What is joined may take more steps than the route's memory holds: then the route is found anew, and cut. */
static void test_splice_that_does_not_fit_the_route(void)
{
    for (int32_t x = 7; x <= 8; x++) {
        for (uint16_t steps = 1; steps < STEPS; steps++) {
            make_level_map(&map);
            begin_with_scout(&east);
            expect_optimal();
            planner.internal.route_max = steps;
            planner.internal.effort.fresh_cost = 0; /* or the splice would be given up for a new search */
            occupy(x, 2);
            TEST_ASSERT_TRUE(finish() != JP_ANSWER_OUT_OF_BUDGET);
            TEST_ASSERT_TRUE(jp_planner_plan(&planner)->step_count <= steps);
            expect_drivable();
        }
    }
}

/* The way to the tail fits, the tail does not. */
static void test_splice_before_a_long_tail(void)
{
    static const struct jp_goal far = {47, 4, 1};

    map.width = 52;
    map.has_elevation = false;
    make_level_map(&map);
    begin_with_scout(&far);
    expect_optimal();
    planner.internal.route_max = 20;
    planner.internal.effort.fresh_cost = 0;
    occupy(14, 2);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_PARTIAL, finish());
    TEST_ASSERT_TRUE(jp_planner_plan(&planner)->step_count <= 20);
    expect_drivable();
}

/* Only the steps just before what is blocked are joined; the robot drives the others as before. */
static void test_splice_far_ahead(void)
{
    static const struct jp_goal far = {47, 4, 1};
    struct jp_lattice_pose pose = west;

    map.width = 52;
    map.has_elevation = false;
    make_level_map(&map);
    begin_with_scout(&far);
    (void)finish();
    TEST_ASSERT_TRUE(jp_planner_plan(&planner)->step_count > JP_PLANNER_SPLICE_STEPS + 1);
    planner.internal.effort.fresh_cost = 0;
    occupy(44, 2);
    while (jp_planner_work(&planner, 1) == JP_ANSWER_OUT_OF_BUDGET) {
        TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
    }
    expect_drivable();
    TEST_ASSERT_NOT_NULL(jp_planner_step(&planner, 0, &pose));
    TEST_ASSERT_EQUAL_INT(west.x + 1, pose.x);
    (void)finish();
    expect_drivable();
}
