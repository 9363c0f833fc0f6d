/* Repairs that are given up: what a change cannot have touched of the search is kept, where that is worth it. */
#include "src/search/planner_cut.h"
#include "src/search/planner_effort.h"
#include "src/search/planner_repair.h"
#include "src/search/planner_search.h"
#include "src/search/planner_slices.h"
#include "tests/unit/search/planner_optimum.h"

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

/* ---- What is cut ---- */

static bool is_cost(const struct jp_planner_state *state)
{
    return jp_planner_state_is_used(state) && state->g != JP_COST_MAX;
}

/* From the least wrong cost on all are forgotten, the ones below stay; of those that are forgotten the ones are lost
 * over which a route as cheap as the plan may lead. */
static void test_cut_forgets_what_may_rest_on_a_wrong_cost(void)
{
    struct jp_planner_search *search = &planner.internal.search;
    unsigned slots = 7;

    begin();
    expect_optimal();
    const jp_cost wrong = jp_planner_plan(&planner)->cost / 2;
    uint32_t below = 0;
    uint32_t from = 0;
    uint32_t needed = 0;
    for (uint32_t slot = 0; slot < search->slot_count; slot++) {
        struct jp_planner_state *state = &search->states[slot];
        const struct jp_lattice_pose pose = jp_search_pose(&planner.internal, slot);
        below += is_cost(state) && state->g < wrong;
        from += is_cost(state) && state->g >= wrong;
        needed += is_cost(state) && state->g >= wrong &&
                  state->g + jp_search_heuristic(&planner.internal, &pose) <= jp_planner_plan(&planner)->cost;
        if (is_cost(state) && (state->g == wrong || state->g > 3 * wrong / 2)) {
            state->rhs = (state->g + 1) & JP_COST_MAX;
        }
    }
    TEST_ASSERT_TRUE(below > 0 && needed > 0 && from >= needed);
    jp_cut_begin(&planner.internal);
    while (!jp_cut_work(&planner.internal, &slots)) {
        TEST_ASSERT_TRUE(slots < 7);
        slots = 7;
    }
    TEST_ASSERT_EQUAL_UINT32(wrong, search->cut_cost);
    for (uint32_t slot = 0; slot < search->slot_count; slot++) {
        below -= is_cost(&search->states[slot]);
        TEST_ASSERT_TRUE(!is_cost(&search->states[slot]) || search->states[slot].g < wrong);
    }
    TEST_ASSERT_EQUAL_UINT32(0, below);
    TEST_ASSERT_EQUAL_UINT32(needed, planner.internal.cut.lost);
    planner.internal.effort = (struct jp_planner_effort){.fresh_end = needed, .fresh_cost = 2 * wrong};
    TEST_ASSERT_FALSE(jp_cut_is_worth_it(&planner.internal));
    planner.internal.effort.fresh_end = needed + 1;
    TEST_ASSERT_TRUE(jp_cut_is_worth_it(&planner.internal));
}

/* ---- Effort ---- */

/* What a new search takes grows with the square of the cost of its route, up to what the last one took. */
static void test_effort_of_a_new_search(void)
{
    struct jp_planner_internal *inner = &planner.internal;

    begin();
    expect_optimal();
    const jp_cost cost = inner->plan.cost;
    inner->effort = (struct jp_planner_effort){.fresh_route = 400, .fresh_end = 1600, .fresh_cost = 2 * cost};
    TEST_ASSERT_EQUAL_UINT32(400, jp_effort_anew(inner));
    inner->answer = JP_ANSWER_OUT_OF_BUDGET; /* there is no route: of one, not of its proof */
    TEST_ASSERT_EQUAL_UINT32(100, jp_effort_anew(inner));
    inner->effort.fresh_cost = cost / 2;
    TEST_ASSERT_EQUAL_UINT32(400, jp_effort_anew(inner));
    inner->effort.fresh_cost = 0;
    TEST_ASSERT_EQUAL_UINT32(0, jp_effort_anew(inner));
}

/* A search by itself has no limit; a repaired one may take a tenth of a new one, and ends then. */
static void test_slices_of_a_repair(void)
{
    struct jp_planner_internal *inner = &planner.internal;

    begin();
    expect_optimal();
    inner->answer = JP_ANSWER_OUT_OF_BUDGET;
    inner->phase = JP_PLANNER_SEARCH;
    inner->effort = (struct jp_planner_effort){.fresh_route = 1000, .fresh_cost = inner->plan.cost, .spent = 60};
    TEST_ASSERT_EQUAL_UINT32(500, jp_effort_slice(inner, 500));
    inner->search.is_repaired = true;
    TEST_ASSERT_EQUAL_UINT32(1000 / 10 + 1 - 60, jp_effort_slice(inner, 500));
    TEST_ASSERT_EQUAL_UINT32(7, jp_effort_slice(inner, 7));
    inner->effort.spent = 1000;
    TEST_ASSERT_EQUAL_UINT32(0, jp_effort_slice(inner, 7));
    inner->phase = JP_PLANNER_TRACE; /* what it has found is worth its trace */
    TEST_ASSERT_EQUAL_UINT32(7, jp_effort_slice(inner, 7));
    inner->phase = JP_PLANNER_CHECK_PLAN;
    TEST_ASSERT_EQUAL_UINT32(7, jp_effort_slice(inner, 7));
    inner->phase = JP_PLANNER_REPAIR;
    TEST_ASSERT_EQUAL_UINT32(0, jp_effort_slice(inner, 7));
    inner->effort.has_cut = true; /* what is left is part of a new search */
    TEST_ASSERT_EQUAL_UINT32(7, jp_effort_slice(inner, 7));
}

