/* The planner: its statuses, its answers and its plans, in slices of any size. */
#include <limits.h>
#include <stddef.h>

#include "src/search/planner_states.h"
#include "tests/support/planner_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

/* Memory and configuration */

static void test_smallest_block(void)
{
    const char *field = "";
    const size_t size = jp_planner_size(&map);

    TEST_ASSERT_TRUE(size > 0 && size <= sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, init(size - 1, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, init(0, &field));
    start_planner(size);
    TEST_ASSERT_TRUE(jp_planner_statistics(&planner)->states_max >= 64);
    TEST_ASSERT_EQUAL_UINT32(0, jp_planner_statistics(&planner)->field_bytes);
}

static void test_no_block_for_a_map_out_of_range(void)
{
    map.width = 0;
    TEST_ASSERT_EQUAL_UINT32(0, jp_planner_size(&map));
    map.width = JP_TERRAIN_SIDE_MAX + 1;
    TEST_ASSERT_EQUAL_UINT32(0, jp_planner_size(&map));
    map.width = JP_TERRAIN_SIDE_MAX;
    map.height = JP_TERRAIN_SIDE_MAX;
    TEST_ASSERT_TRUE(jp_planner_size(&map) > 0);
}

/* Nothing is written outside the block. */
static void test_block_is_all_that_is_used(void)
{
    const uint8_t *bytes = (const uint8_t *)block;

    for (size_t size = jp_planner_size(&map); size + SPARE < sizeof block; size += 509) {
        memset(block, 0x5A, sizeof block);
        start_planner(size);
        go(&west, &east);
        (void)finish();
        for (size_t i = size; i < sizeof block; i++) {
            TEST_ASSERT_EQUAL_UINT8(0x5A, bytes[i]);
        }
    }
}

static void test_statistics_share_out_the_block(void)
{
    start_planner(sizeof block);
    const struct jp_planner_counts *statistics = jp_planner_statistics(&planner);
    const uint32_t used = statistics->guide_bytes + statistics->field_bytes + statistics->search_bytes;

    TEST_ASSERT_TRUE(statistics->guide_bytes > 0 && statistics->field_bytes > 0);
    TEST_ASSERT_TRUE(used < sizeof block && used > sizeof block * 9 / 10);
    TEST_ASSERT_EQUAL_UINT32(0, statistics->states);
    TEST_ASSERT_EQUAL_UINT32(0, statistics->expansions);
    TEST_ASSERT_EQUAL_UINT32(0, statistics->restarts);
}

/* Record, hash and queue, for the blocks of the bench, on a large map. The layout touches no memory. */
static void test_a_state_takes_at_most_20_bytes(void)
{
    static const uint32_t kibibytes[] = {64, 128, 256, 512, 8192};
    const struct jp_terrain_config large = {.width = JP_TERRAIN_SIDE_MAX, .height = JP_TERRAIN_SIDE_MAX};
    struct jp_planner_search search = {0};

    for (size_t i = 0; i < sizeof kibibytes / sizeof kibibytes[0]; i++) {
        const size_t bytes = jp_planner_states_init(&search, &large, block, kibibytes[i] * 1024);
        TEST_ASSERT_TRUE(bytes <= kibibytes[i] * 1024);
        TEST_ASSERT_TRUE(bytes >= kibibytes[i] * 1024 * 99 / 100);
        TEST_ASSERT_TRUE(bytes <= 20 * search.state_count_max);
    }
    (void)jp_planner_states_init(&search, &large, block, (size_t)1 << 30);
    TEST_ASSERT_UINT32_WITHIN(JP_PLANNER_STATES_MAX / 100, JP_PLANNER_STATES_MAX, search.state_count_max);
    TEST_ASSERT_EQUAL_UINT32(16, sizeof(struct jp_planner_state));
}

/* Work over the table is for the states that the map has, in any block. */
static void test_no_more_states_than_the_map_has(void)
{
    struct jp_planner_search search = {0};

    for (unsigned bits = 16; bits <= 28; bits += 4) {
        const size_t bytes = jp_planner_states_init(&search, &terrain.config, block, (size_t)1 << bits);
        TEST_ASSERT_TRUE(search.state_count_max >= WIDTH * HEIGHT * JP_HEADINGS);
        TEST_ASSERT_TRUE(search.state_count_max <= WIDTH * HEIGHT * JP_HEADINGS + JP_HEADINGS);
        TEST_ASSERT_TRUE(bytes <= 20 * search.state_count_max);
    }
}

/* A sixteenth of the states' memory is the scout's, once that has room for the least of them, if there is an energy
 * field. The layout touches no memory. */
static void test_where_a_block_has_room_for_a_scout(void)
{
    const struct jp_planner_internal *inner = &planner.internal;
    unsigned with = 0;

    for (size_t size = 20 * 1024; size < 30 * 1024; size += 256) {
        start_planner(size);
        const size_t all =
            size - (size_t)((const uint8_t *)inner->search.states - (const uint8_t *)block) +
            (inner->resting.state_count_max > 0
                 ? (size_t)((const uint8_t *)inner->search.states - (const uint8_t *)inner->resting.states)
                 : 0U);
        const bool has_room = all / 16 >= jp_planner_states_size(64);
        TEST_ASSERT_EQUAL_INT(has_room, inner->resting.state_count_max > 0);
        TEST_ASSERT_EQUAL_UINT32(inner->search.state_count_max + inner->resting.state_count_max,
                                 jp_planner_statistics(&planner)->states_max);
        TEST_ASSERT_TRUE(jp_planner_statistics(&planner)->search_bytes <= all);
        TEST_ASSERT_TRUE(jp_planner_statistics(&planner)->search_bytes > all - all / 16);
        if (has_room) {
            const uint8_t *end = (const uint8_t *)&inner->resting.buckets[inner->resting.bucket_count];
            TEST_ASSERT_TRUE(end <= (const uint8_t *)inner->search.states);
            TEST_ASSERT_TRUE(inner->resting.state_count_max >= 64);
            TEST_ASSERT_TRUE(inner->resting.state_count_max <= inner->search.state_count_max / 10);
            with++;
        }
    }
    TEST_ASSERT_TRUE(with > 0 && with < 40);
}

static void test_init_wants_pointers(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_init(NULL, &config, &terrain, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_init(&planner, NULL, &terrain, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_init(&planner, &config, NULL, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_init(&planner, &config, &terrain, NULL, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_init(&planner, &config, &terrain, block, sizeof block, NULL));
}

static void test_init_wants_an_aligned_block(void)
{
    const char *field = "";

    for (size_t off = 1; off < 8; off++) {
        TEST_ASSERT_EQUAL_INT(JP_ERR_ALIGNMENT, jp_planner_init(&planner, &config, &terrain, (uint8_t *)block + off,
                                                                sizeof block - 8, &field));
    }
}

static void expect_bad(const char *name)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, init(sizeof block, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
    setUp();
}

static void test_init_names_the_field(void)
{
    config.lattice = NULL;
    expect_bad("lattice");
    terrain.config.resolution++;
    expect_bad("lattice");
    config.cost = JP_COST_KINDS;
    expect_bad("cost");
    config.cost = (enum jp_cost_kind) - 1;
    expect_bad("cost");
    terrain.config.width = 0;
    expect_bad("terrain");
}

static void test_schedules_that_do_not_descend(void)
{
    static const uint16_t schedules[][JP_EPSILON_LEVELS] = {
        {0, 0, 0, 0},       {255, 0, 0, 0},     {4097, 0, 0, 0},      {512, 512, 0, 0},
        {512, 513, 256, 0}, {768, 512, 255, 0}, {768, 512, 256, 256}, {1024, 768, 512, 1},
    };

    for (size_t i = 0; i < sizeof schedules / sizeof schedules[0]; i++) {
        memcpy(config.epsilon, schedules[i], sizeof schedules[i]);
        expect_bad("epsilon");
    }
}

static void test_schedules_that_do(void)
{
    static const uint16_t schedules[][JP_EPSILON_LEVELS] = {
        {256, 0, 0, 0}, {4096, 0, 0, 0}, {512, 0, 7, 0}, {1024, 768, 512, 256}, {259, 258, 257, 256}};

    for (size_t i = 0; i < sizeof schedules / sizeof schedules[0]; i++) {
        memcpy(config.epsilon, schedules[i], sizeof schedules[i]);
        start_planner(sizeof block);
        go(&west, &east);
        TEST_ASSERT_TRUE(finish() == JP_ANSWER_OPTIMAL || finish() == JP_ANSWER_WITHIN_BOUND);
        expect_drivable();
    }
}

/* Start and goal */

static void test_nothing_to_do_without_start_or_goal(void)
{
    start_planner(sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_work(&planner, 100));
    TEST_ASSERT_TRUE(jp_planner_is_idle(&planner));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(&planner, &east));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_work(&planner, 100));
    start_planner(sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &west));
    occupy(0, 0);
    raise(1, 1, 3);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_work(&planner, 100));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_plan(&planner)->answer);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(&planner, &east));
    expect_optimal();
}

