/* Parts of the planner by themselves: how it shares its memory out, where a search begins anew, the target of a search
 * and what it proves, and the budget of its slices. */
#include "src/search/planner_bound.h"
#include "src/search/planner_effort.h"
#include "src/search/planner_fields.h"
#include "src/search/planner_layout.h"
#include "src/search/planner_rehearsal.h"
#include "src/search/planner_route.h"
#include "src/search/planner_slices.h"
#include "src/search/planner_stage.h"
#include "src/search/planner_start.h"
#include "src/search/planner_trace.h"
#include "tests/unit/search/planner_optimum.h"

static struct jp_planner_internal *const inner = &planner.internal;

void setUp(void)
{
    rig_reset();
    forget_looks();
}

void tearDown(void)
{
}

static void plan_exactly(void)
{
    config.epsilon[0] = JP_EPSILON_ONE;
    config.epsilon[1] = 0;
    start_planner(PLANNER_BYTES);
    go(&west, &east);
    expect_optimal();
}

/* ---- Memory ---- */

/* The turn field gets the finest scale that takes no more than a quarter of the states' memory; given back, that is as
 * it was. */
static void test_memory_that_is_shared_with_the_turn_field(void)
{
    unsigned finest = JP_TURN_SCALE_MIN;

    plan_exactly();
    TEST_ASSERT_TRUE(jp_bound_can_share(inner));
    const uint32_t slots = inner->search.slot_count;
    const size_t bytes = inner->states_bytes;
    while (jp_turn_field_size(&map, finest) > bytes / 4U) {
        finest++;
    }
    jp_bound_share_with_turns(inner);
    TEST_ASSERT_TRUE(inner->has_turn_field);
    TEST_ASSERT_FALSE(jp_bound_can_share(inner));
    TEST_ASSERT_EQUAL_UINT8(finest, inner->turn_field.scale);
    TEST_ASSERT_EQUAL_PTR(inner->states_block + jp_turn_field_size(&map, finest), inner->search.states);
    TEST_ASSERT_TRUE(inner->search.slot_count < slots);
    TEST_ASSERT_TRUE((uint8_t *)&inner->search.buckets[inner->search.bucket_count] <= inner->states_block + bytes);
    jp_bound_drop_turns(inner);
    TEST_ASSERT_FALSE(inner->has_turn_field);
    TEST_ASSERT_EQUAL_PTR(inner->states_block, inner->search.states);
    TEST_ASSERT_EQUAL_UINT32(slots, inner->search.slot_count);
}

/* The energy field takes the states' memory where there is just enough, and the search what is left if it is enough for
 * a search. */
static void test_memory_that_is_lent_to_the_field(void)
{
    const size_t field_bytes = jp_energy_field_size(&map, JP_WAVE_2_BYTES);
    const size_t least = jp_planner_states_size(JP_LAYOUT_STATES_MIN);

    plan_exactly();
    inner->states_bytes = field_bytes - 1U;
    TEST_ASSERT_FALSE(jp_bound_fits_field(inner));
    inner->states_bytes = field_bytes;
    TEST_ASSERT_TRUE(jp_bound_fits_field(inner));
    for (unsigned i = 0; i < 3U; i++) {
        inner->states_bytes = field_bytes + least + i - 1U;
        jp_bound_lend_to_turns(inner);
        TEST_ASSERT_FALSE(jp_bound_has_states(inner));
        jp_bound_lend_to_field(inner);
        TEST_ASSERT_EQUAL_INT(JP_PLANNER_LENT_TO_FIELD, inner->lent);
        TEST_ASSERT_EQUAL_INT(i > 0U, jp_bound_has_states(inner));
        TEST_ASSERT_EQUAL_INT(JP_PLANNER_FROM_GOAL, inner->search.direction);
        if (i > 0U) {
            TEST_ASSERT_EQUAL_PTR(inner->states_block + field_bytes, inner->search.states);
        }
        jp_bound_return_states(inner);
        TEST_ASSERT_EQUAL_INT(JP_PLANNER_LENT_TO_NONE, inner->lent);
        TEST_ASSERT_EQUAL_PTR(inner->states_block, inner->search.states);
    }
}

