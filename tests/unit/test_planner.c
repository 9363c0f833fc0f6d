/* The planner on a map of 16 × 9 cells: its statuses, answers and phases, its states and its queue. */
#include <joulepath/planner.h>
#include <stddef.h>
#include <string.h>

#include "level_map.h"
#include "src/planner_states.h"
#include "unity.h"

enum {
    WIDTH = 16,
    HEIGHT = 9, /* the robot, 7 cells across, can be in three rows of them */
    HEIGHT_MAX = 16,
    BLOCK_BYTES = 8 * 1024,
    STEPS = 8,          /* from west to east */
    AXIS_COST = 224,    /* of a level step along an axis, physical */
    BUDGET_MAX = 20000, /* expansions after which a planner hangs */
    SPARE = 8
};

extern const struct jp_lattice jp_lattice_zhang2018;

static const struct jp_lattice *const lattice = &jp_lattice_zhang2018;
static const struct jp_pose west = {4, 4, 0};
static const struct jp_goal east = {12, 4, 1};

static struct jp_terrain_config map;
static struct jp_planner_config config;
static struct jp_planner planner;
static uint64_t block[BLOCK_BYTES / sizeof(uint64_t)];

void setUp(void)
{
    map = (struct jp_terrain_config){
        .width = WIDTH, .height = HEIGHT, .resolution = lattice->resolution, .has_elevation = true};
    config = (struct jp_planner_config){
        .lattice = lattice, .cost = JP_COST_PHYSICAL, .epsilon = {JP_EPSILON(2), JP_EPSILON_ONE}};
    memset(block, 0x5A, sizeof block);
    make_level_map(&map);
}

/* With more states than the block holds. */
static void make_large_map(void)
{
    map.height = HEIGHT_MAX;
    make_level_map(&map);
}

void tearDown(void)
{
}

static enum jp_status init(size_t size, const char **field)
{
    return jp_planner_init(&planner, &config, &terrain, block, size, field);
}

static void start_planner(size_t size)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, init(size, &field));
    TEST_ASSERT_NULL(field);
}

static void go(const struct jp_pose *from, const struct jp_goal *to)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, from));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(&planner, to));
}

/* With all of the block, from west to east. */
static void begin(void)
{
    start_planner(sizeof block);
    go(&west, &east);
}

static enum jp_answer finish(void)
{
    for (int i = 0; !jp_planner_is_idle(&planner); i++) {
        TEST_ASSERT_TRUE(i < BUDGET_MAX);
        (void)jp_planner_work(&planner, 1);
    }
    return jp_planner_work(&planner, 1);
}

static void occupy(int32_t x, int32_t y)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_cell(&planner, x, y, JP_CELL_OCCUPIED));
}

static void release(int32_t x, int32_t y)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_cell(&planner, x, y, JP_CELL_FREE));
}

static void raise(int32_t x, int32_t y, jp_elevation elevation)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_elevation(&planner, x, y, elevation));
}

/* The plan's steps lead from its start to its end over free cells, at its cost. */
static void expect_drivable(void)
{
    const struct jp_plan *plan = jp_planner_plan(&planner);
    struct jp_pose pose = plan->start;
    jp_cost cost = 0;

    for (unsigned i = 0; i < plan->step_count; i++) {
        const struct jp_pose from = pose;
        const struct jp_primitive *primitive = jp_planner_step(&planner, i, &pose);
        TEST_ASSERT_NOT_NULL(primitive);
        TEST_ASSERT_EQUAL_INT(from.heading, primitive->start);
        const jp_cost step = jp_lattice_cost(lattice, config.cost, &terrain, primitive, from.x, from.y);
        TEST_ASSERT_TRUE(step < JP_COST_MAX);
        cost += step;
    }
    TEST_ASSERT_EQUAL_UINT32(plan->cost, cost);
    TEST_ASSERT_EQUAL_INT(plan->end.x, pose.x);
    TEST_ASSERT_EQUAL_INT(plan->end.y, pose.y);
    TEST_ASSERT_EQUAL_INT(plan->end.heading, pose.heading);
}

