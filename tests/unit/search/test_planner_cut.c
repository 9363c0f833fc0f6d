/* Repairs that are given up: what a change cannot have touched of the search is kept, where that is worth it. */
#include "tests/support/planner_rig.h"

enum {
    LATE = 120, /* units of search after which a repair is done */
    AMPLE = UINT16_MAX,
    SMALL = 8
};

void setUp(void)
{
    rig_reset();
    make_large_map();
    config.epsilon[0] = JP_EPSILON_ONE;
    config.epsilon[1] = 0;
}

void tearDown(void)
{
}

/* The planner believes that a new search takes so much. */
static void believe(uint32_t effort)
{
    planner.internal.effort.fresh_end = effort;
    planner.internal.effort.fresh_route = effort;
}

/* The way is made narrow, and the repair given up after so many units of its search. True when it is cut. */
static bool cuts_after(int units)
{
    make_level_map(&map);
    begin();
    expect_optimal();
    occupy(8, 3);
    believe(AMPLE);
    while (planner.internal.phase != JP_PLANNER_SEARCH) {
        TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
        (void)jp_planner_work(&planner, 1);
    }
    for (int i = 0; i < units; i++) {
        (void)jp_planner_work(&planner, 1);
    }
    believe(SMALL);
    (void)jp_planner_work(&planner, 1);
    return planner.internal.phase == JP_PLANNER_CUT;
}

static jp_cost optimum_of_new_search(void)
{
    begin();
    expect_optimal();
    return jp_planner_plan(&planner)->cost;
}

/* Whenever the repair is given up, the optimum is found. */
static void test_optimum_after_any_cut(void)
{
    int cuts = 0;

    for (int units = SMALL; units < LATE; units++) {
        cuts += cuts_after(units);
        const uint32_t restarts = jp_planner_statistics(&planner)->restarts;
        believe(AMPLE);
        expect_optimal();
        TEST_ASSERT_EQUAL_UINT32(restarts, jp_planner_statistics(&planner)->restarts);
        const jp_cost cost = jp_planner_plan(&planner)->cost;
        make_level_map(&map);
        begin();
        occupy(8, 3);
        expect_optimal();
        TEST_ASSERT_EQUAL_UINT32(jp_planner_plan(&planner)->cost, cost);
    }
    TEST_ASSERT_TRUE(cuts > SMALL);
}

/* More is lost than a new search is believed to take. */
static void test_cut_that_is_not_worth_it(void)
{
    TEST_ASSERT_TRUE(cuts_after(SMALL));
    const uint32_t restarts = jp_planner_statistics(&planner)->restarts;
    believe(0);
    expect_optimal();
    TEST_ASSERT_EQUAL_UINT32(restarts + 1, jp_planner_statistics(&planner)->restarts);
    const jp_cost cost = jp_planner_plan(&planner)->cost;
    TEST_ASSERT_EQUAL_UINT32(optimum_of_new_search(), cost);
}

/* A change meets the whole search: the cut is ended first. */
static void test_change_during_the_cut(void)
{
    TEST_ASSERT_TRUE(cuts_after(SMALL));
    believe(AMPLE);
    raise(6, 4, 20);
    TEST_ASSERT_NOT_EQUAL_INT(JP_PLANNER_CUT, planner.internal.phase);
    expect_optimal();
    const jp_cost cost = jp_planner_plan(&planner)->cost;
    TEST_ASSERT_EQUAL_UINT32(optimum_of_new_search(), cost);
}

static void test_robot_is_elsewhere_during_the_cut(void)
{
    const struct jp_lattice_pose elsewhere = {5, 5, 0};

    TEST_ASSERT_TRUE(cuts_after(SMALL));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &elsewhere));
    TEST_ASSERT_NOT_EQUAL_INT(JP_PLANNER_CUT, planner.internal.phase);
    expect_optimal();
    TEST_ASSERT_EQUAL_INT(5, jp_planner_plan(&planner)->start.x);
}

/* What follows the cut is not given up again. */
static void test_what_the_cut_leaves_has_no_limit(void)
{
    TEST_ASSERT_TRUE(cuts_after(SMALL));
    const uint32_t restarts = jp_planner_statistics(&planner)->restarts;
    believe(AMPLE);
    (void)jp_planner_work(&planner, 1);
    while (planner.internal.phase == JP_PLANNER_CUT) {
        (void)jp_planner_work(&planner, 1);
    }
    believe(SMALL);
    expect_optimal();
    TEST_ASSERT_EQUAL_UINT32(restarts, jp_planner_statistics(&planner)->restarts);
}