/* A proof is wanted of an answer within a bound, where the schedule asks for one, and no field has given it. */
static void test_when_a_bound_is_wanted(void)
{
    plan_exactly();
    inner->statistics.field_bytes = 0;
    inner->answer = JP_ANSWER_WITHIN_BOUND;
    TEST_ASSERT_TRUE(jp_bound_is_wanted(inner));
    inner->states_bytes = jp_turn_field_size(&map, JP_TURN_SCALE_MAX);
    TEST_ASSERT_TRUE(jp_bound_is_wanted(inner));
    inner->states_bytes--;
    TEST_ASSERT_FALSE(jp_bound_is_wanted(inner));
    inner->states_bytes++;
    inner->statistics.field_bytes = 1;
    TEST_ASSERT_FALSE(jp_bound_is_wanted(inner));
    inner->statistics.field_bytes = 0;
    inner->answer = JP_ANSWER_OPTIMAL;
    TEST_ASSERT_FALSE(jp_bound_is_wanted(inner));
    inner->answer = JP_ANSWER_WITHIN_BOUND;
    inner->lent = JP_PLANNER_LENT_TO_TURNS;
    TEST_ASSERT_FALSE(jp_bound_is_wanted(inner));
    inner->lent = JP_PLANNER_LENT_TO_NONE;
    for (unsigned level = 0; level < JP_EPSILON_LEVELS; level++) {
        memset(inner->config.epsilon, 0, sizeof inner->config.epsilon);
        inner->config.epsilon[level] = JP_EPSILON_ONE;
        TEST_ASSERT_TRUE(jp_bound_is_wanted(inner));
        inner->config.epsilon[level]++;
        TEST_ASSERT_FALSE(jp_bound_is_wanted(inner));
    }
}

/* Rehearsals take the largest power of two that is less than the block, then half of it, down to the smallest block; at
 * the end all of it is as it was. */
static void test_blocks_of_rehearsals(void)
{
    size_t size = 1;

    plan_exactly();
    const size_t bytes = inner->states_bytes;
    const uint32_t slots = inner->search.slot_count;
    while (2U * size < (size_t)PLANNER_BYTES) {
        size *= 2U;
    }
    TEST_ASSERT_FALSE(jp_rehearsal_is_on(inner));
    for (; size >= jp_planner_size(&map); size /= 2U) {
        inner->search.level = 1;
        inner->has_guide = true;
        inner->has_turn_field = true;
        TEST_ASSERT_TRUE(jp_rehearsal_next(inner));
        TEST_ASSERT_TRUE(jp_rehearsal_is_on(inner));
        TEST_ASSERT_EQUAL_INT(JP_PLANNER_LENT_TO_REHEARSALS, inner->lent);
        TEST_ASSERT_EQUAL_UINT32((uint32_t)size, (uint32_t)inner->rehearsal.size);
        TEST_ASSERT_TRUE(jp_rehearsal_awaits_route(inner));
        TEST_ASSERT_FALSE(inner->has_guide || inner->has_turn_field);
        TEST_ASSERT_TRUE(inner->states_block + inner->states_bytes <= inner->block + size);
        TEST_ASSERT_TRUE(inner->statistics.field_bytes <= size / 3U);
        TEST_ASSERT_EQUAL_UINT8(0, inner->search.level);
        TEST_ASSERT_EQUAL_UINT32(JP_EPSILON_ONE, inner->search.epsilon);
        inner->rehearsal.has_route = true;
        TEST_ASSERT_FALSE(jp_rehearsal_awaits_route(inner));
    }
    inner->has_turn_field = true;
    inner->is_field_rooted = true;
    inner->search.direction = JP_PLANNER_FROM_ROBOT;
    TEST_ASSERT_FALSE(jp_rehearsal_next(inner));
    TEST_ASSERT_FALSE(jp_rehearsal_is_on(inner) || inner->has_turn_field || inner->is_field_rooted);
    TEST_ASSERT_EQUAL_INT(JP_PLANNER_FROM_GOAL, inner->search.direction);
    TEST_ASSERT_EQUAL_UINT32((uint32_t)bytes, (uint32_t)inner->states_bytes);
    TEST_ASSERT_EQUAL_UINT32(slots, inner->search.slot_count);
    TEST_ASSERT_FALSE(jp_rehearsal_is_on(inner));
    inner->is_field_rooted = true; /* without rehearsals nothing ends */
    jp_rehearsal_end(inner);
    TEST_ASSERT_TRUE(inner->is_field_rooted);
}

/* ---- Fields ---- */

