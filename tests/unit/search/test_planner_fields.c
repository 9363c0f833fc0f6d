/* What the planner's fields say of the ways from the robot; and how much of its budget any part of its work takes. */
#include "src/search/planner_fields.h"
#include "src/search/planner_slices.h"
#include "tests/unit/search/planner_optimum.h"

enum { PHASES_MAX = 40 /* that a search goes through: of each a part of a unit is lost */ };

static const struct jp_goal goal_at_3 = {12, 4, 1U << 3};

void setUp(void)
{
    rig_reset();
    forget_looks();
}

void tearDown(void)
{
}

static void plan_to(const struct jp_goal *goal)
{
    start_planner(PLANNER_BYTES);
    go(&west, goal);
    expect_optimal();
}

/* ---- Bounds ---- */

static struct jp_lattice_pose pose_at(int16_t x, int16_t y, uint8_t heading)
{
    return (struct jp_lattice_pose){x, y, heading};
}

/* Of any state: moves over level ground and the least turning, both from the robot. */
static void test_bound_of_a_state(void)
{
    plan_to(&goal_at_3);
    (void)least_cost_to(&west, &goal_at_3);
    for (unsigned i = 0; i < INNER_STATES; i++) {
        const struct jp_lattice_pose pose = inner_pose(i);
        const jp_cost bound = jp_fields_bound(&planner.internal, &pose);
        if (least_costs[i] != NO_WAY) {
            TEST_ASSERT_TRUE(bound <= least_costs[i]);
        }
    }
    const struct jp_lattice_pose ahead = pose_at(6, 4, 0);
    const struct jp_lattice_pose turned = pose_at(4, 4, 5);
    TEST_ASSERT_EQUAL_UINT32(2 * AXIS_COST, jp_fields_bound(&planner.internal, &ahead));
    TEST_ASSERT_EQUAL_UINT32(planner.internal.turns.cost[0][5], jp_fields_bound(&planner.internal, &turned));
}

/* The cheapest of the goal's headings, and no other. */
static void test_bound_at_the_goal(void)
{
    const struct jp_goal two = {12, 4, 1U << 3 | 1U << 14};

    plan_to(&goal_at_3);
    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST + planner.internal.turns.cost[0][3],
                             jp_fields_bound_at_goal(&planner.internal));
    TEST_ASSERT_EQUAL_UINT32(planner.internal.turns.cost[0][3], jp_fields_turns_to_goal(&planner.internal));
    plan_to(&two);
    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST + planner.internal.turns.cost[0][14],
                             jp_fields_bound_at_goal(&planner.internal));
    TEST_ASSERT_EQUAL_UINT32(planner.internal.turns.cost[0][14], jp_fields_turns_to_goal(&planner.internal));
}

/* What a field that has made way has found of the turns counts as long as the robot is where that began. */
static void test_turns_that_are_known_of_the_robot(void)
{
    struct jp_planner_internal *inner = &planner.internal;

    plan_to(&goal_at_3);
    const jp_cost least = inner->turns.cost[0][3];
    const jp_cost bound = jp_fields_bound_at_goal(inner);
    inner->turns_to_goal = least + 7;
    TEST_ASSERT_EQUAL_UINT32(least + 7, jp_fields_turns_to_goal(inner));
    TEST_ASSERT_EQUAL_UINT32(bound + 7, jp_fields_bound_at_goal(inner));
    inner->turns_to_goal = least - 7;
    TEST_ASSERT_EQUAL_UINT32(least, jp_fields_turns_to_goal(inner));
    TEST_ASSERT_EQUAL_UINT32(bound, jp_fields_bound_at_goal(inner));
    inner->turns_to_goal = least + 7;
    jp_fields_start(inner);
    TEST_ASSERT_EQUAL_UINT32(least + 7, inner->turns_to_goal);
    inner->start.x++;
    TEST_ASSERT_EQUAL_UINT32(least, jp_fields_turns_to_goal(inner));
    jp_fields_start(inner);
    TEST_ASSERT_EQUAL_UINT32(0, inner->turns_to_goal);
    TEST_ASSERT_EQUAL_MEMORY(&inner->start, &inner->field_root, sizeof inner->start);
    TEST_ASSERT_TRUE(inner->is_field_rooted);
}

