/* The planner while starts, goals and the map change, and where memory is short. */
#include <stddef.h>

#include "tests/support/planner_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

/* Moving starts and new goals */

static void test_driving_on_needs_no_expansions(void)
{
    struct jp_lattice_pose pose = west;

    begin();
    expect_optimal();
    const uint32_t expansions = jp_planner_statistics(&planner)->expansions;
    for (unsigned left = STEPS - 1; left > 0; left--) {
        TEST_ASSERT_NOT_NULL(jp_planner_step(&planner, 0, &pose));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &pose));
        TEST_ASSERT_TRUE(jp_planner_is_idle(&planner));
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, jp_planner_work(&planner, 0));
        expect_optimal();
        TEST_ASSERT_EQUAL_UINT32(left * AXIS_COST, jp_planner_plan(&planner)->cost);
    }
    TEST_ASSERT_EQUAL_UINT32(expansions, jp_planner_statistics(&planner)->expansions);
    TEST_ASSERT_EQUAL_UINT32(1, jp_planner_statistics(&planner)->restarts);
}

static void test_start_that_was_not_on_the_route(void)
{
    static const struct jp_lattice_pose starts[] = {{5, 5, 0}, {4, 3, 2}, {11, 3, 15}, {12, 4, 1}};

    begin();
    expect_optimal();
    for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &starts[i]));
        expect_as_if_new();
    }
}

/* A plan that is within a bound keeps one as the robot drives along it, and stays a route of what is left. */
static void test_bound_follows_the_robot(void)
{
    struct jp_lattice_pose pose = west;

    config.epsilon[1] = 0;
    for (int32_t y = 0; y < HEIGHT; y++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, 8, y, 10)); /* a ridge: the bound is above 1 */
    }
    begin();
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_WITHIN_BOUND, finish());
    const struct jp_plan *plan = jp_planner_plan(&planner);
    while (plan->step_count > 0) {
        const unsigned steps = plan->step_count;
        TEST_ASSERT_NOT_NULL(jp_planner_step(&planner, 0, &pose));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &pose));
        TEST_ASSERT_TRUE(jp_planner_is_idle(&planner));
        TEST_ASSERT_EQUAL_UINT32(steps - 1, plan->step_count);
        TEST_ASSERT_EQUAL_INT(plan->answer, jp_planner_work(&planner, 0));
        TEST_ASSERT_TRUE(plan->bound >= JP_EPSILON_ONE);
        expect_drivable();
    }
    TEST_ASSERT_EQUAL_UINT32(0, plan->cost);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, plan->answer);
}

/* The route is there before its proof: the robot drives, and the search goes on. */
static void test_robot_drives_during_the_proof(void)
{
    struct jp_lattice_pose pose = west;

    begin();
    raise(8, 4, 10);
    while (jp_planner_work(&planner, 1) != JP_ANSWER_WITHIN_BOUND || planner.internal.phase != JP_PLANNER_SEARCH) {
        TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
    }
    TEST_ASSERT_NOT_NULL(jp_planner_step(&planner, 0, &pose));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &pose));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_WITHIN_BOUND, jp_planner_work(&planner, 0));
    expect_as_if_new();
}

static void test_start_moves_during_the_search(void)
{
    const struct jp_lattice_pose next = {5, 5, 0};

    for (int slices = 0; slices < 120; slices += 3) {
        begin();
        for (int i = 0; i < slices; i++) {
            (void)jp_planner_work(&planner, 1);
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &next));
        expect_as_if_new();
    }
}

/* The field, rooted on one side of the wall, says nothing of the other. */
static void test_start_moves_across_a_wall(void)
{
    static const struct jp_lattice_pose beyond = {12, 4, 4};
    static const struct jp_goal goal = {11, 5, 1U << 4};

    for (unsigned level = 0; level < 2; level++) {
        config.epsilon[0] = level == 0 ? JP_EPSILON(2) : JP_EPSILON_ONE;
        config.epsilon[1] = 0;
        for (int slices = 0; slices < 60; slices++) {
            make_level_map(&map);
            start_planner(sizeof block);
            wall(true);
            go(&(const struct jp_lattice_pose){3, 4, 0}, &goal);
            for (int i = 0; i < slices; i++) {
                (void)jp_planner_work(&planner, 1);
            }
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &beyond));
            const enum jp_answer answer = finish();
            TEST_ASSERT_TRUE(answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_WITHIN_BOUND);
            expect_drivable();
        }
    }
}