/* From the beginning to the first route, and to its proof. */
static void test_effort_is_noted(void)
{
    unsigned units = 0;
    unsigned to_route = 0;

    config.epsilon[0] = JP_EPSILON(2);
    config.epsilon[1] = JP_EPSILON_ONE;
    begin();
    raise(8, 4, 10);
    jp_planner_restart(&planner);
    while (!jp_planner_is_idle(&planner)) {
        const enum jp_answer answer = jp_planner_work(&planner, 1);
        units++;
        to_route += answer == JP_ANSWER_OUT_OF_BUDGET;
    }
    const struct jp_planner_effort *effort = &planner.internal.effort;
    TEST_ASSERT_UINT32_WITHIN(units / 10, to_route, effort->fresh_route);
    TEST_ASSERT_UINT32_WITHIN(units / 10, units, effort->fresh_end);
    TEST_ASSERT_TRUE(effort->fresh_route < effort->fresh_end);
    TEST_ASSERT_EQUAL_UINT32(jp_planner_plan(&planner)->cost, effort->fresh_cost);
}

/* ---- Changes that are repaired together ---- */

static void test_changes_that_fit_one_repair(void)
{
    struct jp_planner_internal *inner = &planner.internal;

    begin();
    expect_optimal();
    TEST_ASSERT_TRUE(jp_repair_fits(inner, -500, 500));
    for (int32_t along = 0; along < 2; along++) {
        inner->changes.count = 3;
        for (int32_t i = 0; i < 3; i++) { /* from 100 to 104 along one axis */
            const int16_t at = (int16_t)(100 + (i == 1 ? 4 : i));
            inner->changes.cells[i] = (struct jp_cell_change){along == 0 ? at : 100, along == 0 ? 100 : at};
        }
        for (int32_t at = 80; at < 125; at++) {
            const bool is_near = at > 104 - 16 && at < 100 + 16;
            TEST_ASSERT_EQUAL_INT(is_near, jp_repair_fits(inner, along == 0 ? at : 100, along == 0 ? 100 : at));
            TEST_ASSERT_EQUAL_INT(at > 100 - 16 && at < 100 + 16,
                                  jp_repair_fits(inner, along == 0 ? 102 : at, along == 0 ? at : 102));
        }
    }
    inner->changes.count = JP_PLANNER_CHANGES - 1;
    for (unsigned i = 0; i < JP_PLANNER_CHANGES; i++) {
        inner->changes.cells[i] = (struct jp_cell_change){100, 100};
    }
    TEST_ASSERT_TRUE(jp_repair_fits(inner, 100, 100));
    inner->changes.count++;
    TEST_ASSERT_FALSE(jp_repair_fits(inner, 100, 100));
}

static void work_until_cut_is_over(void)
{
    while (planner.internal.phase == JP_PLANNER_CUT || planner.internal.phase == JP_PLANNER_REKEY) {
        (void)jp_planner_work(&planner, 1);
    }
}

/* After the cut each state looks one step ahead over what is left, and waits in the queue as long as it does not cost
 * that. */
static void test_states_are_sound_after_any_cut(void)
{
    int cuts = 0;

    for (int units = SMALL; units < LATE; units += 3) {
        if (!cuts_after(units)) {
            continue;
        }
        believe(AMPLE);
        work_until_cut_is_over();
        TEST_ASSERT_EQUAL_INT(JP_PLANNER_SEARCH, planner.internal.phase);
        TEST_ASSERT_TRUE(is_search_at_rest());
        expect_sound_states();
        cuts++;
    }
    TEST_ASSERT_TRUE(cuts > 3);
}

/* A change, and a robot that is elsewhere, end what the cut had left: the next repair may be given up again. */
static void test_after_a_change_a_repair_has_a_limit_again(void)
{
    for (int i = 0; i < 2; i++) {
        TEST_ASSERT_TRUE(cuts_after(SMALL));
        believe(AMPLE);
        work_until_cut_is_over();
        TEST_ASSERT_TRUE(planner.internal.effort.has_cut);
        if (i == 0) {
            raise(6, 4, 20);
        } else {
            expect_start(JP_OK, 5, 5, 0);
        }
        TEST_ASSERT_FALSE(planner.internal.effort.has_cut);
        expect_optimal();
    }
}