/* After cells have become free the bounds are those of fields that are grown anew. */
static void test_fields_take_in_what_becomes_cheaper(void)
{
    unsigned cells = UINT16_MAX;
    unsigned fallen = 0;

    plan_exactly();
    for (int32_t y = 0; y < 6; y++) {
        (void)jp_terrain_set_cell(&terrain, 8, y, JP_CELL_OCCUPIED);
    }
    jp_fields_start(inner);
    TEST_ASSERT_TRUE(jp_energy_field_grow(&inner->field, &cells));
    (void)jp_fields_take_lowered(inner);
    const jp_cost before = jp_fields_bound_at_goal(inner);
    for (int32_t y = 0; y < 6; y++) {
        (void)jp_terrain_set_cell(&terrain, 8, y, JP_CELL_FREE);
        jp_fields_cell_changed(inner, 8, y);
    }
    cells = UINT16_MAX;
    TEST_ASSERT_TRUE(jp_energy_field_grow(&inner->field, &cells));
    const struct jp_cell_box box = jp_fields_take_lowered(inner);
    TEST_ASSERT_TRUE(box.first_x <= box.last_x && box.first_y <= box.last_y);
    (void)least_cost_to(&west, &east);
    for (unsigned i = 0; i < INNER_STATES; i++) {
        const struct jp_lattice_pose pose = inner_pose(i);

        TEST_ASSERT_TRUE(least_costs[i] == NO_WAY || jp_fields_bound(inner, &pose) <= least_costs[i]);
    }
    fallen += jp_fields_bound_at_goal(inner) < before;
    TEST_ASSERT_EQUAL_UINT32(1, fallen);
    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, jp_fields_bound_at_goal(inner));
}

/* The turn field beside takes them in as well, and tells where it has fallen. */
static void test_both_fields_take_in_what_becomes_cheaper(void)
{
    unsigned looks = UINT32_MAX;
    unsigned cells = UINT16_MAX;

    plan_exactly();
    jp_bound_share_with_turns(inner);
    wall(true);
    jp_fields_start(inner);
    TEST_ASSERT_TRUE(jp_energy_field_grow(&inner->field, &cells));
    TEST_ASSERT_TRUE(jp_turn_field_grow(&inner->turn_field, &looks));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_turn_field_bound(&inner->turn_field, east.x, east.y, 0));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_fields_bound_at_goal(inner));
    (void)jp_fields_take_lowered(inner);
    for (int32_t y = 0; y < map.height; y++) {
        (void)jp_terrain_set_cell(&terrain, 7, y, JP_CELL_FREE);
        jp_fields_cell_changed(inner, 7, y);
    }
    cells = UINT16_MAX;
    looks = UINT32_MAX;
    TEST_ASSERT_TRUE(jp_energy_field_grow(&inner->field, &cells));
    TEST_ASSERT_TRUE(jp_turn_field_grow(&inner->turn_field, &looks));
    TEST_ASSERT_EQUAL_UINT32(0, jp_turn_field_bound(&inner->turn_field, east.x, east.y, 0));
    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, jp_fields_bound_at_goal(inner));
    const struct jp_cell_box box = jp_fields_take_lowered(inner);
    TEST_ASSERT_TRUE(box.first_x <= 12 && box.last_x >= 12 && box.first_y <= 4 && box.last_y >= 4);
}

/* ---- Beginnings ---- */

/* Nothing of an effort before counts for a new search; what one takes is not known until it has a route. */
static void test_a_new_search_has_spent_nothing(void)
{
    plan_exactly();
    TEST_ASSERT_TRUE(jp_effort_anew(inner) > 0U);
    inner->effort.spent = 77;
    inner->effort.has_cut = true;
    inner->effort.has_begun = false;
    inner->changes.count = 3;
    inner->changes.may_be_cheaper = true;
    inner->search.is_repaired = true;
    inner->search.direction = JP_PLANNER_FROM_ROBOT;
    inner->answer = JP_ANSWER_OUT_OF_BUDGET;
    jp_start_over(inner);
    TEST_ASSERT_EQUAL_UINT32(0, inner->effort.spent);
    TEST_ASSERT_EQUAL_UINT32(0, inner->effort.fresh_route);
    TEST_ASSERT_EQUAL_UINT32(0, inner->effort.fresh_end);
    TEST_ASSERT_FALSE(inner->effort.has_cut);
    TEST_ASSERT_TRUE(inner->effort.has_begun);
    TEST_ASSERT_EQUAL_UINT32(0, inner->changes.count);
    TEST_ASSERT_FALSE(inner->changes.may_be_cheaper || inner->search.is_repaired || inner->search.is_exact);
    TEST_ASSERT_EQUAL_INT(JP_PLANNER_FROM_GOAL, inner->search.direction);
    TEST_ASSERT_EQUAL_UINT32(0, jp_effort_anew(inner));
    TEST_ASSERT_EQUAL_INT(JP_PLANNER_GROW_FIELD, inner->phase);
    expect_optimal();
}

/* A guide that has grown before serves a robot that is not farther from its root than an eighth of the way to the goal,
 * by what it says itself. */