/* The robot is found beyond the wall after the proof, and while the field waits for a change of the map. */
static void test_start_moves_across_a_wall_after_the_proof(void)
{
    static const struct jp_lattice_pose here = {3, 4, 4};
    static const struct jp_lattice_pose beyond = {12, 4, 4};
    static const struct jp_goal goal = {3, 4, 1U << 4};

    config.epsilon[0] = JP_EPSILON_ONE;
    config.epsilon[1] = 0;
    for (uint32_t waits = 0; waits < 2; waits++) {
        start_planner(sizeof block);
        wall(true);
        go(&here, &goal);
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, finish());
        if (waits == 1) {
            occupy(15, 0);
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &beyond));
        TEST_ASSERT_EQUAL_UINT32(2 - waits, jp_planner_statistics(&planner)->restarts);
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_UNREACHABLE, finish());
        TEST_ASSERT_EQUAL_UINT32(2, jp_planner_statistics(&planner)->restarts);
    }
}

static void test_new_goal_begins_anew(void)
{
    static const struct jp_goal other = {8, 5, 1U << 4};

    begin();
    expect_optimal();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(&planner, &other));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_work(&planner, 0));
    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, jp_planner_plan(&planner)->cost); /* the old plan is still there */
    expect_optimal();
    TEST_ASSERT_EQUAL_INT(other.y, jp_planner_plan(&planner)->end.y);
    TEST_ASSERT_EQUAL_UINT32(2, jp_planner_statistics(&planner)->restarts);
}

/* Changes of the map */

static void test_cells_that_cannot_be_changed(void)
{
    begin();
    expect_optimal();
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_planner_set_cell(&planner, -1, 0, JP_CELL_FREE));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_planner_set_cell(&planner, 0, HEIGHT, JP_CELL_FREE));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_planner_set_cell(&planner, INT32_MAX, INT32_MIN, JP_CELL_FREE));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_set_cell(&planner, 0, 0, (enum jp_cell)3));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_planner_set_elevation(&planner, WIDTH, 0, 1));
    TEST_ASSERT_TRUE(jp_planner_is_idle(&planner));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, jp_planner_work(&planner, 1));
}

static void test_changes_that_change_nothing(void)
{
    begin();
    expect_optimal();
    release(7, 4);
    raise(7, 4, 0);
    TEST_ASSERT_TRUE(jp_planner_is_idle(&planner));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, jp_planner_work(&planner, 1));
}

static void test_unknown_is_as_the_map_says(void)
{
    for (int is_free = 0; is_free < 2; is_free++) {
        map.unknown_is_free = is_free != 0;
        make_level_map(&map);
        begin();
        expect_optimal();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_cell(&planner, 8, 2, JP_CELL_UNKNOWN));
        TEST_ASSERT_TRUE(jp_planner_is_idle(&planner) == (is_free != 0));
        expect_as_if_new();
        TEST_ASSERT_TRUE((jp_planner_plan(&planner)->cost == STEPS * AXIS_COST) == (is_free != 0));
    }
}

static void test_obstacle_comes_and_goes(void)
{
    begin();
    expect_optimal();
    for (int i = 0; i < 3; i++) {
        occupy(8, 2);
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_work(&planner, 0));
        expect_optimal();
        TEST_ASSERT_TRUE(jp_planner_plan(&planner)->cost > STEPS * AXIS_COST);
        release(8, 2);
        expect_optimal();
        TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, jp_planner_plan(&planner)->cost);
    }
}

