/* The planner's scout. A block in which the planner makes room for one is larger than the RAM of the smallest core:
 * here it gets its states from the test. */
#include "src/search/planner_head.h"
#include "src/search/planner_splice.h"
#include "tests/unit/search/planner_changes.h"

enum { SCOUT_BYTES = 1904 };

static uint64_t *const scout_block = &block[(PLANNER_BYTES - SCOUT_BYTES) / sizeof *block];

void setUp(void)
{
    rig_reset();
    forget_looks();
    seed = 1;
}

void tearDown(void)
{
}

static void start_with_scout(void)
{
    start_planner(PLANNER_BYTES - SCOUT_BYTES);
    (void)jp_planner_states_init(&planner.internal.resting, &terrain.config, scout_block, SCOUT_BYTES);
    TEST_ASSERT_TRUE(planner.internal.resting.state_count_max > JP_PLANNER_SPLICE_STEPS + JP_HEADINGS);
}

static void begin_with_scout(void)
{
    start_with_scout();
    go(&west, &east);
    expect_optimal();
    TEST_ASSERT_FALSE(planner.internal.is_scouting);
}

/* Units of work until there is a route again; which search finds it. */
struct finder {
    int units;
    bool is_scout;
    bool is_splice;
};

static struct finder work_until_a_route(void)
{
    struct finder finder = {0};

    do {
        TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
        finder.is_scout = planner.internal.is_scouting;
        finder.is_splice = planner.internal.is_splicing;
        finder.units++;
    } while (jp_planner_work(&planner, 1) == JP_ANSWER_OUT_OF_BUDGET);
    return finder;
}

/* The scout finds the next route; by a splice, if a new search is not believed to be cheaper. Its proof follows. */
static void test_scout_goes_ahead(void)
{
    for (int32_t x = 7; x <= 9; x++) {
        for (int i = 0; i < 2; i++) {
            make_level_map(&map);
            begin_with_scout();
            planner.internal.effort.fresh_route = i == 0 ? UINT16_MAX : 1;
            occupy(x, 2);
            const struct finder finder = work_until_a_route();
            TEST_ASSERT_TRUE(finder.is_scout);
            TEST_ASSERT_EQUAL_INT(i == 0, finder.is_splice);
            TEST_ASSERT_FALSE(planner.internal.is_splicing);
            expect_true_answer(JP_ANSWER_WITHIN_BOUND);
            expect_true_answer(finish());
            TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, jp_planner_work(&planner, 0));
        }
    }
}

/* While it searches, the states of the other search rest, both are counted, and it is told by what. */
static void test_both_searches_are_counted(void)
{
    begin_with_scout();
    const uint32_t before = jp_planner_statistics(&planner)->states;
    occupy(8, 2);
    do {
        (void)jp_planner_work(&planner, 1);
    } while (planner.internal.phase != JP_PLANNER_SEARCH);
    TEST_ASSERT_TRUE(planner.internal.is_scouting && planner.internal.is_splicing);
    TEST_ASSERT_EQUAL_UINT32(before, planner.internal.resting.state_count);
    TEST_ASSERT_EQUAL_UINT32(before + planner.internal.search.state_count, jp_planner_statistics(&planner)->states);
    expect_true_answer(finish());
    TEST_ASSERT_FALSE(planner.internal.is_scouting || planner.internal.is_splicing);
}

/* The plan's steps before what is blocked stay, and behind it. */
static void test_splice_leaves_the_rest_of_the_plan(void)
{
    struct jp_lattice_pose pose = west;

    begin_with_scout();
    raise(8, 4, 15); /* the way is bent before it is blocked */
    expect_optimal();
    planner.internal.effort.fresh_cost = 0;
    occupy(9, 2);
    TEST_ASSERT_TRUE(work_until_a_route().is_splice);
    expect_true_answer(jp_planner_work(&planner, 0));
    TEST_ASSERT_NOT_NULL(jp_planner_step(&planner, 0, &pose));
    expect_true_answer(finish());
}

/* ---- What a splice is made of, on a longer way ---- */

static const struct jp_goal far_east = {20, 4, 1};