static void expect_optimal(void)
{
    const struct jp_plan *plan = jp_planner_plan(&planner);

    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, finish());
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, plan->answer);
    TEST_ASSERT_EQUAL_UINT32(JP_EPSILON_ONE, plan->bound);
    TEST_ASSERT_EQUAL_UINT32(0, plan->cost_left);
    expect_drivable();
}

/* The lattice with level driving twice as dear. */
static struct jp_lattice dearer_driving(void)
{
    struct jp_lattice dearer = *lattice;

    for (unsigned move = 0; move < (unsigned)JP_MOVE_KINDS; move++) {
        dearer.move_costs[JP_COST_PHYSICAL][move].climb.constant *= 2;
    }
    dearer.version = 3;
    return dearer;
}

/* What the planner has found after changes is what one finds that begins anew. */
static void expect_as_if_new(void)
{
    const enum jp_answer answer = finish();
    const jp_cost cost = jp_planner_plan(&planner)->cost;

    if (answer != JP_ANSWER_UNREACHABLE) {
        expect_optimal();
    }
    jp_planner_restart(&planner);
    TEST_ASSERT_EQUAL_INT(answer, finish());
    TEST_ASSERT_EQUAL_UINT32(cost, jp_planner_plan(&planner)->cost);
}

/* Memory and configuration */

static void test_smallest_block(void)
{
    const char *field = "";
    const size_t size = jp_planner_size_min(&map);

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
    TEST_ASSERT_EQUAL_UINT32(0, jp_planner_size_min(&map));
    map.width = JP_TERRAIN_SIDE_MAX + 1;
    TEST_ASSERT_EQUAL_UINT32(0, jp_planner_size_min(&map));
    map.width = JP_TERRAIN_SIDE_MAX;
    map.height = JP_TERRAIN_SIDE_MAX;
    TEST_ASSERT_TRUE(jp_planner_size_min(&map) > 0);
}

/* Nothing is written outside the block. */
static void test_block_is_all_that_is_used(void)
{
    const uint8_t *bytes = (const uint8_t *)block;

    for (size_t size = jp_planner_size_min(&map); size + SPARE < sizeof block; size += 509) {
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

/* Record, hash and queue, for the blocks of the bench. The layout touches no memory. */
static void test_a_state_takes_at_most_20_bytes(void)
{
    static const uint32_t kibibytes[] = {64, 128, 256, 512, 8192};
    const struct jp_planner_counts *statistics = &planner.statistics;

    for (size_t i = 0; i < sizeof kibibytes / sizeof kibibytes[0]; i++) {
        jp_planner_states_init(&planner, block, kibibytes[i] * 1024);
        TEST_ASSERT_TRUE(statistics->search_bytes <= kibibytes[i] * 1024);
        TEST_ASSERT_TRUE(statistics->search_bytes >= kibibytes[i] * 1024 * 99 / 100);
        TEST_ASSERT_TRUE(statistics->search_bytes <= 20 * statistics->states_max);
    }
    jp_planner_states_init(&planner, block, (size_t)1 << 30);
    TEST_ASSERT_TRUE(statistics->states_max <= JP_PLANNER_STATES_MAX);
    TEST_ASSERT_EQUAL_UINT32(16, sizeof(struct jp_planner_state));
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

static void expect_start(enum jp_status status, int16_t x, int16_t y, uint8_t heading)
{
    const struct jp_pose pose = {x, y, heading};

    TEST_ASSERT_EQUAL_INT(status, jp_planner_set_start(&planner, &pose));
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
    struct jp_pose pose = west;

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

/* Moving starts and new goals */

static void test_driving_on_needs_no_expansions(void)
{
    struct jp_pose pose = west;

    begin();
    expect_optimal();
    const uint32_t expansions = jp_planner_statistics(&planner)->expansions;
    for (unsigned left = STEPS - 1; left > 0; left--) {
        TEST_ASSERT_NOT_NULL(jp_planner_step(&planner, 0, &pose));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &pose));
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_work(&planner, 0));
        expect_optimal();
        TEST_ASSERT_EQUAL_UINT32(left * AXIS_COST, jp_planner_plan(&planner)->cost);
    }
    TEST_ASSERT_EQUAL_UINT32(expansions, jp_planner_statistics(&planner)->expansions);
    TEST_ASSERT_EQUAL_UINT32(1, jp_planner_statistics(&planner)->restarts);
}

static void test_start_that_was_not_on_the_route(void)
{
    static const struct jp_pose starts[] = {{5, 5, 0}, {4, 3, 2}, {11, 3, 15}, {12, 4, 1}};

    begin();
    expect_optimal();
    for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &starts[i]));
        expect_as_if_new();
    }
}

