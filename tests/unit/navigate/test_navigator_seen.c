/* What the navigator has seen and forgets: its memory against a copy of the map, and when it may mislead the robot. */
#include "tests/support/navigator_rig.h"

/* Of a map whose rows do not fill their last byte. */
enum { WIDTH = 21, HEIGHT = 9 };

static uint8_t seen[SIDE * SIDE / 4];

/** A generator for cells: x ← 1664525 x + 1013904223. */
static uint32_t state;

static uint32_t chance(uint32_t below)
{
    state = state * 1664525U + 1013904223U;
    return (state >> 16) % below;
}

void setUp(void)
{
    rig_reset();
    config.seen = seen;
    config.seen_size = sizeof seen;
    config.patience = 800; /* a hundred slices */
}

void tearDown(void)
{
}

/* ---- The memory ---- */

static void make_small_map(void)
{
    map.width = WIDTH;
    map.height = HEIGHT;
    make_level_map(&map);
    for (int32_t y = 0; y < HEIGHT; y++) {
        for (int32_t x = 0; x < WIDTH; x++) {
            (void)jp_terrain_set_cell(&terrain, x, y, (enum jp_cell)chance(3));
        }
    }
}

static void copy_map(enum jp_cell cells[HEIGHT][WIDTH])
{
    for (int32_t y = 0; y < HEIGHT; y++) {
        for (int32_t x = 0; x < WIDTH; x++) {
            cells[y][x] = jp_terrain_cell(&terrain, x, y);
        }
    }
}

static void expect_map(enum jp_cell cells[HEIGHT][WIDTH])
{
    for (int32_t y = 0; y < HEIGHT; y++) {
        for (int32_t x = 0; x < WIDTH; x++) {
            TEST_ASSERT_EQUAL_INT(cells[y][x], jp_terrain_cell(&terrain, x, y));
        }
    }
}

static void see_anything(unsigned times)
{
    for (unsigned i = 0; i < times; i++) {
        const int32_t x = (int32_t)chance(WIDTH);
        const int32_t y = (int32_t)chance(HEIGHT);
        const enum jp_cell cell = (enum jp_cell)chance(3);

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_set_cell(&navigator, x, y, cell));
        TEST_ASSERT_EQUAL_INT(cell, jp_terrain_cell(&terrain, x, y));
    }
}

/** Where no route leads to the goal, nor the robot anywhere. */
static void make_it_forget(void)
{
    navigator.internal.has_moved = true;
    navigator.internal.forgets = 0;
    navigator.state = JP_NAVIGATOR_PLANNING;
    navigator.internal.was_told = false;
    (void)jp_navigator_work(&navigator);
}

static void test_what_was_seen_is_forgotten_to_the_cell(void)
{
    static enum jp_cell before[HEIGHT][WIDTH];

    state = 20264;
    for (unsigned i = 0; i < 20; i++) {
        make_small_map();
        copy_map(before);
        init();
        for (unsigned k = 1; k <= 3; k++) {
            see_anything(1U + chance(300));
            /* Nobody can stand there. */
            for (int32_t y = 0; y < HEIGHT; y++) {
                occupy(4, y);
            }
            make_it_forget();
            TEST_ASSERT_EQUAL_UINT8(k, navigator.forgets);
            expect_map(before);
        }
    }
}

static void test_what_is_as_it_was_is_not_seen(void)
{
    static const uint8_t nothing[sizeof seen] = {0};

    state = 7;
    seen[5] = 0xFF; /* of another map */
    make_small_map();
    init();
    TEST_ASSERT_EQUAL_MEMORY(nothing, seen, jp_navigator_seen_size(&map));
    for (int32_t x = 0; x < WIDTH; x++) {
        const enum jp_cell was = jp_terrain_cell(&terrain, x, 3);

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_set_cell(&navigator, x, 3, was));
        TEST_ASSERT_EQUAL_MEMORY(nothing, seen, jp_navigator_seen_size(&map));
        for (unsigned i = 1; i < 3; i++) {
            const enum jp_cell other = (enum jp_cell)(((unsigned)was + i) % 3U);

            TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_set_cell(&navigator, x, 3, other));
            TEST_ASSERT_EQUAL_HEX8(((unsigned)was + 1U) << (x % 4 * 2), seen[3 * 6 + x / 4]);
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_set_cell(&navigator, x, 3, was));
        TEST_ASSERT_EQUAL_MEMORY(nothing, seen, jp_navigator_seen_size(&map));
    }
}

static void test_what_is_no_cell_of_the_map_is_not_seen(void)
{
    static const uint8_t nothing[sizeof seen] = {0};

    init();
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_navigator_set_cell(&navigator, SIDE, 0, JP_CELL_OCCUPIED));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_navigator_set_cell(&navigator, 0, -1, JP_CELL_OCCUPIED));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigator_set_cell(&navigator, 0, 0, (enum jp_cell)3));
    TEST_ASSERT_EQUAL_MEMORY(nothing, seen, sizeof seen);
}

static void test_the_memory_must_do_for_the_map(void)
{
    const char *field = "";

    make_planner(sizeof block);
    TEST_ASSERT_EQUAL_UINT32(sizeof seen, jp_navigator_seen_size(&map));
    config.seen_size = sizeof seen - 1U;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_navigator_init(&navigator, &config, &origin, &field));
    TEST_ASSERT_EQUAL_STRING("seen_size", field);
    config.seen = NULL;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_init(&navigator, &config, &origin, &field));
    map.width = WIDTH;
    map.height = HEIGHT;
    TEST_ASSERT_EQUAL_UINT32(6 * HEIGHT, jp_navigator_seen_size(&map));
}

