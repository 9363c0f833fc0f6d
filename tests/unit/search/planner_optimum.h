/** What a planner on the rig's map is judged by: the least costs from the robot to all states, found by looking at
 * every primitive until no cost falls any more; and what AD* promises of its states whenever nothing waits for a
 * repair. */
#ifndef JOULEPATH_TESTS_UNIT_SEARCH_PLANNER_OPTIMUM_H
#define JOULEPATH_TESTS_UNIT_SEARCH_PLANNER_OPTIMUM_H

#include "src/search/planner_search.h"
#include "src/search/planner_states.h"
#include "tests/support/planner_rig.h"

enum {
    INNER_FIRST = 2, /* the robot stands on these cells alone */
    INNER_WIDTH = WIDTH - 2 * INNER_FIRST,
    INNER_HEIGHT = HEIGHT - 2 * INNER_FIRST,
    INNER_STATES = INNER_WIDTH * INNER_HEIGHT * JP_HEADINGS,
    NO_WAY = UINT16_MAX, /* and what costs as much: no least cost does */
    PLANNER_BYTES = BLOCK_BYTES - 2 * INNER_STATES
};

/* In the end of the rig's block, which the planner does not get: the smallest core has no more RAM. */
static uint16_t *const least_costs = (uint16_t *)(void *)&block[PLANNER_BYTES / sizeof *block];
static uint8_t has_fallen[INNER_STATES / 8];
static uint8_t answers[JP_ANSWER_STALE + 1]; /* how often each has been looked at */
static uint8_t looks_at_states;

static inline void forget_looks(void)
{
    memset(answers, 0, sizeof answers);
    looks_at_states = 0;
}

static inline unsigned inner_index(int x, int y, unsigned heading)
{
    TEST_ASSERT_TRUE(x >= INNER_FIRST && x < INNER_FIRST + INNER_WIDTH);
    TEST_ASSERT_TRUE(y >= INNER_FIRST && y < INNER_FIRST + INNER_HEIGHT);
    return ((unsigned)(y - INNER_FIRST) * INNER_WIDTH + (unsigned)(x - INNER_FIRST)) * JP_HEADINGS + heading;
}

static inline struct jp_lattice_pose inner_pose(unsigned index)
{
    const unsigned cell = index / JP_HEADINGS;

    return (struct jp_lattice_pose){(int16_t)(INNER_FIRST + cell % INNER_WIDTH),
                                    (int16_t)(INNER_FIRST + cell / INNER_WIDTH), (uint8_t)(index % JP_HEADINGS)};
}

/** Lowers what a state's primitives lead to. True when one of these comes before it in the order of the states. */
static inline bool lower_neighbours(unsigned state)
{
    const struct jp_lattice *tables = config.lattice;
    const struct jp_lattice_pose pose = inner_pose(state);
    bool goes_back = false;

    for (unsigned i = tables->first_from[pose.heading]; i < tables->first_from[pose.heading + 1]; i++) {
        const struct jp_primitive *step = &tables->primitives[i];
        const jp_cost cost = jp_lattice_cost(tables, config.cost, &terrain, step, pose.x, pose.y);
        if (cost == JP_COST_MAX) {
            continue;
        }
        const unsigned next = inner_index(pose.x + step->dx, pose.y + step->dy, step->end);
        if (least_costs[state] + cost < least_costs[next]) {
            least_costs[next] = (uint16_t)(least_costs[state] + cost);
            has_fallen[next / 8] |= (uint8_t)(1U << next % 8);
            goes_back |= next <= state;
        }
    }
    return goes_back;
}

static inline jp_cost least_cost_to(const struct jp_lattice_pose *from, const struct jp_goal *goal)
{
    const unsigned start = inner_index(from->x, from->y, from->heading);
    unsigned least = NO_WAY;
    bool again = true;

    memset(least_costs, UINT8_MAX, INNER_STATES * sizeof *least_costs);
    memset(has_fallen, 0, sizeof has_fallen);
    least_costs[start] = 0;
    has_fallen[start / 8] = (uint8_t)(1U << start % 8);
    while (again) {
        again = false;
        for (unsigned state = 0; state < INNER_STATES; state++) {
            const uint8_t bit = (uint8_t)(1U << state % 8);
            if ((has_fallen[state / 8] & bit) != 0) {
                has_fallen[state / 8] &= (uint8_t)~bit;
                again |= lower_neighbours(state);
            }
        }
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const unsigned cost = least_costs[inner_index(goal->x, goal->y, heading)];
        least = (goal->headings >> heading & 1) != 0 && cost < least ? cost : least;
    }
    return least;
}