static void test_where_an_old_guide_serves(void)
{
    static const uint16_t headings[] = {1U, 1U << 8, 1U << 5 | 1U << 12, 1U << 15};
    struct jp_guide_field grown;
    unsigned served = 0;
    unsigned others = 0;

    config.epsilon[1] = 0;
    for (size_t i = 0; i < sizeof headings / sizeof *headings; i++) {
        const struct jp_goal goal = {east.x, east.y, headings[i]};
        unsigned first = 0;

        start_planner(PLANNER_BYTES);
        go(&west, &goal);
        (void)finish();
        TEST_ASSERT_TRUE(inner->has_guide);
        grown = inner->guide;
        while (((headings[i] >> first) & 1U) == 0U) {
            first++;
        }
        const jp_cost way = jp_guide_field_estimate(&inner->guide, goal.x, goal.y, first);
        for (unsigned k = 0; k < INNER_STATES; k++) {
            const struct jp_lattice_pose pose = inner_pose(k);
            const bool serves = 8U * jp_guide_field_estimate(&inner->guide, pose.x, pose.y, pose.heading) <= way;

            inner->start = pose;
            jp_start_anew(inner, JP_PLANNER_FROM_GOAL);
            TEST_ASSERT_EQUAL_INT(serves, inner->is_guide_old);
            TEST_ASSERT_EQUAL_INT(serves ? JP_PLANNER_CLEAR : JP_PLANNER_GROW_GUIDE, inner->phase);
            served += serves;
            others += !serves;
            inner->guide = grown;
            inner->has_guide = true;
        }
    }
    TEST_ASSERT_TRUE(served > 4U && others > 4U);
}

/* There is a guide for this search when it has grown, and not before; of a search from the robot none is kept. */
static void test_a_guide_is_there_when_it_has_grown(void)
{
    for (unsigned forward = 0; forward < 2U; forward++) {
        bool is_done = false;

        start_planner(PLANNER_BYTES);
        go(&west, &east);
        inner->search.direction = forward == 1U ? JP_PLANNER_FROM_ROBOT : JP_PLANNER_FROM_GOAL;
        inner->has_guide = true;
        inner->is_guide_old = true;
        jp_slice_begin_guide(inner);
        TEST_ASSERT_FALSE(inner->has_guide || inner->is_guide_old);
        TEST_ASSERT_EQUAL_INT(forward == 1U ? JP_GUIDE_TO_ROOT : JP_GUIDE_FROM_ROOT, inner->guide.direction);
        TEST_ASSERT_EQUAL_UINT16(forward == 1U ? east.x : west.x, inner->guide.root.x);
        TEST_ASSERT_EQUAL_UINT16(forward == 1U ? east.headings : 1U << west.heading, inner->guide.root.headings);
        while (!is_done) {
            unsigned budget = 1;

            TEST_ASSERT_FALSE(inner->has_guide);
            is_done = jp_slice_grow_guide(inner, &budget);
            TEST_ASSERT_TRUE(budget <= 1U);
        }
        TEST_ASSERT_EQUAL_INT(forward == 0U, inner->has_guide);
    }
}

/* The states' memory is lent to the guide where it is enough, and nobody else has it. */
static void test_what_the_guide_borrows(void)
{
    start_planner(PLANNER_BYTES);
    go(&west, &east);
    const size_t loan = jp_guide_field_loan(&map);
    TEST_ASSERT_TRUE(loan < inner->states_bytes);
    for (unsigned i = 0; i < 4U; i++) {
        inner->states_bytes = loan - (i == 1U ? 1U : 0U);
        inner->is_scouting = i == 2U;
        inner->has_turn_field = i == 3U;
        jp_slice_begin_guide(inner);
        TEST_ASSERT_EQUAL_PTR(i == 0U ? (void *)inner->states_block : NULL, inner->guide.open);
    }
}

/* ---- The target ---- */

static uint32_t add_state(int16_t x, int16_t y, unsigned heading, jp_cost g)
{
    const uint32_t slot = jp_planner_states_add(&inner->search, jp_search_id(inner, x, y, heading));

    TEST_ASSERT_TRUE(slot != NO_SLOT);
    inner->search.states[slot].g = g & JP_COST_MAX;
    return slot;
}

static void clear_states(void)
{
    unsigned slots = UINT16_MAX;

    inner->search.clear_slot = 0;
    TEST_ASSERT_TRUE(jp_planner_states_clear(&inner->search, &slots));
}

/* From the goal it is the robot; from the robot the cheapest of the goal's headings, and no other. */
static void test_target_of_a_search(void)
{
    start_planner(PLANNER_BYTES);
    go(&west, &(const struct jp_goal){12, 4, 1U << 2 | 1U << 5 | 1U << 9});
    clear_states();
    inner->search.direction = JP_PLANNER_FROM_GOAL;
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_search_target(inner));
    const uint32_t robot = add_state(west.x, west.y, west.heading, 900);
    TEST_ASSERT_EQUAL_UINT32(robot, jp_search_target(inner));
    inner->search.direction = JP_PLANNER_FROM_ROBOT;
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_search_target(inner));
    (void)add_state(12, 4, 3, 10); /* not one of them */
    (void)add_state(12, 5, 2, 10);
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_search_target(inner));
    const uint32_t last = add_state(12, 4, 9, 500);
    TEST_ASSERT_EQUAL_UINT32(last, jp_search_target(inner));
    const uint32_t first = add_state(12, 4, 2, 600);
    TEST_ASSERT_EQUAL_UINT32(last, jp_search_target(inner));
    inner->search.states[first].g = 400;
    TEST_ASSERT_EQUAL_UINT32(first, jp_search_target(inner));
    const uint32_t middle = add_state(12, 4, 5, 300);
    TEST_ASSERT_EQUAL_UINT32(middle, jp_search_target(inner));
}