/* The route does not sweep the cell: it is looked at once more, and is the optimum still. */
static void test_obstacle_beside_the_route(void)
{
    make_large_map();
    begin();
    expect_optimal();
    const uint32_t expansions = jp_planner_statistics(&planner)->expansions;
    occupy(8, 13);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_work(&planner, 0));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, jp_planner_work(&planner, STEPS));
    expect_optimal();
    TEST_ASSERT_EQUAL_UINT32(expansions, jp_planner_statistics(&planner)->expansions);
}

/* A route that stays open is an answer at once; with cheaper ground about, its proof has to be found anew. */
static void test_route_on_changed_ground_stays_published(void)
{
    const struct jp_plan *plan = jp_planner_plan(&planner);

    make_large_map();
    begin();
    expect_optimal();
    raise(8, 4, 10);
    const enum jp_answer answer = jp_planner_work(&planner, STEPS);
    TEST_ASSERT_TRUE(answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_WITHIN_BOUND);
    TEST_ASSERT_EQUAL_INT(answer, plan->answer);
    TEST_ASSERT_TRUE(plan->cost > STEPS * AXIS_COST);
    expect_drivable();
    expect_as_if_new();
}

/* While the plan is looked at, the robot is found elsewhere. */
static void test_start_moves_while_the_plan_is_checked(void)
{
    begin();
    expect_optimal();
    occupy(15, 0);
    TEST_ASSERT_EQUAL_INT(JP_PLANNER_CHECK_PLAN, planner.internal.phase);
    expect_start(JP_OK, 5, 5, 0);
    expect_as_if_new();
}

/* Changes that leave no room for their repair end it, with the plan checked. */
static void test_more_changes_while_the_plan_is_checked(void)
{
    begin();
    expect_optimal();
    for (int32_t i = 0; i <= JP_PLANNER_CHANGES; i++) {
        raise(15, i % HEIGHT, (jp_elevation)(1 + i));
    }
    expect_as_if_new();
}

/* A route that no search has measured is given up for a new one only where that is cheaper. */
static void test_repair_is_given_up_for_a_new_search(void)
{
    begin();
    expect_optimal();
    planner.internal.effort.fresh_route = 1;
    planner.internal.effort.fresh_end = 1;
    const uint32_t restarts = jp_planner_statistics(&planner)->restarts;
    occupy(8, 2);
    expect_optimal();
    TEST_ASSERT_TRUE(jp_planner_statistics(&planner)->restarts > restarts);
    planner.internal.effort.fresh_cost = 0; /* as before any search has ended */
    occupy(9, 2);
    release(8, 2);
    expect_as_if_new();
}

/* The proof of a route that stays open is given up, the route is not. */
static void test_proof_is_given_up_for_a_new_one(void)
{
    make_large_map();
    config.epsilon[0] = JP_EPSILON_ONE;
    config.epsilon[1] = 0;
    begin();
    expect_optimal();
    raise(8, 4, 10);
    planner.internal.effort.fresh_end = 1;
    const uint32_t restarts = jp_planner_statistics(&planner)->restarts;
    while (jp_planner_work(&planner, 1) == JP_ANSWER_OUT_OF_BUDGET) {
    }
    while (!jp_planner_is_idle(&planner)) {
        TEST_ASSERT_NOT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_work(&planner, 1));
    }
    TEST_ASSERT_EQUAL_UINT32(restarts + 1, jp_planner_statistics(&planner)->restarts);
    expect_optimal();
}

/* In the guide, the field, the clearing, the search, the trace, the repair and the sorting. */
static void test_change_in_every_phase(void)
{
    bool seen[JP_PLANNER_SETTLED + 1] = {false};
    unsigned phases = 0;

    for (int slices = 0; slices < 1500; slices += slices < 70 ? 1 : 61) {
        make_level_map(&map);
        begin();
        for (int i = 0; i < slices; i++) {
            if (i == 50) {
                raise(8, 4, 15);
            }
            (void)jp_planner_work(&planner, 1);
        }
        phases += !seen[planner.internal.phase];
        seen[planner.internal.phase] = true;
        occupy(8, slices % 3);
        raise(6, 4, (jp_elevation)(slices % 40));
        expect_as_if_new();
    }
    TEST_ASSERT_TRUE(seen[JP_PLANNER_TRACE]);
    TEST_ASSERT_TRUE(phases >= 7);
}