static void test_start_moves_during_the_search(void)
{
    const struct jp_pose next = {5, 5, 0};

    for (int slices = 0; slices < 120; slices += 3) {
        begin();
        for (int i = 0; i < slices; i++) {
            (void)jp_planner_work(&planner, 1);
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &next));
        expect_as_if_new();
    }
}

static void wall(bool built)
{
    for (int32_t y = 0; y < map.height; y++) {
        if (built) {
            occupy(7, y);
        } else {
            release(7, y);
        }
    }
}

/* The field, rooted on one side of the wall, says nothing of the other. */
static void test_start_moves_across_a_wall(void)
{
    static const struct jp_pose beyond = {12, 4, 4};
    static const struct jp_goal goal = {11, 5, 1U << 4};

    for (unsigned level = 0; level < 2; level++) {
        config.epsilon[0] = level == 0 ? JP_EPSILON(2) : JP_EPSILON_ONE;
        config.epsilon[1] = 0;
        for (int slices = 0; slices < 40; slices++) {
            make_level_map(&map);
            start_planner(sizeof block);
            wall(true);
            go(&(const struct jp_pose){3, 4, 0}, &goal);
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
    TEST_ASSERT_EQUAL_UINT32(1, jp_planner_statistics(&planner)->restarts);
}

/* In the guide, the field, the search, the repair and the sorting. */
static void test_change_in_every_phase(void)
{
    bool seen[8] = {false};
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
        phases += !seen[planner.phase];
        seen[planner.phase] = true;
        occupy(8, slices % 3);
        raise(6, 4, (jp_elevation)(slices % 40));
        expect_as_if_new();
    }
    TEST_ASSERT_TRUE(phases >= 5);
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
            start_planner(jp_planner_size_min(&map));
            go(&(const struct jp_pose){3, 3, 4}, &goal);
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
        start_planner(jp_planner_size_min(&map));
        go(&(const struct jp_pose){4, 4, 12}, &goal);
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
    start_planner(jp_planner_size_min(&map));
    go(&(const struct jp_pose){4, 4, 12}, &goal);
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
    planner.route_max = 4;
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_PARTIAL, finish());
    const struct jp_plan *plan = jp_planner_plan(&planner);
    TEST_ASSERT_EQUAL_UINT32(4, plan->step_count);
    TEST_ASSERT_EQUAL_UINT32(4 * AXIS_COST, plan->cost);
    TEST_ASSERT_EQUAL_UINT32((STEPS - 4) * AXIS_COST, plan->cost_left);
    TEST_ASSERT_EQUAL_UINT32(0, plan->bound);
    TEST_ASSERT_EQUAL_INT(west.x + 4, plan->end.x);
    expect_drivable();
}