/* By the field's bound at the goal; by the least key of an exact search, but for a bucket, where that is more. */
static void test_least_cost_that_a_search_proves(void)
{
    plan_exactly();
    const uint32_t width = UINT32_C(1) << inner->search.bucket_shift;
    const jp_cost bound = jp_fields_bound_at_goal(inner);

    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, bound);
    for (uint32_t bucket = 0; bucket < inner->search.bucket_count; bucket++) {
        const uint32_t key = bucket * width;

        inner->search.lowest_bucket = bucket;
        inner->search.is_exact = true;
        TEST_ASSERT_EQUAL_UINT32(key > bound + width ? key - width : bound, jp_search_least_cost(inner));
        inner->search.is_exact = false;
        TEST_ASSERT_EQUAL_UINT32(bound, jp_search_least_cost(inner));
    }
    /* The robot has driven on: less the way from the root to it. */
    inner->start.x = (int16_t)(inner->start.x + 3);
    TEST_ASSERT_EQUAL_UINT32(bound - 3U * AXIS_COST, jp_search_least_cost(inner));
    inner->changes.may_be_cheaper = true;
    TEST_ASSERT_EQUAL_UINT32(0, jp_search_least_cost(inner));
    inner->changes.may_be_cheaper = false;
    inner->is_field_rooted = false;
    TEST_ASSERT_EQUAL_UINT32(0, jp_search_least_cost(inner));
}

/* ---- States after the bounds have fallen ---- */

/* Where the ground becomes cheaper while an exact search is under way, all keys are those of the new bounds. */
static void test_keys_follow_bounds_that_fall(void)
{
    unsigned looks = 0;

    config.epsilon[0] = JP_EPSILON_ONE;
    config.epsilon[1] = 0;
    for (int units = 1; units < 60; units++) {
        make_level_map(&map);
        for (int32_t y = 0; y < HEIGHT; y++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, 8, y, 12)); /* a ridge */
        }
        start_planner(PLANNER_BYTES);
        go(&west, &east);
        (void)jp_planner_work(&planner, (unsigned)units);
        if (inner->phase != JP_PLANNER_SEARCH) {
            continue;
        }
        for (int32_t y = 3; y < 6; y++) {
            raise(8, y, 0);
        }
        while (!is_search_at_rest()) {
            TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
            (void)jp_planner_work(&planner, 1);
        }
        if (inner->search.is_exact && inner->phase == JP_PLANNER_SEARCH) {
            expect_sound_states();
            looks++;
        }
        expect_true_answer(finish());
    }
    TEST_ASSERT_GREATER_THAN_UINT32(3, looks);
}

/* ---- The trace ---- */

/* A route that is no better than the plan leaves it; one that is takes its place. */
static void test_a_route_that_is_no_better_is_not_published(void)
{
    config.epsilon[1] = 0;
    for (int32_t y = 0; y < HEIGHT; y++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, 8, y, 10));
    }
    start_planner(PLANNER_BYTES);
    go(&west, &east);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_WITHIN_BOUND, finish());
    const jp_cost cost = inner->plan.cost;
    for (jp_cost more = 0; more < 3U; more++) {
        const uint8_t *route = inner->route;
        unsigned steps = 1000;

        inner->plan.cost = cost + more - 1U;
        TEST_ASSERT_TRUE(jp_trace_begin(inner, false));
        TEST_ASSERT_EQUAL_INT(TRACE_PUBLISHED, jp_trace_work(inner, &steps));
        TEST_ASSERT_EQUAL_INT(more == 2U, route != inner->route);
        TEST_ASSERT_EQUAL_UINT32(more == 2U ? cost : cost + more - 1U, inner->plan.cost);
    }
}

/* ---- Phases ---- */