static void work_until_clearing(bool by_guide)
{
    make_level_map(&map);
    config.epsilon[0] = by_guide ? JP_EPSILON(2) : JP_EPSILON_ONE;
    config.epsilon[1] = by_guide ? JP_EPSILON_ONE : 0;
    begin();
    while (planner.internal.phase != JP_PLANNER_CLEAR) {
        TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
        (void)jp_planner_work(&planner, 1);
    }
}

/* The fields are grown, the search has not begun: what changes now is neither repaired nor forgotten. */
static void test_change_while_the_states_are_cleared(void)
{
    for (int i = 0; i < 2; i++) {
        work_until_clearing(i == 0);
        raise(8, 4, -10);
        TEST_ASSERT_EQUAL_INT(i == 0 ? JP_PLANNER_CLEAR : JP_PLANNER_GROW_FIELD, planner.internal.phase);
        expect_as_if_new();
        work_until_clearing(i == 0);
        occupy(8, 4);
        TEST_ASSERT_EQUAL_INT(JP_PLANNER_CLEAR, planner.internal.phase);
        expect_as_if_new();
        work_until_clearing(i == 0);
        expect_start(JP_OK, 5, 5, 0);
        TEST_ASSERT_EQUAL_INT(i == 0 ? JP_PLANNER_CLEAR : JP_PLANNER_GROW_FIELD, planner.internal.phase);
        expect_as_if_new();
    }
}

static void test_more_changes_than_are_repaired_together(void)
{
    begin();
    expect_optimal();
    for (int round = 0; round < 2; round++) {
        for (int32_t i = 0; i < 2 * JP_PLANNER_CHANGES + 5; i++) {
            raise(i % WIDTH, i / WIDTH % HEIGHT, (jp_elevation)((i * 7 + round) % 13));
        }
        expect_as_if_new();
    }
}

/* Too narrow to turn in: nothing is left to expand when the robot, at its end, is reached. */
static void test_robot_at_the_end_of_a_passage(void)
{
    map.height = 5;
    make_level_map(&map);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, 8, 2, 10)); /* a ridge: the bound is above 1 */
    config.epsilon[1] = 0;
    start_planner(sizeof block);
    go(&(const struct jp_lattice_pose){2, 2, 0}, &(const struct jp_goal){12, 2, 1});
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_WITHIN_BOUND, finish());
    expect_drivable();
}

static void test_no_way_through_a_wall(void)
{
    begin();
    expect_optimal();
    const struct jp_plan before = *jp_planner_plan(&planner);
    wall(true);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_UNREACHABLE, finish());
    TEST_ASSERT_TRUE(jp_planner_is_idle(&planner));
    TEST_ASSERT_EQUAL_MEMORY(&before, jp_planner_plan(&planner), sizeof before);
    jp_planner_restart(&planner);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_UNREACHABLE, finish());
    wall(false);
    expect_optimal();
    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, jp_planner_plan(&planner)->cost);
}

static void test_robot_or_goal_is_walled_in(void)
{
    begin();
    expect_optimal();
    occupy(west.x, west.y);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_UNREACHABLE, finish());
    release(west.x, west.y);
    expect_optimal();
    occupy(east.x, east.y);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_UNREACHABLE, finish());
    release(east.x, east.y);
    expect_optimal();
}

static void test_too_steep_is_no_way(void)
{
    begin();
    for (int32_t y = 0; y < HEIGHT; y++) {
        raise(7, y, 2000);
        raise(8, y, 2000);
    }
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_UNREACHABLE, finish());
}

static void test_changes_behind_its_back(void)
{
    begin();
    expect_optimal();
    const struct jp_plan before = *jp_planner_plan(&planner);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, 8, 2, JP_CELL_OCCUPIED));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_STALE, jp_planner_work(&planner, 0));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_STALE, jp_planner_work(&planner, 1000));
    TEST_ASSERT_EQUAL_MEMORY(&before, jp_planner_plan(&planner), sizeof before);
    jp_planner_restart(&planner);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_work(&planner, 0));
    expect_optimal();
    TEST_ASSERT_TRUE(jp_planner_plan(&planner)->cost > STEPS * AXIS_COST);
}

