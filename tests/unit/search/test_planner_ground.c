/* The planner on maps whose cells cost more, and whose ground is of several classes; what it tells of itself. */
#include "tests/unit/search/planner_changes.h"

static struct jp_lattice priced;

void setUp(void)
{
    rig_reset();
    forget_looks();
    seed = 1;
    map.has_costs = true;
    map.cost_shift = 5;
    map.has_classes = true;
    make_level_map(&map);
    priced = *lattice;
    priced.ground[1] = (struct jp_ground_price){JP_GROUND_ONE, 0};
    priced.ground[2] = (struct jp_ground_price){0, JP_GROUND_ONE / 2};
    config.lattice = &priced;
}

void tearDown(void)
{
}

static void set_cost(int32_t x, int32_t y, uint8_t cost)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_cost(&planner, x, y, cost));
}

static void set_class(int32_t x, int32_t y, uint8_t ground)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_class(&planner, x, y, ground));
}

/* In the plan's cost, once more than the level cells. */
static jp_cost proved_cost(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, finish());
    expect_true_answer(JP_ANSWER_OPTIMAL);
    return jp_planner_plan(&planner)->cost;
}

static void begin_on_ground(void)
{
    start_planner(PLANNER_BYTES);
    go(&west, &east);
    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, proved_cost());
}

static void test_dearer_cells(void)
{
    begin_on_ground();
    for (int32_t y = 2; y < 7; y++) {
        set_cost(8, y, 32); /* twice as dear: the step to it and the one from it */
    }
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_work(&planner, 0));
    TEST_ASSERT_EQUAL_UINT32((STEPS + 2) * AXIS_COST, proved_cost());
    for (int32_t y = 2; y < 7; y++) {
        set_cost(8, y, 0);
    }
    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, proved_cost());
}

static void test_classes_of_ground(void)
{
    begin_on_ground();
    for (int32_t y = 2; y < 7; y++) {
        set_class(8, y, 1); /* a step has the mean of its ends */
    }
    TEST_ASSERT_EQUAL_UINT32((STEPS + 1) * AXIS_COST, proved_cost());
    for (int32_t y = 2; y < 7; y++) {
        set_class(8, y, 2); /* straight on it costs nothing more */
    }
    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, proved_cost());
}

/* What is the same as before ends nothing; what cannot be leaves the map. */
static void test_changes_that_are_none(void)
{
    begin_on_ground();
    set_cost(8, 4, 0);
    set_class(8, 4, 0);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_planner_set_cost(&planner, WIDTH, 4, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_planner_set_class(&planner, 8, HEIGHT, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_set_class(&planner, 8, 4, JP_GROUND_CLASSES));
    TEST_ASSERT_TRUE(jp_planner_is_idle(&planner));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, jp_planner_work(&planner, 1));
    TEST_ASSERT_EQUAL_UINT32(terrain.version, planner.internal.terrain_version);
}

/* Only what may make the map cheaper makes the bound fall; a class may by either of its prices. */
static void test_which_changes_may_make_the_map_cheaper(void)
{
    static const bool may[3][3] = {{false, false, false}, {true, false, true}, {true, true, false}}; /* from, to */

    for (uint8_t from = 0; from < 3; from++) {
        for (uint8_t to = 0; to < 3; to++) {
            make_level_map(&map);
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_class(&terrain, 14, 4, from));
            begin_on_ground();
            set_class(14, 4, to);
            TEST_ASSERT_EQUAL_INT(may[from][to], planner.internal.changes.may_be_cheaper);
            TEST_ASSERT_EQUAL_INT(from != to, planner.internal.changes.count);
        }
    }
    for (int cost = 4; cost <= 6; cost++) {
        make_level_map(&map);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cost(&terrain, 14, 4, 5));
        begin_on_ground();
        set_cost(14, 4, (uint8_t)cost);
        TEST_ASSERT_EQUAL_INT(cost < 5, planner.internal.changes.may_be_cheaper);
        TEST_ASSERT_EQUAL_INT(cost != 5, planner.internal.changes.count);
    }
}

static void test_answers_while_the_ground_changes(void)
{
    start_planner(PLANNER_BYTES);
    go(&west, &east);
    for (int i = 0; i < ROUNDS; i++) {
        for (uint32_t changes = pick(4); changes > 0; changes--) {
            const int32_t x = (int32_t)pick(WIDTH);
            const int32_t y = (int32_t)pick(HEIGHT);
            if (pick(2) == 0) {
                set_cost(x, y, (uint8_t)pick(64));
            } else {
                set_class(x, y, (uint8_t)pick(3));
            }
        }
        work_a_while();
        if (pick(3) == 0) {
            move_robot();
            end_search();
        }
    }
    (void)proved_cost();
    TEST_ASSERT_TRUE(looks_at_states > 3);
}

/* ---- What it tells ---- */

static void test_map_and_lattice(void)
{
    const struct jp_lattice other = priced;

    begin_on_ground();
    TEST_ASSERT_EQUAL_PTR(&terrain, jp_planner_terrain(&planner));
    TEST_ASSERT_EQUAL_PTR(&priced, jp_planner_lattice(&planner));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_lattice(&planner, &other));
    TEST_ASSERT_EQUAL_PTR(&other, jp_planner_lattice(&planner));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_lattice(&planner, &priced));
}

/* An expansion keeps room for as many neighbours as any heading has, to come from or to go to. */
static void test_neighbours_of_a_state(void)
{
    unsigned most = 0;

    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        unsigned count = 0;
        for (unsigned i = 0; i < priced.first_from[JP_HEADINGS]; i++) {
            count += priced.primitives[i].start == heading;
        }
        most = count > most ? count : most;
    }
    start_planner(PLANNER_BYTES);
    TEST_ASSERT_EQUAL_UINT16(most, planner.internal.neighbours_max);
    for (int i = 0; i < 2; i++) {
        uint16_t *first = i == 0 ? priced.first_from : priced.first_to;
        first[JP_HEADINGS - 1]--; /* the last heading has one more, the one before it one less */
        start_planner(PLANNER_BYTES);
        first[JP_HEADINGS - 1]++;
        const unsigned last = (unsigned)first[JP_HEADINGS] - first[JP_HEADINGS - 1] + 1;
        TEST_ASSERT_EQUAL_UINT16(last > most ? last : most, planner.internal.neighbours_max);
    }
}

/* The statistics count the expansions that states have had, and each search that has begun. */
static void test_expansions_are_counted(void)
{
    begin_on_ground();
    const uint32_t expansions = jp_planner_statistics(&planner)->expansions;
    uint32_t consistent = 0;

    for (uint32_t slot = 0; slot < planner.internal.search.slot_count; slot++) {
        const struct jp_planner_state *state = &planner.internal.search.states[slot];
        consistent += jp_planner_state_is_used(state) && state->g != JP_COST_MAX;
    }
    TEST_ASSERT_TRUE(expansions >= consistent && consistent >= STEPS);
    TEST_ASSERT_EQUAL_UINT32(1, jp_planner_statistics(&planner)->restarts);
    jp_planner_restart(&planner);
    (void)proved_cost();
    TEST_ASSERT_EQUAL_UINT32(2, jp_planner_statistics(&planner)->restarts);
    TEST_ASSERT_EQUAL_UINT32(2 * expansions, jp_planner_statistics(&planner)->expansions);
}