static void test_what_the_phases_are(void)
{
    for (int phase = JP_PLANNER_EMPTY; phase <= JP_PLANNER_SETTLED; phase++) {
        jp_stage_enter(inner, (enum jp_planner_phase)phase);
        inner->lent = JP_PLANNER_LENT_TO_NONE;
        TEST_ASSERT_EQUAL_INT(phase, inner->phase);
        TEST_ASSERT_EQUAL_INT(phase == JP_PLANNER_SEARCH || phase == JP_PLANNER_TRACE, jp_stage_is_searching(inner));
        TEST_ASSERT_EQUAL_INT(phase > JP_PLANNER_CLEAR, jp_stage_has_search(inner));
        inner->lent = JP_PLANNER_LENT_TO_FIELD;
        TEST_ASSERT_TRUE(jp_stage_has_search(inner));
    }
    for (int i = 0; i < 4; i++) {
        inner->has_start = i % 2 == 1;
        inner->has_goal = i / 2 == 1;
        TEST_ASSERT_EQUAL_INT(i == 3, jp_stage_is_ready(inner));
    }
}

/* ---- Budgets ---- */

/* What is not used of a budget is left, less the part of a unit that is. */
static void expect_left(unsigned work, unsigned per_unit, unsigned budget)
{
    TEST_ASSERT_EQUAL_UINT32((1000U * per_unit - work) / per_unit, budget);
}

static void test_what_is_left_of_budgets(void)
{
    unsigned budget = 1000;

    plan_exactly();
    inner->search.clear_slot = 0;
    TEST_ASSERT_TRUE(jp_slice_clear(inner, &budget));
    expect_left(inner->search.slot_count, 256, budget);
    budget = 1000;
    inner->search.rekey_slot = 0;
    TEST_ASSERT_TRUE(jp_slice_rekey(inner, &budget));
    expect_left(inner->search.slot_count, 32, budget);
    budget = 1000;
    jp_plan_begin_check(inner);
    TEST_ASSERT_TRUE(jp_slice_check_plan(inner, &budget));
    expect_left(STEPS, 8, budget);
    jp_plan_begin_check(inner);
    for (unsigned i = 0; i <= (unsigned)STEPS; i++) {
        unsigned steps = 1; /* are enough for one */

        TEST_ASSERT_EQUAL_INT(i == (unsigned)STEPS, jp_plan_check(inner, &steps));
        TEST_ASSERT_EQUAL_UINT32(i == (unsigned)STEPS ? 1 : 0, steps);
    }
    budget = 1000;
    jp_fields_start(inner);
    TEST_ASSERT_TRUE(jp_slice_grow_fields(inner, &budget));
    TEST_ASSERT_TRUE(budget < 1000U - 10U && budget > 1000U - 300U);
    jp_bound_share_with_turns(inner);
    jp_fields_start(inner);
    const unsigned without = budget;
    budget = 1000;
    TEST_ASSERT_TRUE(jp_slice_grow_fields(inner, &budget));
    TEST_ASSERT_TRUE(budget < without);
    budget = 0;
    jp_fields_start(inner);
    TEST_ASSERT_FALSE(jp_slice_grow_fields(inner, &budget));
    TEST_ASSERT_EQUAL_UINT32(0, budget);
}

/* What a search has taken is noted when it has its first route, and when it is over, with the cost of its route then.
 */
static void test_effort_is_noted_with_its_cost(void)
{
    plan_exactly();
    inner->effort = (struct jp_planner_effort){.spent = 30, .fresh_cost = 1};
    inner->plan.cost = 777;
    inner->search.is_repaired = false;
    inner->phase = JP_PLANNER_SEARCH;
    jp_effort_note(inner, 5, true);
    TEST_ASSERT_EQUAL_UINT32(35, inner->effort.spent);
    TEST_ASSERT_EQUAL_UINT32(1, inner->effort.fresh_cost);
    jp_effort_note(inner, 5, false);
    TEST_ASSERT_EQUAL_UINT32(40, inner->effort.fresh_route);
    TEST_ASSERT_EQUAL_UINT32(777, inner->effort.fresh_cost);
    TEST_ASSERT_EQUAL_UINT32(0, inner->effort.fresh_end);
    inner->plan.cost = 555;
    inner->phase = JP_PLANNER_SETTLED;
    jp_effort_note(inner, 2, true);
    TEST_ASSERT_EQUAL_UINT32(40, inner->effort.fresh_route);
    TEST_ASSERT_EQUAL_UINT32(42, inner->effort.fresh_end);
    TEST_ASSERT_EQUAL_UINT32(555, inner->effort.fresh_cost);
    inner->plan.cost = 333;
    for (int i = 0; i < 3; i++) { /* not of the scout, nor of a repair, nor without a route */
        inner->is_scouting = i == 0;
        inner->search.is_repaired = i == 1;
        inner->answer = i == 2 ? JP_ANSWER_OUT_OF_BUDGET : JP_ANSWER_OPTIMAL;
        jp_effort_note(inner, 1, false);
        TEST_ASSERT_EQUAL_UINT32(555, inner->effort.fresh_cost);
    }
    inner->effort.has_begun = true;
    jp_effort_note(inner, 9, true);
    TEST_ASSERT_EQUAL_UINT32(0, inner->effort.spent);
}