/* As the robot drives, the end of the route comes into its memory. */
static void test_route_that_was_cut_goes_on(void)
{
    const struct jp_pose nearer = {west.x + STEPS - 3, west.y, west.heading};

    begin();
    planner.route_max = 4;
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_PARTIAL, finish());
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &nearer));
    expect_optimal();
    TEST_ASSERT_EQUAL_UINT32(3 * AXIS_COST, jp_planner_plan(&planner)->cost);
}

/* Not even the first expansion fits: the answer stays open, and nothing more is tried. */
static void test_block_too_small_for_any_expansion(void)
{
    begin();
    planner.neighbours_max = UINT16_MAX;
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, finish());
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_plan(&planner)->answer);
    TEST_ASSERT_EQUAL_UINT32(0, jp_planner_statistics(&planner)->expansions);
}

/* In the smallest block, up to where the search goes on from the robot instead of the goal. */
static void search_from_the_robot(const struct jp_goal *goal)
{
    make_large_map();
    start_planner(jp_planner_size_min(&map));
    go(&(const struct jp_pose){4, 4, 12}, goal);
    while (!planner.forward) {
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
    TEST_ASSERT_FALSE(planner.forward);
    expect_honest(finish(), &goal);
    TEST_ASSERT_EQUAL_INT(5, jp_planner_plan(&planner)->start.x);
}

/* Of a route from the robot the far end is left out, also where the search has arrived. */
static void test_route_from_the_robot_is_cut(void)
{
    make_large_map();
    for (int16_t x = 4; x <= 12; x++) {
        for (unsigned heading = 0; heading < JP_HEADINGS; heading += 3) {
            const struct jp_goal goal = {x, 12, (uint16_t)(1U << heading)};
            start_planner(jp_planner_size_min(&map));
            planner.route_max = 2;
            go(&(const struct jp_pose){3, 3, 4}, &goal);
            TEST_ASSERT_EQUAL_INT(JP_ANSWER_PARTIAL, finish());
            TEST_ASSERT_TRUE(jp_planner_plan(&planner)->step_count <= 2);
            expect_honest(JP_ANSWER_PARTIAL, &goal);
        }
    }
}

/* Occupies a cell so that the planner cannot know: as if its memory had been damaged. */
static void occupy_secretly(int32_t x, int32_t y)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, JP_CELL_OCCUPIED));
    planner.terrain_version = terrain.version;
}

/* States from which no route leads on are not believed: the search begins anew, with the map as it is. */
static void test_search_that_leads_nowhere_begins_anew(void)
{
    begin();
    expect_optimal();
    expect_start(JP_OK, west.x + 1, west.y, 0);
    occupy_secretly(west.x + 1, west.y);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_UNREACHABLE, finish());
    TEST_ASSERT_EQUAL_UINT32(2, jp_planner_statistics(&planner)->restarts);
}

static void test_search_from_the_robot_that_leads_nowhere(void)
{
    const struct jp_goal goal = {11, 11, 1U << 10};

    search_from_the_robot(&goal);
    while (!planner.is_searching || planner.statistics.states < planner.statistics.states_max / 2) {
        TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
        (void)jp_planner_work(&planner, 1);
    }
    occupy_secretly(planner.start.x, planner.start.y);
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
}

/* The states and their queue */

static void test_costs_saturate(void)
{
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_cost_add(JP_COST_MAX, JP_COST_MAX));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_cost_add(JP_COST_MAX - 1, 2));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_cost_add(JP_COST_MAX, 0));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX - 1, jp_cost_add(JP_COST_MAX - 2, 1));
}