/* Two looks over all slots, of which a unit of the budget takes 128; what is left of it is left. */
static void test_budget_of_the_cut(void)
{
    unsigned budget = 1000;

    TEST_ASSERT_TRUE(cuts_after(SMALL));
    planner.internal.cut.slot = 0;
    planner.internal.cut.is_found = false;
    TEST_ASSERT_FALSE(jp_slice_cut(&planner.internal, &budget));
    TEST_ASSERT_TRUE(planner.internal.cut.is_found);
    TEST_ASSERT_EQUAL_UINT32((1000U * 128U - planner.internal.search.slot_count) / 128U, budget);
    budget = 1000;
    TEST_ASSERT_TRUE(jp_slice_cut(&planner.internal, &budget));
    TEST_ASSERT_EQUAL_UINT32((1000U * 128U - planner.internal.search.slot_count) / 128U, budget);
    for (unsigned i = 0; i < 3U; i++) {
        budget = 0;
        planner.internal.cut.slot = 0;
        TEST_ASSERT_FALSE(jp_slice_cut(&planner.internal, &budget));
        TEST_ASSERT_EQUAL_UINT32(0, planner.internal.cut.slot);
    }
}

/* ---- What a repair looks at ---- */

enum { FAR = 150 };

static bool is_swept(const struct jp_lattice *of, unsigned heading, int32_t x, int32_t y)
{
    const struct jp_cells reach = of->reach[heading];

    for (unsigned i = 0; i < planner.internal.changes.count; i++) {
        const struct jp_cell_change *change = &planner.internal.changes.cells[i];

        for (unsigned k = 0; k < reach.span_count; k++) {
            const struct jp_span *span = &of->spans[reach.first_span + k];

            if (change->y - y == span->y && change->x - x >= span->first && change->x - x <= span->last) {
                return true;
            }
        }
    }
    return false;
}

static unsigned swept_cells(const struct jp_lattice *of, unsigned heading)
{
    unsigned count = 0;

    for (int32_t y = -FAR; y <= FAR; y++) {
        bool has_row = false;

        for (unsigned k = 0; k < of->reach[heading].span_count && !has_row; k++) {
            for (unsigned i = 0; i < planner.internal.changes.count; i++) {
                has_row = has_row ||
                          planner.internal.changes.cells[i].y - y == of->spans[of->reach[heading].first_span + k].y;
            }
        }
        for (int32_t x = -FAR; has_row && x <= FAR; x++) {
            count += is_swept(of, heading, x, y);
        }
    }
    return count;
}

/* Each pose from which a primitive may sweep a changed cell, once, however far primitives reach; in slices as in one.
 */
static void test_repair_looks_at_all_that_sweeps_a_changed_cell(void)
{
    static const struct jp_span spans[] = {{-70, -100, 30}, {0, -100, 100}, {90, 5, 5},       {1, -63, 0}, {-1, 0, 64},
                                           {64, -127, 127}, {-127, 3, 66},  {127, -127, -64}, {0, 0, 0}};
    static const struct jp_cell_change cells[] = {{8, 4}, {9, 4}, {15, 7}, {2, 0}};
    struct jp_planner_internal *inner = &planner.internal;
    struct jp_lattice wide = *lattice;
    unsigned slots = UINT16_MAX;

    begin();
    expect_optimal();
    inner->search.clear_slot = 0;
    TEST_ASSERT_TRUE(jp_planner_states_clear(&inner->search, &slots));
    wide.spans = spans;
    inner->config.lattice = &wide;
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        wide.reach[heading] =
            (struct jp_cells){(uint16_t)(heading % 9U), (uint16_t)(1U + heading % (9U - heading % 9U))};
    }
    for (uint16_t count = 1; count <= 4U; count++) {
        unsigned expected = 0;
        unsigned states = 100000;

        memcpy(inner->changes.cells, cells, sizeof cells);
        inner->changes.count = count;
        inner->changes.may_be_cheaper = false;
        inner->changes.cursor = 0;
        for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
            expected += swept_cells(&wide, heading);
        }
        TEST_ASSERT_EQUAL_INT(REPAIR_DONE, jp_repair_work(inner, &states));
        TEST_ASSERT_EQUAL_UINT32(expected, 100000U - states);
        inner->changes.cursor = 0;
        for (unsigned left = expected; left > 0U; left -= left < 37U ? left : 37U) {
            states = left < 37U ? left : 37U;
            TEST_ASSERT_EQUAL_INT(left <= 37U ? REPAIR_DONE : REPAIR_WORKING, jp_repair_work(inner, &states));
            TEST_ASSERT_EQUAL_UINT32(0, states);
        }
    }
}