/* ---- Changes ---- */

/* What is known of all routes is forgotten where the map may have become cheaper, and what was spent before. */
static void test_what_a_change_makes_unknown(void)
{
    for (int i = 0; i < 2; i++) {
        make_level_map(&map);
        plan_exactly();
        TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, inner->least);
        inner->turns_to_goal = 5;
        inner->effort.spent = 50;
        inner->effort.has_cut = true;
        inner->has_guide = true;
        if (i == 0) {
            occupy(15, 0);
        } else {
            raise(8, 4, -1);
        }
        TEST_ASSERT_EQUAL_UINT32(i == 0 ? STEPS * AXIS_COST : 0, inner->least);
        TEST_ASSERT_EQUAL_UINT32(i == 0 ? 5 : 0, inner->turns_to_goal);
        TEST_ASSERT_EQUAL_INT(i == 0, inner->has_guide);
        TEST_ASSERT_EQUAL_INT(i == 1, inner->changes.may_be_cheaper);
        TEST_ASSERT_EQUAL_UINT32(1, inner->changes.count);
        TEST_ASSERT_EQUAL_UINT32(0, inner->changes.cursor);
        TEST_ASSERT_EQUAL_UINT32(0, inner->effort.spent);
        TEST_ASSERT_FALSE(inner->effort.has_cut);
        TEST_ASSERT_TRUE(inner->search.is_repaired);
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, inner->answer);
        expect_true_answer(finish());
        TEST_ASSERT_FALSE(inner->changes.may_be_cheaper);
        TEST_ASSERT_EQUAL_UINT32(0, inner->changes.count);
    }
    jp_start_over(inner);
    TEST_ASSERT_EQUAL_UINT32(0, inner->least);
}

/* A new goal gives the turn field's memory back. */
static void test_a_new_goal_drops_the_turn_field(void)
{
    plan_exactly();
    const uint32_t slots = inner->search.slot_count;
    jp_bound_share_with_turns(inner);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(&planner, &(const struct jp_goal){11, 4, 1}));
    TEST_ASSERT_FALSE(inner->has_turn_field);
    TEST_ASSERT_EQUAL_UINT32(slots, inner->search.slot_count);
    expect_optimal();
}

/* On level ground a straight line costs what is least: that is proved as soon as it is found, without a field. */
static void test_a_straight_way_is_proved_at_once(void)
{
    config.epsilon[1] = 0;
    start_planner(PLANNER_BYTES);
    go(&west, &east);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, finish());
    TEST_ASSERT_FALSE(inner->is_field_rooted);
    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, inner->least);
    TEST_ASSERT_EQUAL_UINT32(JP_EPSILON_ONE, inner->plan.bound);
}

/* ---- States ---- */

/* A state that there is not yet is added by a repair where it may have become cheaper, unless nothing leads on from it
 * or the table is full. */
static void test_repair_of_states_that_are_not_there(void)
{
    unsigned added = 0;

    (void)jp_terrain_set_cell(&terrain, 10, 1, JP_CELL_OCCUPIED);
    plan_exactly();
    (void)jp_terrain_set_cell(&terrain, 10, 1, JP_CELL_FREE);
    for (unsigned i = 0; i < INNER_STATES; i++) {
        const struct jp_lattice_pose pose = inner_pose(i);
        const uint32_t id = jp_search_id(inner, pose.x, pose.y, pose.heading);
        const jp_cost cost = cost_over_neighbours(&pose);
        const uint32_t count = inner->search.state_count;

        if (jp_planner_states_find(&inner->search, id) != NO_SLOT) {
            continue;
        }
        TEST_ASSERT_TRUE(jp_search_repair(inner, id, false));
        TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_states_find(&inner->search, id));
        if (added == 1U && cost != JP_COST_MAX) {
            const uint32_t most = inner->search.state_count_max;

            inner->search.state_count_max = count;
            TEST_ASSERT_FALSE(jp_search_repair(inner, id, true));
            inner->search.state_count_max = most;
        }
        TEST_ASSERT_TRUE(jp_search_repair(inner, id, true));
        const uint32_t slot = jp_planner_states_find(&inner->search, id);

        TEST_ASSERT_EQUAL_INT(cost == JP_COST_MAX, slot == NO_SLOT);
        TEST_ASSERT_EQUAL_UINT32(count + (cost == JP_COST_MAX ? 0U : 1U), inner->search.state_count);
        if (slot != NO_SLOT) {
            TEST_ASSERT_EQUAL_UINT32(cost, (uint32_t)inner->search.states[slot].rhs);
            TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, (uint32_t)inner->search.states[slot].g);
            added++;
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT32(2, added);
}