/* Ids that differ little, by a factor of the table's size, and by much. */
static void test_table_finds_all_that_it_holds(void)
{
    static const uint32_t strides[] = {1, 16, 4096, 65537};

    for (size_t i = 0; i < sizeof strides / sizeof strides[0]; i++) {
        start_planner(sizeof block);
        const uint32_t stride = i == 3 ? planner.slot_count : strides[i];
        const uint32_t count = planner.statistics.states_max;
        for (uint32_t k = 0; k < count; k++) {
            const uint32_t id = k * stride & 0xFFFFFF;
            TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_states_find(&planner, id));
            const uint32_t slot = jp_planner_states_add(&planner, id);
            TEST_ASSERT_TRUE(slot < planner.slot_count);
            TEST_ASSERT_EQUAL_UINT32(slot, jp_planner_states_add(&planner, id));
            TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, (uint32_t)planner.states[slot].g);
            TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, (uint32_t)planner.states[slot].rhs);
        }
        for (uint32_t k = 0; k < count; k++) {
            const uint32_t slot = jp_planner_states_find(&planner, k * stride & 0xFFFFFF);
            TEST_ASSERT_TRUE(slot != NO_SLOT);
            TEST_ASSERT_EQUAL_UINT32(k * stride & 0xFFFFFF, (uint32_t)planner.states[slot].id);
        }
    }
}

static void test_table_that_is_full(void)
{
    start_planner(sizeof block);
    const uint32_t count = planner.statistics.states_max;
    for (uint32_t id = 0; id < count; id++) {
        TEST_ASSERT_TRUE(jp_planner_states_add(&planner, id) != NO_SLOT);
        TEST_ASSERT_EQUAL_UINT32(id + 1, planner.statistics.states);
    }
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_states_add(&planner, count));
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_states_find(&planner, count));
    TEST_ASSERT_TRUE(jp_planner_states_add(&planner, count - 1) != NO_SLOT);
    jp_planner_states_clear(&planner);
    TEST_ASSERT_EQUAL_UINT32(0, planner.statistics.states);
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_states_find(&planner, 0));
    TEST_ASSERT_TRUE(jp_planner_states_add(&planner, count) != NO_SLOT);
}

static uint32_t key_of(uint32_t i)
{
    return i * 7919 % 1000;
}

static void test_queue_gives_the_lowest_first(void)
{
    enum { COUNT = 100 };
    uint32_t last = 0;

    start_planner(sizeof block);
    jp_planner_queue_restart(&planner, 1000);
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_queue_top(&planner));
    for (uint32_t i = 0; i < COUNT; i++) {
        jp_planner_queue_put(&planner, jp_planner_states_add(&planner, i), key_of(i));
    }
    for (uint32_t i = 0; i < COUNT; i++) {
        const uint32_t slot = jp_planner_queue_top(&planner);
        TEST_ASSERT_TRUE(slot != NO_SLOT);
        const uint32_t key = key_of((uint32_t)planner.states[slot].id);
        TEST_ASSERT_TRUE(jp_planner_queue_lowest_key(&planner) >= last);
        TEST_ASSERT_TRUE(jp_planner_queue_lowest_key(&planner) <= key);
        TEST_ASSERT_TRUE(key >> planner.bucket_shift == jp_planner_queue_lowest_key(&planner) >> planner.bucket_shift);
        last = jp_planner_queue_lowest_key(&planner);
        jp_planner_queue_remove(&planner, slot);
        jp_planner_queue_remove(&planner, slot); /* of one that is out: nothing */
    }
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_queue_top(&planner));
}

static void test_queue_moves_a_state_to_its_new_key(void)
{
    start_planner(sizeof block);
    jp_planner_queue_restart(&planner, 60);
    const uint32_t a = jp_planner_states_add(&planner, 1);
    const uint32_t b = jp_planner_states_add(&planner, 2);
    const uint32_t c = jp_planner_states_add(&planner, 3);
    jp_planner_queue_put(&planner, a, 30);
    jp_planner_queue_put(&planner, b, 30);
    jp_planner_queue_put(&planner, c, 30);
    jp_planner_queue_put(&planner, b, 30);
    jp_planner_queue_put(&planner, b, 10); /* out of the middle of a list */
    TEST_ASSERT_EQUAL_UINT32(b, jp_planner_queue_top(&planner));
    TEST_ASSERT_EQUAL_UINT32(10, jp_planner_queue_lowest_key(&planner));
    jp_planner_queue_put(&planner, b, 50);
    jp_planner_queue_remove(&planner, a);
    TEST_ASSERT_EQUAL_UINT32(c, jp_planner_queue_top(&planner));
    jp_planner_queue_remove(&planner, c);
    TEST_ASSERT_EQUAL_UINT32(b, jp_planner_queue_top(&planner));
    jp_planner_queue_put(&planner, a, 0);
    TEST_ASSERT_EQUAL_UINT32(a, jp_planner_queue_top(&planner));
}