/* A robot beyond a wall from the field's root has no bound. */
static void test_robot_that_is_cut_off(void)
{
    struct jp_planner_internal *inner = &planner.internal;
    unsigned budget = UINT16_MAX;

    plan_to(&goal_at_3);
    TEST_ASSERT_FALSE(jp_fields_are_cut_off(inner));
    wall(true);
    jp_fields_start(inner);
    inner->start = pose_at(12, 4, 0);
    TEST_ASSERT_FALSE(jp_fields_are_cut_off(inner)); /* nobody knows yet */
    TEST_ASSERT_TRUE(jp_slice_grow_fields(inner, &budget));
    inner->start = west;
    TEST_ASSERT_FALSE(jp_fields_are_cut_off(inner));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_fields_bound_at_goal(inner));
    inner->start = pose_at(12, 4, 0);
    TEST_ASSERT_TRUE(jp_fields_are_cut_off(inner));
    inner->is_field_rooted = false;
    TEST_ASSERT_FALSE(jp_fields_are_cut_off(inner));
}

/* ---- Budget ---- */

static unsigned units_until_idle(void)
{
    unsigned units = 0;

    while (!jp_planner_is_idle(&planner)) {
        (void)jp_planner_work(&planner, 1);
        units++;
        TEST_ASSERT_TRUE(units < BUDGET_MAX);
    }
    return units;
}

/* On the rig's map, or after changes of it. */
static void prepare(size_t size, int change)
{
    make_level_map(&map);
    start_planner(size);
    go(&west, &east);
    if (change > 0) {
        (void)finish();
        planner.internal.effort.fresh_cost = 0;
        if (change == 1) {
            occupy(8, 2);
        } else {
            raise(9, 4, -5);
        }
    }
}

/* What is done in units of one is done in one slice of as many: none of it is lost, whatever the work is. */
static void test_one_slice_does_what_many_do(void)
{
    for (size_t size = jp_planner_size(&map); size <= PLANNER_BYTES;
         size += (PLANNER_BYTES - jp_planner_size(&map)) / 3) {
        for (int change = 0; change < 3; change++) {
            prepare(size, change);
            const unsigned units = units_until_idle();
            const jp_cost cost = jp_planner_plan(&planner)->cost;
            prepare(size, change);
            (void)jp_planner_work(&planner, units + PHASES_MAX);
            TEST_ASSERT_TRUE(jp_planner_is_idle(&planner));
            TEST_ASSERT_EQUAL_UINT32(cost, jp_planner_plan(&planner)->cost);
            prepare(size, change);
            (void)jp_planner_work(&planner, units / 2);
            TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
        }
    }
}

/* Another goal, or the map as it may have become, needs another guide. */
static void test_what_begins_with_a_guide(void)
{
    plan_to(&goal_at_3);
    jp_planner_restart(&planner);
    TEST_ASSERT_EQUAL_INT(JP_PLANNER_GROW_GUIDE, planner.internal.phase);
    (void)finish();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(&planner, &east));
    TEST_ASSERT_EQUAL_INT(JP_PLANNER_GROW_GUIDE, planner.internal.phase);
    (void)finish();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_lattice(&planner, lattice));
    TEST_ASSERT_EQUAL_INT(JP_PLANNER_GROW_GUIDE, planner.internal.phase);
    expect_optimal();
}

/* A cell beside one that is blocked already. */
static void test_change_beside_an_obstacle(void)
{
    plan_to(&east);
    occupy(9, 0);
    (void)finish();
    for (int32_t x = 8; x <= 10; x += 2) {
        occupy(x, 0);
        TEST_ASSERT_EQUAL_UINT32(1, planner.internal.changes.count);
        (void)finish();
        release(x, 0);
        TEST_ASSERT_EQUAL_UINT32(1, planner.internal.changes.count);
        expect_optimal();
    }
}