static void test_starts_that_cannot_be(void)
{
    begin();
    expect_optimal();
    expect_start(JP_ERR_ARGUMENT, west.x, west.y, JP_HEADINGS);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_set_start(&planner, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_set_start(NULL, &west));
    expect_start(JP_ERR_OUTSIDE, -1, west.y, 0);
    expect_start(JP_ERR_OUTSIDE, west.x, HEIGHT, 0);
    expect_start(JP_ERR_OUTSIDE, INT16_MAX, INT16_MIN, 0);
    expect_start(JP_ERR_BLOCKED, 0, west.y, 0); /* a part of the robot would be off the map */
    TEST_ASSERT_TRUE(jp_planner_is_idle(&planner));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, jp_planner_work(&planner, 1));
    occupy(8, 7);
    expect_start(JP_ERR_BLOCKED, 8, 5, 4);
    expect_optimal();
    TEST_ASSERT_EQUAL_INT(west.x, jp_planner_plan(&planner)->start.x);
}

static void expect_goal(enum jp_status status, int16_t x, int16_t y, uint16_t headings)
{
    const struct jp_goal goal = {x, y, headings};

    TEST_ASSERT_EQUAL_INT(status, jp_planner_set_goal(&planner, &goal));
}

static void test_goals_that_cannot_be(void)
{
    begin();
    expect_optimal();
    expect_goal(JP_ERR_ARGUMENT, east.x, east.y, 0);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_set_goal(&planner, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_set_goal(NULL, &east));
    expect_goal(JP_ERR_OUTSIDE, WIDTH, east.y, 1);
    expect_goal(JP_ERR_OUTSIDE, east.x, -1, 1);
    expect_goal(JP_ERR_BLOCKED, 0, 0, JP_ANY_HEADING);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, jp_planner_work(&planner, 1));
    TEST_ASSERT_EQUAL_UINT32(1, jp_planner_statistics(&planner)->restarts);
    TEST_ASSERT_EQUAL_INT(east.x, jp_planner_plan(&planner)->end.x);
}