/* Little memory */

/* What the plan says of itself is so. */
static void expect_honest(enum jp_answer answer, const struct jp_goal *goal)
{
    const struct jp_plan *plan = jp_planner_plan(&planner);
    const bool has_arrived =
        plan->end.x == goal->x && plan->end.y == goal->y && (goal->headings >> plan->end.heading & 1) != 0;

    TEST_ASSERT_EQUAL_INT(plan->answer, answer);
    TEST_ASSERT_TRUE((answer == JP_ANSWER_PARTIAL) == !has_arrived);
    TEST_ASSERT_TRUE((plan->cost_left > 0) == !has_arrived);
    TEST_ASSERT_TRUE((plan->bound >= JP_EPSILON_ONE) == has_arrived);
    TEST_ASSERT_TRUE((answer == JP_ANSWER_OPTIMAL) == (plan->bound == JP_EPSILON_ONE));
    expect_drivable();
}

static void test_smallest_block_gives_an_honest_answer(void)
{
    unsigned seen[JP_ANSWER_STALE + 1] = {0};

    make_large_map();
    for (int16_t x = 4; x <= 12; x++) {
        for (unsigned heading = 0; heading < JP_HEADINGS; heading += 3) {
            const struct jp_goal goal = {x, 12, (uint16_t)(1U << heading)};
            start_planner(jp_planner_size(&map));
            go(&(const struct jp_lattice_pose){3, 3, 4}, &goal);
            const enum jp_answer answer = finish();
            expect_honest(answer, &goal);
            seen[answer]++;
        }
    }
    TEST_ASSERT_TRUE(seen[JP_ANSWER_PARTIAL] > 0);
    TEST_ASSERT_TRUE(seen[JP_ANSWER_WITHIN_BOUND] > 0);
}

/* A partial plan that ends beside the goal, where the guide is too coarse to tell, does not say that it is there. */
static void test_partial_beside_the_goal(void)
{
    unsigned partial = 0;

    make_large_map();
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const struct jp_goal goal = {5, 9, (uint16_t)(1U << heading)};
        start_planner(jp_planner_size(&map));
        go(&(const struct jp_lattice_pose){4, 4, 12}, &goal);
        const enum jp_answer answer = finish();
        expect_honest(answer, &goal);
        partial += answer == JP_ANSWER_PARTIAL;
    }
    TEST_ASSERT_TRUE(partial > 0);
}

static void test_partial_plan_is_found_anew_after_a_change(void)
{
    const struct jp_goal goal = {11, 11, 1U << 10};

    make_large_map();
    start_planner(jp_planner_size(&map));
    go(&(const struct jp_lattice_pose){4, 4, 12}, &goal);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_PARTIAL, finish());
    const uint32_t restarts = jp_planner_statistics(&planner)->restarts;
    occupy(13, 3);
    TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
    TEST_ASSERT_EQUAL_UINT32(restarts + 1, jp_planner_statistics(&planner)->restarts);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_PARTIAL, finish());
    expect_drivable();
    expect_start(JP_OK, 5, 5, 4);
    TEST_ASSERT_EQUAL_UINT32(restarts + 2, jp_planner_statistics(&planner)->restarts);
}

/* The route's memory is made smaller by hand: on so small a map no route fills it. */
static void test_route_is_cut_where_its_memory_ends(void)
{
    begin();
    planner.internal.route_max = 4;
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_PARTIAL, finish());
    const struct jp_plan *plan = jp_planner_plan(&planner);
    TEST_ASSERT_EQUAL_UINT32(4, plan->step_count);
    TEST_ASSERT_EQUAL_UINT32(4 * AXIS_COST, plan->cost);
    TEST_ASSERT_EQUAL_UINT32((STEPS - 4) * AXIS_COST, plan->cost_left);
    TEST_ASSERT_EQUAL_UINT32(0, plan->bound);
    TEST_ASSERT_EQUAL_INT(west.x + 4, plan->end.x);
    expect_drivable();
}

