/* A planner whose states do not fit: the turn field takes the place of some of them, in blocks of more than the RAM of
 * the smallest core. */
#include "tests/support/planner_rig.h"

enum {
    SHARED_BLOCK_MIN = 12000,
    SHARED_BLOCK_MAX = 65536,
    SHARED_BLOCK_STEP = 2048,
    CHANGE_TIMES = 6,
};

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

static uint64_t large_block[8192];

static const struct jp_goal behind_the_wall = {26, 5, 1};

/* A map of 32 × 32 cells, and in its midst a wall to go round. */
static void build_large_map(void)
{
    map = (struct jp_terrain_config){.width = 32, .height = 32, .resolution = lattice->resolution};
    make_level_map(&map);
    for (int32_t y = 0; y < 20; y++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, 15, y, JP_CELL_OCCUPIED));
    }
}

static enum jp_answer finish_in_slices(struct jp_planner *of)
{
    while (!jp_planner_is_idle(of)) {
        (void)jp_planner_work(of, STEPS);
    }
    return jp_planner_work(of, 1);
}

static void start_in(struct jp_planner *of, void *memory, size_t size, const struct jp_lattice_pose *from)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_init(of, &config, &terrain, memory, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(of, from));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(of, &behind_the_wall));
}

/* In the next larger block in which it is needed; false: in none. */
static bool plan_with_shared_states(size_t *size)
{
    for (*size += SHARED_BLOCK_STEP; *size <= (size_t)SHARED_BLOCK_MAX; *size += SHARED_BLOCK_STEP) {
        build_large_map();
        start_in(&planner, large_block, *size, &west);
        (void)finish_in_slices(&planner);
        if (planner.internal.has_turn_field) {
            return true;
        }
    }
    return false;
}

/* What is claimed of the plan holds against one that is proved. */
static void expect_honest(void)
{
    static struct jp_planner other;
    static uint64_t other_block[32768]; /* with room for all states */
    const struct jp_plan *best = jp_planner_plan(&other);
    const struct jp_plan *plan = jp_planner_plan(&planner);
    const enum jp_answer answer = finish_in_slices(&planner);

    start_in(&other, other_block, sizeof other_block, &planner.internal.start);
    const enum jp_answer truth = finish_in_slices(&other);
    if (answer == JP_ANSWER_UNREACHABLE) {
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_UNREACHABLE, truth);
        return;
    }
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, truth);
    expect_drivable();
    if (answer != JP_ANSWER_PARTIAL) {
        TEST_ASSERT_TRUE(plan->cost >= best->cost);
        TEST_ASSERT_TRUE((uint64_t)plan->cost * JP_EPSILON_ONE <= (uint64_t)plan->bound * best->cost);
    }
}

static void test_turn_field_takes_the_place_of_some_states(void)
{
    size_t size = SHARED_BLOCK_MIN;
    unsigned proved = 0;
    unsigned planned = 0;

    for (; plan_with_shared_states(&size); planned++) {
        proved += jp_planner_plan(&planner)->answer == JP_ANSWER_OPTIMAL;
        expect_honest();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(&planner, &behind_the_wall));
        TEST_ASSERT_FALSE(planner.internal.has_turn_field);
        expect_honest();
    }
    TEST_ASSERT_TRUE(planned > 0 && proved > 0);
}

/* Something that happens while the turn field grows, or after. */
static void make_change(unsigned what)
{
    struct jp_lattice_pose pose = west;

    switch (what) {
    case 0:
        occupy(15, 22); /* on the route */
        break;
    case 1:
        for (int32_t y = 12; y < 20; y++) {
            release(15, y);
        }
        break;
    case 2:
        TEST_ASSERT_NOT_NULL(jp_planner_step(&planner, 0, &pose));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &pose));
        break;
    default:
        expect_start(JP_OK, 5, 8, 0); /* off the route */
        break;
    }
}

static void test_changes_while_the_turn_field_grows_and_after(void)
{
    size_t size = SHARED_BLOCK_MIN;

    TEST_ASSERT_TRUE(plan_with_shared_states(&size));
    for (unsigned i = 0; i < 4U * CHANGE_TIMES; i++) {
        build_large_map();
        start_in(&planner, large_block, size, &west);
        while (planner.internal.phase != JP_PLANNER_GROW_TURNS) {
            TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
            (void)jp_planner_work(&planner, 1);
        }
        for (unsigned k = 0; k < i * i; k++) {
            (void)jp_planner_work(&planner, 1);
        }
        make_change(i % 4U);
        expect_honest();
        make_change(1);
        expect_honest();
    }
}

/* On a large map the smallest block has no room for any field in the states' place. */
static void test_no_room_for_a_field(void)
{
    enum { SIDE = 200 };
    static uint64_t terrain_memory[SIDE * SIDE / 4 / sizeof(uint64_t) + SIDE];
    static const struct jp_terrain_config large = {
        .width = SIDE, .height = SIDE, .resolution = JP_Q16(0.2), .unknown_is_free = true};
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &large, terrain_memory, sizeof terrain_memory, &field));
    config.epsilon[0] = JP_EPSILON(4);
    TEST_ASSERT_EQUAL_INT(JP_OK,
                          jp_planner_init(&planner, &config, &terrain, large_block, jp_planner_size(&large), &field));
    go(&west, &(const struct jp_goal){9, 5, 1});
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_WITHIN_BOUND, finish_in_slices(&planner));
    TEST_ASSERT_EQUAL_INT(JP_PLANNER_LENT_TO_NONE, planner.internal.lent);
    expect_drivable();
}