/* Before its step over x 11 the robot's plan is blocked, and free again behind its step over x 16. */
enum { WAY = 16, BLOCKED_X = 14, HEAD = 11 - 4, TAIL = 17 };

/* Until the scout is about to look for a way round a cell in the middle of the plan. */
static void begin_splice(void)
{
    map.width = 24;
    map.has_elevation = false;
    make_level_map(&map);
    start_with_scout();
    go(&west, &far_east);
    (void)finish();
    TEST_ASSERT_EQUAL_UINT32(WAY, jp_planner_plan(&planner)->step_count);
    planner.internal.effort.fresh_cost = 0;
    occupy(BLOCKED_X, 2);
    while (planner.internal.phase != JP_PLANNER_SEARCH) {
        (void)jp_planner_work(&planner, 1);
    }
    TEST_ASSERT_TRUE(planner.internal.is_splicing);
}

static uint32_t id_on_axis(int x)
{
    return jp_search_id(&planner.internal, x, west.y, west.heading);
}

/* Head and tail are what is left of the plan; the tail's states have the costs that it has from there on. */
static void test_head_and_tail_of_a_splice(void)
{
    begin_splice();
    const struct jp_planner_head *head = &planner.internal.head;
    TEST_ASSERT_EQUAL_UINT32(HEAD, head->steps);
    TEST_ASSERT_EQUAL_UINT32(0, head->first_step);
    TEST_ASSERT_EQUAL_UINT32(HEAD * AXIS_COST, head->cost);
    TEST_ASSERT_EQUAL_UINT32(id_on_axis(west.x), head->start_id);
    for (int i = 0; i <= HEAD; i++) {
        TEST_ASSERT_EQUAL_UINT32(id_on_axis(west.x + i), head->ids[i]);
    }
    for (int16_t x = 2; x < map.width - 2; x++) {
        const bool is_tail = x >= TAIL && x <= far_east.x;
        const uint32_t slot = jp_planner_states_find(&planner.internal.search, id_on_axis(x));
        const struct jp_lattice_pose pose = {x, west.y, 0};
        TEST_ASSERT_EQUAL_INT(is_tail, slot != NO_SLOT);
        TEST_ASSERT_EQUAL_INT(is_tail, jp_splice_is_on_tail(&planner.internal, &pose));
        if (is_tail) {
            TEST_ASSERT_EQUAL_UINT32((uint32_t)(far_east.x - x) * AXIS_COST,
                                     (uint32_t)planner.internal.search.states[slot].rhs);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(far_east.x - TAIL + 1, planner.internal.search.state_count);
}

/* The robot drives on as before up to where the way round begins, and after it as before; with what that costs. */
static void test_splice_keeps_both_ends_of_the_plan(void)
{
    begin_splice();
    const struct finder finder = work_until_a_route();
    const struct jp_plan *plan = jp_planner_plan(&planner);
    const uint32_t kept = planner.internal.head.junction_step;
    struct jp_lattice_pose pose = west;

    TEST_ASSERT_TRUE(finder.is_splice);
    TEST_ASSERT_TRUE(kept > 0 && kept <= HEAD);
    for (unsigned i = 0; i < plan->step_count; i++) {
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *step = jp_planner_step(&planner, i, &pose);
        if (i < kept || (from.y == west.y && from.heading == 0 && from.x >= TAIL)) {
            TEST_ASSERT_EQUAL_INT(1, step->dx);
            TEST_ASSERT_EQUAL_INT(0, step->dy);
        }
    }
    TEST_ASSERT_TRUE(plan->cost > WAY * AXIS_COST);
    TEST_ASSERT_EQUAL_INT(far_east.x, plan->end.x);
    expect_drivable();
}

/* The steps of the plan that the route's memory holds are as many as the splice has, or it is none. */
static void test_splice_fills_the_memory_of_the_route(void)
{
    begin_splice();
    (void)work_until_a_route();
    const uint16_t steps = jp_planner_plan(&planner)->step_count;

    for (uint16_t max = (uint16_t)(steps - 1); max <= steps; max++) {
        begin_splice();
        planner.internal.route_max = max;
        TEST_ASSERT_EQUAL_INT(max == steps, work_until_a_route().is_splice);
        expect_drivable();
    }
}

/* Of a long head the last steps alone are joined. */
static void test_splice_behind_a_long_head(void)
{
    begin_splice();
    planner.internal.check.head_steps = WAY;
    jp_splice_begin(&planner.internal);
    TEST_ASSERT_EQUAL_UINT32(0, planner.internal.head.first_step);
    TEST_ASSERT_EQUAL_UINT32(WAY, planner.internal.head.steps);
    TEST_ASSERT_EQUAL_UINT32(id_on_axis(far_east.x), planner.internal.head.ids[WAY]);
    planner.internal.plan.start.x++; /* the robot has left the plan */
    jp_splice_begin(&planner.internal);
    TEST_ASSERT_EQUAL_UINT32(0, planner.internal.head.steps);
    TEST_ASSERT_EQUAL_UINT32(0, planner.internal.head.cost);
    TEST_ASSERT_EQUAL_UINT32(id_on_axis(west.x), planner.internal.head.ids[0]);
}

/* ---- What comes between ---- */

/* The map changes, or the robot, wherever the scout is. */
static void test_scout_is_called_back(void)
{
    for (int slices = 0; slices < 24; slices++) {
        make_level_map(&map);
        begin_with_scout();
        occupy(8, 2);
        for (int i = 0; i < slices; i++) {
            (void)jp_planner_work(&planner, 1);
        }
        if (slices % 2 == 0) {
            occupy(10, 6);
        } else {
            expect_start(JP_OK, 4, 5, 0);
        }
        TEST_ASSERT_FALSE(planner.internal.is_splicing && !planner.internal.is_scouting);
        expect_true_answer(finish());
    }
}

/* Where the robot is no longer on its plan, its own state alone is joined with the tail. */
static void test_splice_from_beside_the_plan(void)
{
    begin_with_scout();
    planner.internal.effort.fresh_cost = 0;
    expect_start(JP_OK, 5, 5, 0);
    expect_true_answer(finish());
    planner.internal.effort.fresh_cost = 0;
    occupy(9, 2);
    TEST_ASSERT_TRUE(work_until_a_route().is_splice);
    expect_true_answer(jp_planner_work(&planner, 0));
    TEST_ASSERT_EQUAL_INT(5, jp_planner_plan(&planner)->start.x);
    expect_true_answer(finish());
}

/* What is joined may take more steps than the route's memory holds: then the route is found anew, and cut. */
static void test_splice_that_does_not_fit_the_route(void)
{
    for (uint16_t steps = 1; steps < STEPS; steps++) {
        make_level_map(&map);
        begin_with_scout();
        planner.internal.route_max = steps;
        planner.internal.effort.fresh_cost = 0; /* or the splice would be given up for a new search */
        occupy(7, 2);
        expect_true_answer(finish());
        TEST_ASSERT_TRUE(jp_planner_plan(&planner)->step_count <= steps);
    }
}

/* No way leads round: that the scout finds none proves nothing, the exact search does. */
static void test_scout_finds_no_way(void)
{
    begin_with_scout();
    wall(true);
    expect_true_answer(finish());
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_UNREACHABLE, jp_planner_work(&planner, 0));
    wall(false);
    expect_true_answer(finish());
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, jp_planner_work(&planner, 0));
}