static void test_queue_tells_when_its_range_ends(void)
{
    start_planner(sizeof block);
    jp_planner_queue_restart(&planner, 1000);
    const uint32_t near = jp_planner_states_add(&planner, 1);
    const uint32_t far = jp_planner_states_add(&planner, 2);
    jp_planner_queue_put(&planner, far, UINT32_MAX);
    jp_planner_queue_put(&planner, near, 1000);
    TEST_ASSERT_EQUAL_UINT32(near, jp_planner_queue_top(&planner));
    TEST_ASSERT_FALSE(jp_planner_queue_is_beyond_range(&planner));
    jp_planner_queue_remove(&planner, near);
    TEST_ASSERT_EQUAL_UINT32(far, jp_planner_queue_top(&planner));
    TEST_ASSERT_TRUE(jp_planner_queue_is_beyond_range(&planner));
    jp_planner_queue_restart(&planner, 2 * JP_COST_MAX);
    TEST_ASSERT_TRUE(2 * JP_COST_MAX >> planner.bucket_shift < planner.bucket_count - 1);
    TEST_ASSERT_TRUE(2 * JP_COST_MAX >> (planner.bucket_shift - 1) >= planner.bucket_count - 1);
}

/* With the wall all states are searched, whose keys go far beyond what was expected: the range is widened. */
static void test_range_widens_during_a_search(void)
{
    begin();
    expect_optimal();
    const uint8_t shift = planner.bucket_shift;
    wall(true);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_UNREACHABLE, finish());
    TEST_ASSERT_TRUE(planner.bucket_shift > shift);
    wall(false);
    expect_optimal();
}

static void test_other_costs_of_the_lattice(void)
{
    const struct jp_lattice dearer = dearer_driving();
    const struct jp_goal north = {12, 4, 1U << 4};
    const struct jp_plan *plan = jp_planner_plan(&planner);

    start_planner(sizeof block);
    go(&west, &north);
    expect_optimal();
    const jp_cost before = plan->cost;
    TEST_ASSERT_EQUAL_UINT32(0, plan->parameter_version);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_lattice(&planner, &dearer));
    TEST_ASSERT_EQUAL_UINT32(before, plan->cost); /* the plan stands, and says what it was made of */
    TEST_ASSERT_EQUAL_UINT32(0, plan->parameter_version);
    TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
    const uint32_t earlier = jp_planner_statistics(&planner)->expansions;
    (void)finish();
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, plan->answer);
    TEST_ASSERT_EQUAL_UINT32(3, plan->parameter_version);
    const uint32_t expansions = jp_planner_statistics(&planner)->expansions - earlier;
    const jp_cost after = plan->cost;
    TEST_ASSERT_TRUE(after > before);

    config.lattice = &dearer;
    start_planner(sizeof block);
    go(&west, &north);
    (void)finish();
    TEST_ASSERT_EQUAL_UINT32(after, plan->cost);
    TEST_ASSERT_EQUAL_UINT32(3, plan->parameter_version);
    TEST_ASSERT_EQUAL_UINT32(expansions, jp_planner_statistics(&planner)->expansions);
}