/* ---- The drive ---- */

/** As if odometry had shifted a wall before the goal. */
static void see_wall(int32_t x)
{
    for (int32_t y = 0; y < SIDE; y++) {
        occupy(x, y);
    }
}

static void drive_a_little(void)
{
    const unsigned follows = robot.follows;

    while (robot.follows == follows) {
        TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
        (void)jp_navigator_work(&navigator);
    }
}

/** Until it does something again. */
static unsigned slices_of_look(void)
{
    const uint16_t replans = navigator.replans;
    unsigned slices = 0;

    while (navigator.replans == replans) {
        TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_PLANNING, navigator.state);
        (void)jp_navigator_work(&navigator);
        slices++;
    }
    return slices;
}

static void work_until_it_forgets(void)
{
    const uint8_t forgets = navigator.forgets;

    for (unsigned i = 0; i < WORK_MAX && navigator.forgets == forgets; i++) {
        TEST_ASSERT_LESS_THAN_INT(JP_NAVIGATOR_ARRIVED, jp_navigator_work(&navigator));
    }
    TEST_ASSERT_EQUAL_UINT8(forgets + 1U, navigator.forgets);
}

static void test_a_goal_that_drift_has_closed_is_tried_again(void)
{
    begin(18, 4);
    drive_a_little();
    see_wall(13);
    work_until_it_forgets();
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, jp_terrain_cell(&terrain, 13, 4));
    TEST_ASSERT_EQUAL_UINT32(100, slices_of_look());
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(18, 4);
    TEST_ASSERT_EQUAL_UINT8(1, navigator.forgets);
}

/* Slices of eight expansions: the last of them may be more than it needed. */
static void test_it_looks_round_for_its_patience(void)
{
    for (uint32_t patience = 785; patience <= 808; patience++) {
        setUp();
        config.patience = patience;
        begin(18, 4);
        drive_a_little();
        see_wall(13);
        work_until_it_forgets();
        TEST_ASSERT_EQUAL_UINT32((patience + 7U) / 8U, slices_of_look());
    }
}

static void test_what_it_still_sees_proves_that_no_route_leads_there(void)
{
    begin(18, 4);
    drive_a_little();
    see_wall(13);
    work_until_it_forgets();
    see_wall(13);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_UNREACHABLE));
    TEST_ASSERT_EQUAL_UINT8(1, navigator.forgets);
}

static void test_a_turn_may_mislead_it(void)
{
    robot.view.heading = (jp_angle)1 << 31;
    robot.heading = robot.view.heading;
    begin(18, 4);
    while (robot.turns == 0U) {
        TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_TURNING));
        (void)jp_navigator_work(&navigator);
    }
    see_wall(13);
    work_until_it_forgets();
    TEST_ASSERT_EQUAL_UINT32(0, robot.follows);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(18, 4);
}

static void test_before_it_has_moved_nothing_misleads_it(void)
{
    begin(18, 4);
    see_wall(13);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_UNREACHABLE));
    TEST_ASSERT_EQUAL_UINT8(0, navigator.forgets);
}

static void test_without_memory_it_forgets_nothing(void)
{
    config.seen = NULL;
    begin(18, 4);
    drive_a_little();
    see_wall(13);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_UNREACHABLE));
    TEST_ASSERT_EQUAL_UINT8(0, navigator.forgets);
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, jp_terrain_cell(&terrain, 13, 4));
}

/** Of the way to its goal. */
static void close_it_again_and_again(void)
{
    for (int32_t i = 0; i < 3; i++) {
        drive_a_little();
        see_wall(15);
        work_until_it_forgets();
    }
    drive_a_little();
    see_wall(15);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_UNREACHABLE));
}

static void test_three_times_on_the_way_to_a_goal(void)
{
    begin(18, 4);
    close_it_again_and_again();
    TEST_ASSERT_EQUAL_UINT8(3, navigator.forgets);
    for (int32_t y = 0; y < SIDE; y++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_set_cell(&navigator, 15, y, JP_CELL_FREE));
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(18, 10, JP_ANY_HEADING));
    close_it_again_and_again();
    TEST_ASSERT_EQUAL_UINT8(6, navigator.forgets);
}

static void test_a_robot_that_is_hemmed_in_by_what_it_saw_looks_again(void)
{
    begin(18, 4);
    drive_a_little();
    for (int32_t x = 0; x < 12; x++) {
        for (int32_t y = 0; y < SIDE; y++) {
            occupy(x, y);
        }
    }
    work_until_it_forgets();
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(18, 4);
}

static void test_a_proof_in_little_memory_may_mislead_too(void)
{
    const char *field = "";

    make_planner(jp_planner_size(&map));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_init(&navigator, &config, &origin, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(20, 18, JP_ANY_HEADING));
    drive_a_little();
    see_wall(17);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PROVING));
    work_until_it_forgets();
    TEST_ASSERT_EQUAL_UINT32(100, slices_of_look());
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(20, 18);
}

static void test_another_goal_does_not_wait(void)
{
    begin(18, 4);
    drive_a_little();
    see_wall(13);
    work_until_it_forgets();
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(8, 4, JP_ANY_HEADING));
    (void)jp_navigator_work(&navigator);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_ROUTE, navigator.internal.search);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(8, 4);
}