/* Of the cells of a box, its borders among them, all keys are computed anew; others stay as they are. */
static void test_keys_of_a_box_are_computed_anew(void)
{
    unsigned queued = 0;

    plan_exactly();
    for (uint32_t slot = 0; slot < inner->search.slot_count; slot++) {
        struct jp_planner_state *state = &inner->search.states[slot];

        if (!jp_planner_state_is_used(state) || !state->queued) {
            continue;
        }
        const struct jp_lattice_pose pose = jp_search_pose(inner, slot);
        const uint32_t bucket = (uint32_t)state->bucket;

        for (int32_t i = 0; i < 9; i++) {
            const int32_t x = pose.x + i % 3 - 1;
            const int32_t y = pose.y + i / 3 - 1;
            const struct jp_cell_box other = {x, x, y, y};
            const struct jp_cell_box both = {x < pose.x ? x : pose.x, x > pose.x ? x : pose.x, y < pose.y ? y : pose.y,
                                             y > pose.y ? y : pose.y};
            const bool is_on_map = jp_terrain_contains(&terrain, x, y);

            jp_planner_queue_put(&inner->search, slot, 0);
            if (i != 4 && is_on_map && bucket != 0U) {
                jp_search_rekey_cells(inner, &other);
                TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)state->bucket);
            }
            if (is_on_map) {
                jp_search_rekey_cells(inner, &both);
            } else {
                jp_search_rekey_cells(inner, &(struct jp_cell_box){pose.x, pose.x, pose.y, pose.y});
            }
            TEST_ASSERT_EQUAL_UINT32(bucket, (uint32_t)state->bucket);
        }
        queued++;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(2, queued);
}

/* ---- What is taken over, and told ---- */

/* The lattice before may be overwritten: nothing looks at it any more. */
static void test_all_parts_take_another_lattice(void)
{
    const struct jp_lattice dearer = dearer_driving();

    plan_exactly();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_lattice(&planner, &dearer));
    TEST_ASSERT_EQUAL_PTR(&dearer, inner->config.lattice);
    TEST_ASSERT_EQUAL_PTR(&dearer, inner->guide.lattice);
    TEST_ASSERT_EQUAL_PTR(&dearer, inner->field.lattice);
    TEST_ASSERT_EQUAL_PTR(&dearer, inner->turn_field.lattice);
    TEST_ASSERT_EQUAL_PTR(&dearer, jp_planner_lattice(&planner));
}

/* Also while the plan is checked, and not before the search has begun. */
static void test_states_are_told_as_long_as_there_is_a_search(void)
{
    plan_exactly();
    for (int phase = JP_PLANNER_EMPTY; phase <= JP_PLANNER_SETTLED; phase++) {
        for (int lent = JP_PLANNER_LENT_TO_NONE; lent <= JP_PLANNER_LENT_TO_REHEARSALS; lent++) {
            struct jp_lattice_pose pose;
            uint32_t slot = 0;
            uint32_t count = 0;
            bool is_open;

            inner->phase = (enum jp_planner_phase)phase;
            inner->lent = (enum jp_planner_lent)lent;
            while (jp_planner_next_state(&planner, &slot, &pose, &is_open)) {
                count++;
            }
            TEST_ASSERT_EQUAL_UINT32(phase > JP_PLANNER_CLEAR && lent == 0 ? inner->search.state_count : 0, count);
        }
    }
}

/* Of each route 256 steps, and one for every 32 cells of the map. */
static void test_memory_of_the_routes(void)
{
    for (uint16_t height = HEIGHT; height <= HEIGHT_MAX; height++) {
        map.height = height;
        make_level_map(&map);
        start_planner(PLANNER_BYTES);
        const unsigned steps = 256U + (unsigned)WIDTH * height / 32U;

        TEST_ASSERT_EQUAL_UINT32((steps + 7U) / 8U * 8U, inner->route_max);
        TEST_ASSERT_EQUAL_PTR(inner->block, inner->route);
        TEST_ASSERT_EQUAL_PTR(inner->block + inner->route_max, inner->spare_route);
    }
}

/* A robot that has left its plan: nothing is known of its routes. */
static void test_what_a_robot_off_its_plan_makes_unknown(void)
{
    plan_exactly();
    inner->effort.spent = 40;
    inner->effort.has_cut = true;
    expect_start(JP_OK, 5, 5, 0);
    TEST_ASSERT_EQUAL_UINT32(0, inner->least);
    TEST_ASSERT_EQUAL_UINT32(0, inner->effort.spent);
    TEST_ASSERT_FALSE(inner->effort.has_cut);
    TEST_ASSERT_TRUE(inner->search.is_repaired);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, inner->answer);
    expect_true_answer(finish());
}