static void test_lattices_that_are_not_taken(void)
{
    struct jp_lattice other = *lattice;

    begin();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_set_lattice(NULL, lattice));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_set_lattice(&planner, NULL));
    other.moves++;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_planner_set_lattice(&planner, &other));
    expect_optimal();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_smallest_block);
    RUN_TEST(test_no_block_for_a_map_out_of_range);
    RUN_TEST(test_block_is_all_that_is_used);
    RUN_TEST(test_statistics_share_out_the_block);
    RUN_TEST(test_a_state_takes_at_most_20_bytes);
    RUN_TEST(test_init_wants_pointers);
    RUN_TEST(test_init_wants_an_aligned_block);
    RUN_TEST(test_init_names_the_field);
    RUN_TEST(test_schedules_that_do_not_descend);
    RUN_TEST(test_schedules_that_do);
    RUN_TEST(test_nothing_to_do_without_start_or_goal);
    RUN_TEST(test_starts_that_cannot_be);
    RUN_TEST(test_goals_that_cannot_be);
    RUN_TEST(test_goal_where_some_headings_fit);
    RUN_TEST(test_straight_on);
    RUN_TEST(test_step_out_of_range);
    RUN_TEST(test_start_at_the_goal);
    RUN_TEST(test_turn_at_the_goal);
    RUN_TEST(test_any_heading_costs_what_the_cheapest_does);
    RUN_TEST(test_each_kind_of_cost);
    RUN_TEST(test_climbs_no_higher_than_it_must);
    RUN_TEST(test_level_map_needs_no_elevations);
    RUN_TEST(test_no_budget_no_work);
    RUN_TEST(test_slices_keep_to_their_budget);
    RUN_TEST(test_slices_change_nothing);
    RUN_TEST(test_driving_on_needs_no_expansions);
    RUN_TEST(test_start_that_was_not_on_the_route);
    RUN_TEST(test_start_moves_during_the_search);
    RUN_TEST(test_start_moves_across_a_wall);
    RUN_TEST(test_new_goal_begins_anew);
    RUN_TEST(test_cells_that_cannot_be_changed);
    RUN_TEST(test_changes_that_change_nothing);
    RUN_TEST(test_unknown_is_as_the_map_says);
    RUN_TEST(test_obstacle_comes_and_goes);
    RUN_TEST(test_change_in_every_phase);
    RUN_TEST(test_more_changes_than_are_repaired_together);
    RUN_TEST(test_no_way_through_a_wall);
    RUN_TEST(test_robot_or_goal_is_walled_in);
    RUN_TEST(test_too_steep_is_no_way);
    RUN_TEST(test_changes_behind_its_back);
    RUN_TEST(test_smallest_block_gives_an_honest_answer);
    RUN_TEST(test_partial_beside_the_goal);
    RUN_TEST(test_partial_plan_is_found_anew_after_a_change);
    RUN_TEST(test_route_is_cut_where_its_memory_ends);
    RUN_TEST(test_route_that_was_cut_goes_on);
    RUN_TEST(test_block_too_small_for_any_expansion);
    RUN_TEST(test_start_moves_before_the_search_from_the_robot);
    RUN_TEST(test_route_from_the_robot_is_cut);
    RUN_TEST(test_search_that_leads_nowhere_begins_anew);
    RUN_TEST(test_search_from_the_robot_that_leads_nowhere);
    RUN_TEST(test_nothing_is_proved_downhill);
    RUN_TEST(test_costs_saturate);
    RUN_TEST(test_table_finds_all_that_it_holds);
    RUN_TEST(test_table_that_is_full);
    RUN_TEST(test_queue_gives_the_lowest_first);
    RUN_TEST(test_queue_moves_a_state_to_its_new_key);
    RUN_TEST(test_queue_tells_when_its_range_ends);
    RUN_TEST(test_range_widens_during_a_search);
    RUN_TEST(test_other_costs_of_the_lattice);
    RUN_TEST(test_lattices_that_are_not_taken);
    return UNITY_END();
}