/* Also where it is the optimum. */
static void test_optimum_is_cut_where_its_memory_ends(void)
{
    config.epsilon[0] = JP_EPSILON_ONE;
    config.epsilon[1] = 0;
    test_route_is_cut_where_its_memory_ends();
}

/* As the robot drives, the end of the route comes into its memory. */
static void test_route_that_was_cut_goes_on(void)
{
    const struct jp_lattice_pose nearer = {west.x + STEPS - 3, west.y, west.heading};

    begin();
    planner.internal.route_max = 4;
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_PARTIAL, finish());
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &nearer));
    expect_optimal();
    TEST_ASSERT_EQUAL_UINT32(3 * AXIS_COST, jp_planner_plan(&planner)->cost);
}

/* Not even the first expansion fits: the answer stays open, and nothing more is tried. */
static void test_block_too_small_for_any_expansion(void)
{
    begin();
    planner.internal.neighbours_max = UINT16_MAX;
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, finish());
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_plan(&planner)->answer);
    TEST_ASSERT_EQUAL_UINT32(0, jp_planner_statistics(&planner)->expansions);
}

/* In the smallest block, up to where the search goes on from the robot instead of the goal. */
static void search_from_the_robot(const struct jp_goal *goal)
{
    make_large_map();
    start_planner(jp_planner_size(&map));
    go(&(const struct jp_lattice_pose){4, 4, 12}, goal);
    while (planner.internal.search.direction == JP_PLANNER_FROM_GOAL) {
        TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
        (void)jp_planner_work(&planner, 1);
    }
}

static void test_start_moves_before_the_search_from_the_robot(void)
{
    const struct jp_goal goal = {11, 11, 1U << 10};

    search_from_the_robot(&goal);
    const uint32_t restarts = jp_planner_statistics(&planner)->restarts;
    expect_start(JP_OK, 5, 5, 4);
    TEST_ASSERT_EQUAL_UINT32(restarts + 1, jp_planner_statistics(&planner)->restarts);
    TEST_ASSERT_EQUAL_INT(JP_PLANNER_FROM_GOAL, planner.internal.search.direction);
    expect_honest(finish(), &goal);
    TEST_ASSERT_EQUAL_INT(5, jp_planner_plan(&planner)->start.x);
}

/* Of the goal's headings the cheapest counts, whichever is met first. */
static void test_search_from_the_robot_to_any_heading(void)
{
    make_large_map();
    for (int16_t x = 4; x <= 12; x++) {
        for (int16_t y = 6; y <= 12; y++) {
            const struct jp_goal goal = {x, y, JP_ANY_HEADING};
            start_planner(jp_planner_size(&map));
            go(&(const struct jp_lattice_pose){4, 4, 12}, &goal);
            planner.internal.search.epsilon = JP_EPSILON_MAX; /* nothing is left but to search from the robot */
            planner.internal.neighbours_max = UINT16_MAX;
            while (planner.internal.search.direction == JP_PLANNER_FROM_GOAL) {
                (void)jp_planner_work(&planner, 1);
            }
            planner.internal.neighbours_max = 16;
            expect_honest(finish(), &goal);
        }
    }
}

/* Of a route from the robot the far end is left out, also where the search has arrived. */
static void test_route_from_the_robot_is_cut(void)
{
    unsigned full = 0;
    unsigned routes = 0;

    make_large_map();
    for (int16_t x = 4; x <= 12; x++) {
        for (unsigned heading = 0; heading < JP_HEADINGS; heading += 3) {
            const struct jp_goal goal = {x, 12, (uint16_t)(1U << heading)};
            start_planner(jp_planner_size(&map));
            planner.internal.route_max = 2;
            go(&(const struct jp_lattice_pose){3, 3, 4}, &goal);
            TEST_ASSERT_EQUAL_INT(JP_ANSWER_PARTIAL, finish());
            TEST_ASSERT_TRUE(jp_planner_plan(&planner)->step_count <= 2);
            expect_honest(JP_ANSWER_PARTIAL, &goal);
            full += jp_planner_plan(&planner)->step_count == 2;
            routes++;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(routes, full); /* no way is so short */
}

/* Occupies a cell so that the planner cannot know: as if its memory had been damaged. */
static void occupy_secretly(int32_t x, int32_t y)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, JP_CELL_OCCUPIED));
    planner.internal.terrain_version = terrain.version;
}

