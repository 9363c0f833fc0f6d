/* The planner while its map and its robot change at random: whatever it answers, at any time, is true; the optimum that
 * it proves is that of an independent search. */
#include "tests/unit/search/planner_changes.h"

void setUp(void)
{
    rig_reset();
    forget_looks();
    seed = 1;
}

void tearDown(void)
{
}

static void test_by_the_guide_and_the_bound(void)
{
    start_planner(PLANNER_BYTES);
    plan_on_a_changing_map();
    TEST_ASSERT_TRUE(answers[JP_ANSWER_OPTIMAL] > 5 && answers[JP_ANSWER_WITHIN_BOUND] > 0 && looks_at_states > 5);
}

static void test_by_the_bound_alone(void)
{
    config.epsilon[0] = JP_EPSILON_ONE;
    config.epsilon[1] = 0;
    seed = 2;
    start_planner(PLANNER_BYTES);
    plan_on_a_changing_map();
}

static void test_in_many_steps_to_the_optimum(void)
{
    static const uint16_t schedule[JP_EPSILON_LEVELS] = {JP_EPSILON(3), JP_EPSILON(2), JP_EPSILON(1.3), JP_EPSILON_ONE};

    memcpy(config.epsilon, schedule, sizeof schedule);
    seed = 3;
    start_planner(PLANNER_BYTES);
    plan_on_a_changing_map();
}

static void test_by_the_guide_alone(void)
{
    config.epsilon[1] = 0;
    seed = 4;
    start_planner(PLANNER_BYTES);
    plan_on_a_changing_map();
}

static void test_in_small_blocks(void)
{
    for (size_t size = jp_planner_size(&map); size < PLANNER_BYTES; size += PLANNER_BYTES / 3) {
        seed = 5 + (uint32_t)size;
        rig_reset();
        start_planner(size);
        plan_on_a_changing_map();
    }
}

static void test_the_shortest_way(void)
{
    config.cost = JP_COST_DISTANCE;
    seed = 6;
    start_planner(PLANNER_BYTES);
    plan_on_a_changing_map();
}