/** As expect_drivable(), by the lattice of the configuration. */
static inline void expect_plan_on_tables(void)
{
    const struct jp_plan *plan = jp_planner_plan(&planner);
    struct jp_lattice_pose pose = plan->start;
    jp_cost cost = 0;

    for (unsigned i = 0; i < plan->step_count; i++) {
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *step = jp_planner_step(&planner, i, &pose);
        TEST_ASSERT_NOT_NULL(step);
        TEST_ASSERT_EQUAL_INT(from.heading, step->start);
        cost = jp_cost_add(cost, jp_lattice_cost(config.lattice, config.cost, &terrain, step, from.x, from.y));
    }
    TEST_ASSERT_EQUAL_UINT32(plan->cost, cost);
    TEST_ASSERT_TRUE(cost < JP_COST_MAX);
    TEST_ASSERT_EQUAL_INT(plan->end.x, pose.x);
    TEST_ASSERT_EQUAL_INT(plan->end.y, pose.y);
    TEST_ASSERT_EQUAL_INT(plan->end.heading, pose.heading);
}

/** An answer is true of the map as it is, and what is claimed of the plan. */
static inline void expect_true_answer(enum jp_answer answer)
{
    const struct jp_plan *plan = jp_planner_plan(&planner);
    const jp_cost least = least_cost_to(&planner.internal.start, &planner.internal.goal);

    answers[answer]++;
    if (answer == JP_ANSWER_UNREACHABLE) {
        TEST_ASSERT_EQUAL_UINT32(NO_WAY, least);
        return;
    }
    if (answer == JP_ANSWER_OUT_OF_BUDGET) {
        return;
    }
    TEST_ASSERT_EQUAL_INT(answer, plan->answer);
    TEST_ASSERT_EQUAL_MEMORY(&planner.internal.start, &plan->start, sizeof plan->start);
    expect_plan_on_tables();
    if (answer == JP_ANSWER_PARTIAL) {
        TEST_ASSERT_TRUE(plan->cost_left > 0);
        TEST_ASSERT_EQUAL_UINT32(0, plan->bound);
        return;
    }
    TEST_ASSERT_EQUAL_UINT32(0, plan->cost_left);
    TEST_ASSERT_EQUAL_INT(planner.internal.goal.x, plan->end.x);
    TEST_ASSERT_EQUAL_INT(planner.internal.goal.y, plan->end.y);
    TEST_ASSERT_TRUE((planner.internal.goal.headings >> plan->end.heading & 1) != 0);
    TEST_ASSERT_TRUE(plan->cost >= least);
    TEST_ASSERT_TRUE(plan->bound >= JP_EPSILON_ONE);
    TEST_ASSERT_TRUE((answer == JP_ANSWER_OPTIMAL) == (plan->bound == JP_EPSILON_ONE));
    if (plan->bound != JP_BOUND_NONE) {
        TEST_ASSERT_TRUE((uint64_t)plan->cost * JP_EPSILON_ONE <= (uint64_t)plan->bound * least);
    }
}

/* ---- States ---- */

static inline bool is_wanted(const struct jp_lattice_pose *pose)
{
    const struct jp_goal *goal = &planner.internal.goal;

    return pose->x == goal->x && pose->y == goal->y && (goal->headings >> pose->heading & 1) != 0;
}

/** Cost to the goal over the best of the neighbours. */
static inline jp_cost cost_over_neighbours(const struct jp_lattice_pose *pose)
{
    const struct jp_lattice *tables = config.lattice;
    jp_cost least = is_wanted(pose) ? 0 : JP_COST_MAX;

    for (unsigned i = tables->first_from[pose->heading]; i < tables->first_from[pose->heading + 1]; i++) {
        const struct jp_primitive *step = &tables->primitives[i];
        const jp_cost cost = jp_lattice_cost(tables, config.cost, &terrain, step, pose->x, pose->y);
        if (cost == JP_COST_MAX) {
            continue;
        }
        const uint32_t slot =
            jp_planner_states_find(&planner.internal.search,
                                   jp_search_id(&planner.internal, pose->x + step->dx, pose->y + step->dy, step->end));
        const jp_cost whole =
            slot == NO_SLOT ? JP_COST_MAX : jp_cost_add((jp_cost)planner.internal.search.states[slot].g, cost);
        least = whole < least ? whole : least;
    }
    return least;
}