/* States from which no route leads on are not believed: the search begins anew, with the map as it is. */
static void test_search_that_leads_nowhere_begins_anew(void)
{
    begin();
    expect_optimal();
    planner.internal.effort.fresh_cost = 0; /* or the search would be given up for a new one */
    expect_start(JP_OK, 5, 5, 0);
    occupy_secretly(5, 5);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_UNREACHABLE, finish());
    TEST_ASSERT_EQUAL_UINT32(2, jp_planner_statistics(&planner)->restarts);
}

static void test_search_from_the_robot_that_leads_nowhere(void)
{
    const struct jp_goal goal = {11, 11, 1U << 10};

    search_from_the_robot(&goal);
    while (planner.internal.phase != JP_PLANNER_TRACE) {
        TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
        (void)jp_planner_work(&planner, 1);
    }
    occupy_secretly(planner.internal.trace.end.x, planner.internal.trace.end.y);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, finish());
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_plan(&planner)->answer);
}

/* Downhill all the way the least that a route could cost is nothing, so nothing is proved of one that costs more. */
static void test_nothing_is_proved_downhill(void)
{
    for (int32_t x = 0; x < WIDTH; x++) {
        for (int32_t y = 0; y < HEIGHT; y++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)(-20 * x)));
        }
    }
    config.epsilon[1] = 0;
    begin();
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_WITHIN_BOUND, finish());
    TEST_ASSERT_EQUAL_UINT32(JP_BOUND_NONE, jp_planner_plan(&planner)->bound);
    TEST_ASSERT_TRUE(jp_planner_plan(&planner)->cost > 0);
    expect_drivable();
    struct jp_lattice_pose pose = west;
    TEST_ASSERT_NOT_NULL(jp_planner_step(&planner, 0, &pose));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &pose));
    TEST_ASSERT_EQUAL_UINT32(JP_BOUND_NONE, jp_planner_plan(&planner)->bound);
}

/* What a search that was given up in the middle of its work has spent is not charged to the one that begins anew. */
static void test_a_new_search_has_spent_nothing_wherever_it_begins(void)
{
    unsigned restarts = 0;

    begin();
    expect_optimal();
    planner.internal.effort.fresh_cost = 0;
    expect_start(JP_OK, 5, 5, 0);
    occupy_secretly(5, 5);
    while (!jp_planner_is_idle(&planner)) {
        const uint32_t before = jp_planner_statistics(&planner)->restarts;

        (void)jp_planner_work(&planner, 1);
        if (jp_planner_statistics(&planner)->restarts > before) {
            TEST_ASSERT_EQUAL_UINT32(0, planner.internal.effort.spent);
            restarts++;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(1, restarts);
}

/* A field that cannot see the robot does not go on to a repair: it is grown anew from where the robot is. */
static void test_a_field_that_is_cut_off_grows_anew(void)
{
    static const struct jp_lattice_pose here = {3, 4, 4};
    static const struct jp_goal goal = {3, 4, 1U << 4};

    config.epsilon[0] = JP_EPSILON_ONE;
    config.epsilon[1] = 0;
    start_planner(sizeof block);
    wall(true);
    go(&here, &goal);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, finish());
    occupy(15, 0);
    expect_start(JP_OK, 12, 4, 4);
    while (planner.internal.phase == JP_PLANNER_CHECK_PLAN || planner.internal.phase == JP_PLANNER_UPDATE_FIELD) {
        (void)jp_planner_work(&planner, 1);
    }
    TEST_ASSERT_EQUAL_INT(JP_PLANNER_GROW_FIELD, planner.internal.phase);
    TEST_ASSERT_EQUAL_INT(12, planner.internal.field_root.x);
}