/* One heading that fits is enough. */
static void test_goal_where_some_headings_fit(void)
{
    unsigned fits = JP_HEADINGS;

    start_planner(sizeof block);
    for (int16_t x = 0; x < WIDTH; x++) {
        unsigned count = 0;
        for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
            const bool can = jp_lattice_can_stand(lattice, &terrain, x, 4, heading);
            expect_goal(can ? JP_OK : JP_ERR_BLOCKED, x, 4, (uint16_t)(1U << heading));
            count += can;
        }
        expect_goal(count > 0 ? JP_OK : JP_ERR_BLOCKED, x, 4, JP_ANY_HEADING);
        fits = count > 0 && count < fits ? count : fits;
    }
    TEST_ASSERT_TRUE(fits < JP_HEADINGS);
}

/* Plans */

static void test_straight_on(void)
{
    begin();
    expect_optimal();
    const struct jp_plan *plan = jp_planner_plan(&planner);
    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, plan->cost);
    TEST_ASSERT_EQUAL_UINT32(STEPS, plan->step_count);
    TEST_ASSERT_EQUAL_INT(east.x, plan->end.x);
    TEST_ASSERT_EQUAL_INT(east.y, plan->end.y);
    TEST_ASSERT_EQUAL_INT(0, plan->end.heading);
}