/** Waits for the next ε, or for the robot to be able to reach it. */
static inline bool must_wait(const struct jp_planner_state *state, const struct jp_lattice_pose *pose)
{
    return planner.internal.search.is_exact ? jp_search_heuristic(&planner.internal, pose) == JP_COST_MAX
                                            : state->closed && state->g > state->rhs;
}

/** Costs that fall wait behind those that have risen, by a bucket, and with the search's own heuristic. */
static inline uint32_t key_of(const struct jp_planner_state *state, const struct jp_lattice_pose *pose)
{
    const struct jp_planner_search *search = &planner.internal.search;
    const uint32_t heuristic = jp_search_heuristic(&planner.internal, pose);

    if (state->g < state->rhs) {
        return (uint32_t)state->g + (search->is_exact ? heuristic : 0U);
    }
    return (uint32_t)state->rhs + heuristic * search->epsilon / JP_EPSILON_ONE + (UINT32_C(1) << search->bucket_shift);
}

static inline uint32_t expect_true_lists(void)
{
    const struct jp_planner_search *search = &planner.internal.search;
    uint32_t count = 0;

    for (uint32_t bucket = 0; bucket < search->bucket_count; bucket++) {
        uint32_t before = NO_SLOT;
        for (uint32_t slot = search->buckets[bucket]; slot != NO_SLOT; slot = (uint32_t)search->states[slot].next) {
            TEST_ASSERT_TRUE(bucket >= search->lowest_bucket);
            TEST_ASSERT_EQUAL_UINT32(bucket, (uint32_t)search->states[slot].bucket);
            TEST_ASSERT_EQUAL_UINT32(before, (uint32_t)search->states[slot].previous);
            TEST_ASSERT_TRUE(search->states[slot].queued);
            before = slot;
            count++;
            TEST_ASSERT_TRUE(count <= search->state_count);
        }
    }
    return count;
}

/** True when a search from the goal expands, or could, and nothing waits to be repaired or sorted. */
static inline bool is_search_at_rest(void)
{
    const struct jp_planner_internal *inner = &planner.internal;

    return (inner->phase == JP_PLANNER_SEARCH || inner->phase == JP_PLANNER_SETTLED) &&
           inner->lent == JP_PLANNER_LENT_TO_NONE && inner->search.direction == JP_PLANNER_FROM_GOAL &&
           !inner->is_splicing && inner->changes.count == 0;
}

/** Each state looks one step ahead over the map as it is, and is in the queue as long as its cost is not that one. */
static inline void expect_sound_states(void)
{
    const struct jp_planner_search *search = &planner.internal.search;
    uint32_t count = 0;
    uint32_t queued = 0;

    looks_at_states++;
    for (uint32_t slot = 0; slot < search->slot_count; slot++) {
        const struct jp_planner_state *state = &search->states[slot];
        if (!jp_planner_state_is_used(state)) {
            continue;
        }
        const struct jp_lattice_pose pose = jp_search_pose(&planner.internal, slot);
        TEST_ASSERT_EQUAL_UINT32(slot, jp_planner_states_find(search, (uint32_t)state->id));
        TEST_ASSERT_EQUAL_UINT32(cost_over_neighbours(&pose), (uint32_t)state->rhs);
        TEST_ASSERT_EQUAL_INT(state->g != state->rhs && !must_wait(state, &pose), state->queued);
        count++;
        queued += state->queued;
        if (state->queued && planner.internal.phase == JP_PLANNER_SEARCH) {
            const uint32_t bucket = key_of(state, &pose) >> search->bucket_shift;
            TEST_ASSERT_EQUAL_UINT32(bucket < search->bucket_count ? bucket : search->bucket_count - 1U,
                                     (uint32_t)state->bucket);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(count, search->state_count);
    TEST_ASSERT_EQUAL_UINT32(queued, expect_true_lists());
}

#endif