/* With more and more of its states gone, down to none that it can expand. */
static void test_scout_with_little_memory(void)
{
    for (uint32_t most = 33; most < 72; most += 3) {
        make_level_map(&map);
        begin_with_scout();
        planner.internal.resting.state_count_max = most;
        occupy(8, 2);
        expect_true_answer(finish());
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, jp_planner_work(&planner, 0));
    }
}

/* A splice that becomes dearer than a new search makes way for the whole way. */
static void test_dear_splice_is_given_up(void)
{
    begin_with_scout();
    occupy(8, 2);
    while (planner.internal.phase != JP_PLANNER_SEARCH) {
        (void)jp_planner_work(&planner, 1);
    }
    TEST_ASSERT_TRUE(planner.internal.is_splicing);
    planner.internal.effort.fresh_end = 1;
    planner.internal.effort.fresh_route = 1;
    planner.internal.effort.spent = 2;
    (void)jp_planner_work(&planner, 1);
    TEST_ASSERT_TRUE(planner.internal.is_scouting && !planner.internal.is_splicing);
    expect_true_answer(finish());
}

static void test_scout_on_a_changing_map(void)
{
    for (int i = 0; i < 4; i++) {
        make_level_map(&map);
        start_with_scout();
        plan_on_a_changing_map();
    }
    TEST_ASSERT_TRUE(answers[JP_ANSWER_OPTIMAL] > 20 && answers[JP_ANSWER_WITHIN_BOUND] > 2 && looks_at_states > 20);
}