static void test_step_out_of_range(void)
{
    struct jp_lattice_pose pose = west;

    begin();
    TEST_ASSERT_NULL(jp_planner_step(&planner, 0, &pose));
    expect_optimal();
    TEST_ASSERT_NULL(jp_planner_step(&planner, STEPS, &pose));
    TEST_ASSERT_NULL(jp_planner_step(&planner, UINT16_MAX, &pose));
    TEST_ASSERT_EQUAL_INT(west.x, pose.x);
    TEST_ASSERT_EQUAL_INT(west.heading, pose.heading);
    TEST_ASSERT_NOT_NULL(jp_planner_step(&planner, 5, &pose));
}

static void test_start_at_the_goal(void)
{
    const struct jp_goal here = {west.x, west.y, JP_ANY_HEADING};

    start_planner(sizeof block);
    go(&west, &here);
    expect_optimal();
    TEST_ASSERT_EQUAL_UINT32(0, jp_planner_plan(&planner)->cost);
    TEST_ASSERT_EQUAL_UINT32(0, jp_planner_plan(&planner)->step_count);
}

static void test_turn_at_the_goal(void)
{
    const struct jp_goal here = {west.x, west.y, 1U << 3};

    start_planner(sizeof block);
    go(&west, &here);
    expect_optimal();
    TEST_ASSERT_EQUAL_INT(3, jp_planner_plan(&planner)->end.heading);
    TEST_ASSERT_TRUE(jp_planner_plan(&planner)->cost > 0);
}

static void test_any_heading_costs_what_the_cheapest_does(void)
{
    static const uint16_t headings[] = {1U << 15, 1U << 1, JP_ANY_HEADING};
    jp_cost costs[3];

    for (int i = 0; i < 3; i++) {
        const struct jp_goal goal = {east.x, east.y, headings[i]};
        start_planner(sizeof block);
        go(&west, &goal);
        expect_optimal();
        costs[i] = jp_planner_plan(&planner)->cost;
        TEST_ASSERT_TRUE((headings[i] >> jp_planner_plan(&planner)->end.heading & 1) != 0);
    }
    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, costs[2]);
    TEST_ASSERT_TRUE(costs[0] > costs[2] && costs[1] > costs[2]);
}

static void test_each_kind_of_cost(void)
{
    for (int kind = 0; kind < JP_COST_KINDS; kind++) {
        config.cost = (enum jp_cost_kind)kind;
        begin();
        expect_optimal();
    }
    TEST_ASSERT_TRUE(jp_planner_plan(&planner)->cost >= 1595 && jp_planner_plan(&planner)->cost <= 1640); /* mm */
}

static void test_climbs_no_higher_than_it_must(void)
{
    begin();
    raise(8, 4, 50);
    expect_as_if_new();
    const jp_cost over = 2 * (jp_cost)AXIS_COST;
    TEST_ASSERT_TRUE(jp_planner_plan(&planner)->cost > STEPS * AXIS_COST);
    TEST_ASSERT_TRUE(jp_planner_plan(&planner)->cost < STEPS * AXIS_COST + 50 * over);
}

static void test_level_map_needs_no_elevations(void)
{
    map.has_elevation = false;
    make_level_map(&map);
    begin();
    expect_optimal();
    TEST_ASSERT_EQUAL_UINT32(STEPS * AXIS_COST, jp_planner_plan(&planner)->cost);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_planner_set_elevation(&planner, 3, 3, 1));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, jp_planner_work(&planner, 1));
}

/* Slices */

static void test_no_budget_no_work(void)
{
    begin();
    for (int i = 0; i < 100; i++) {
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_work(&planner, 0));
    }
    TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
    TEST_ASSERT_EQUAL_UINT32(0, jp_planner_statistics(&planner)->expansions);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_plan(&planner)->answer);
}

static void test_slices_keep_to_their_budget(void)
{
    begin();
    while (!jp_planner_is_idle(&planner)) {
        const uint32_t before = jp_planner_statistics(&planner)->expansions;
        (void)jp_planner_work(&planner, 3);
        TEST_ASSERT_TRUE(jp_planner_statistics(&planner)->expansions <= before + 3);
    }
    expect_optimal();
}

static void test_any_budget_is_used(void)
{
    static const unsigned budgets[] = {1U << 27, 1U << 29, UINT_MAX};

    config.epsilon[0] = JP_EPSILON_ONE; /* begins with the energy field */
    config.epsilon[1] = 0;
    for (size_t i = 0; i < sizeof budgets / sizeof *budgets; i++) {
        begin();
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, jp_planner_work(&planner, budgets[i]));
        TEST_ASSERT_TRUE(jp_planner_is_idle(&planner));
    }
}

static void test_slices_change_nothing(void)
{
    begin();
    raise(7, 4, 20);
    occupy(8, 2);
    (void)finish();
    const uint32_t expansions = jp_planner_statistics(&planner)->expansions;
    const struct jp_plan plan = *jp_planner_plan(&planner);

    for (unsigned slice = 2; slice < 4000; slice *= 7) {
        begin();
        while (!jp_planner_is_idle(&planner)) {
            (void)jp_planner_work(&planner, slice);
        }
        TEST_ASSERT_EQUAL_UINT32(expansions, jp_planner_statistics(&planner)->expansions);
        TEST_ASSERT_EQUAL_UINT32(plan.cost, jp_planner_plan(&planner)->cost);
        TEST_ASSERT_EQUAL_UINT32(plan.step_count, jp_planner_plan(&planner)->step_count);
    }
}

/* What the search holds */

struct held {
    uint32_t states;
    uint32_t open;
    bool has_start;
    bool has_goal;
};

static struct held held(void)
{
    struct held found = {0};
    struct jp_lattice_pose pose;
    uint32_t slot = 0;
    uint32_t before = 0;
    bool is_open = false;

    while (jp_planner_next_state(&planner, &slot, &pose, &is_open)) {
        TEST_ASSERT_TRUE(slot > before);
        TEST_ASSERT_TRUE(pose.x >= 0 && pose.x < WIDTH && pose.y >= 0 && pose.y < HEIGHT && pose.heading < JP_HEADINGS);
        before = slot;
        found.states++;
        found.open += is_open;
        found.has_start |= pose.x == west.x && pose.y == west.y && pose.heading == west.heading;
        found.has_goal |= pose.x == east.x && pose.y == east.y && pose.heading == 0;
    }
    TEST_ASSERT_FALSE(jp_planner_next_state(&planner, &slot, &pose, &is_open));
    return found;
}

/* From the goal to the robot, more and more. */
static void test_each_state_of_the_search_is_told(void)
{
    uint32_t most = 0;

    start_planner(sizeof block);
    TEST_ASSERT_EQUAL_UINT32(0, held().states);
    go(&west, &east);
    TEST_ASSERT_EQUAL_UINT32(0, held().states);
    while (!jp_planner_is_idle(&planner)) {
        (void)jp_planner_work(&planner, 1);
        const struct held found = held();
        TEST_ASSERT_TRUE(found.states == 0 || found.states == jp_planner_statistics(&planner)->states);
        TEST_ASSERT_TRUE(found.states == 0 || found.has_goal);
        TEST_ASSERT_TRUE(found.open <= found.states);
        most = found.states > most ? found.states : most;
    }
    const struct held found = held();
    TEST_ASSERT_EQUAL_UINT32(most, found.states);
    TEST_ASSERT_TRUE(found.has_start && found.open > 0 && found.open < found.states);
}