/* The first state of the head, or one of its last: then it says which. */
static void test_where_a_head_is_met(void)
{
    static struct jp_planner_head head;

    head = (struct jp_planner_head){.start_id = 7, .first_step = 3, .steps = 6};
    for (uint32_t i = 0; i < 4U; i++) {
        head.ids[i] = 20U + i;
    }
    head.ids[4] = 24; /* not of it any more */
    TEST_ASSERT_TRUE(jp_planner_head_has(&head, 7));
    TEST_ASSERT_EQUAL_UINT32(0, head.junction_step);
    for (uint32_t i = 0; i < 4U; i++) {
        TEST_ASSERT_TRUE(jp_planner_head_has(&head, 20U + i));
        TEST_ASSERT_EQUAL_UINT32(3U + i, head.junction_step);
    }
    TEST_ASSERT_FALSE(jp_planner_head_has(&head, 24));
    TEST_ASSERT_EQUAL_UINT32(0, head.junction_step);
    TEST_ASSERT_FALSE(jp_planner_head_has(&head, 19));
}

/* What the scout has spent is not charged to the search that goes on without it. */
static void test_what_the_scout_has_spent_is_its_own(void)
{
    for (int i = 0; i < 2; i++) {
        begin_with_scout();
        occupy(8, 2);
        do {
            (void)jp_planner_work(&planner, 1);
        } while (planner.internal.phase != JP_PLANNER_SEARCH);
        TEST_ASSERT_TRUE(planner.internal.is_scouting);
        TEST_ASSERT_FALSE(planner.internal.search.is_exact);
        TEST_ASSERT_EQUAL_PTR(scout_block, planner.internal.search.states);
        TEST_ASSERT_EQUAL_PTR(planner.internal.states_block, planner.internal.resting.states);
        planner.internal.effort.spent = 1000;
        if (i == 0) {
            occupy(9, 2);
        } else {
            expect_start(JP_OK, 5, 4, 4);
        }
        TEST_ASSERT_FALSE(planner.internal.is_scouting);
        TEST_ASSERT_EQUAL_UINT32(0, planner.internal.effort.spent);
        expect_true_answer(finish());
        make_level_map(&map);
    }
}

/* To splice it needs no guide but the one that there is; for the whole way one grows. */
static void test_whether_the_scout_needs_a_guide(void)
{
    for (int i = 0; i < 4; i++) {
        make_level_map(&map);
        begin_with_scout();
        planner.internal.has_guide = i % 2 == 1;
        if (i / 2 == 1) {
            planner.internal.plan.end.x--; /* as if there were none, but one that leads elsewhere */
            planner.internal.answer = JP_ANSWER_OUT_OF_BUDGET;
        }
        planner.internal.effort.fresh_cost = 0;
        occupy(8, 2);
        while (!planner.internal.is_scouting) {
            TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
            (void)jp_planner_work(&planner, 1);
        }
        TEST_ASSERT_EQUAL_INT(i / 2 == 0, planner.internal.is_splicing);
        TEST_ASSERT_EQUAL_INT(i != 1, planner.internal.phase == JP_PLANNER_GROW_GUIDE);
        TEST_ASSERT_EQUAL_UINT32(i / 2 == 0 ? 512 : JP_EPSILON(2), planner.internal.search.epsilon);
        expect_true_answer(finish());
    }
}
