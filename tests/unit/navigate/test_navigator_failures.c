/* What keeps the navigator from a goal, and what it says of it. */
#include "tests/support/navigator_rig.h"

enum { MOVES_MAX = 512 };

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

/** So that the way to the goal is long and winding. */
static void build_maze(void)
{
    put_column(8, 0, 17, JP_CELL_OCCUPIED);
    put_column(16, 6, SIDE - 1, JP_CELL_OCCUPIED);
}

static void test_the_robot_refuses_to_turn(void)
{
    robot.view.heading = (jp_angle)1 << 31;
    robot.heading = robot.view.heading;
    robot.turn_status = JP_ERR_HARDWARE;
    begin(18, 4);
    expect_failure(JP_NAVIGATOR_VEHICLE);
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, navigator.status);
    TEST_ASSERT_EQUAL_UINT32(1, robot.stops);
}

static void test_the_robot_refuses_to_drive(void)
{
    robot.follow_status = JP_ERR_STATE;
    begin(18, 4);
    expect_failure(JP_NAVIGATOR_VEHICLE);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, navigator.status);
}

static void test_the_robot_gives_up(void)
{
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    (void)jp_navigator_work(&navigator);
    robot.work_status = JP_ERR_INFEASIBLE;
    expect_failure(JP_NAVIGATOR_VEHICLE);
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, navigator.status);
}

static void test_what_the_robot_gave_up_before_does_not_count(void)
{
    robot.work_status = JP_ERR_INFEASIBLE;
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_TURNING));
}

static void test_a_run_cannot_be_surveyed(void)
{
    robot.survey_status = JP_ERR_ARGUMENT;
    begin(18, 4);
    expect_failure(JP_NAVIGATOR_VEHICLE);
}

static void test_a_leg_from_stand_to_stand_cannot_be_driven(void)
{
    robot.survey_status = JP_ERR_INFEASIBLE;
    begin(18, 4);
    expect_failure(JP_NAVIGATOR_VEHICLE);
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, navigator.status);
}

static void test_the_motors_go_off(void)
{
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    (void)jp_navigator_work(&navigator);
    robot.view.phase = JP_VEHICLE_OFF;
    expect_failure(JP_NAVIGATOR_OFF);
}

static void test_a_robot_that_never_quite_turns_drives_all_the_same(void)
{
    robot.turned_by = (jp_angle)1 << 25;
    robot.view.heading = (jp_angle)1 << 31;
    robot.heading = robot.view.heading;
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    TEST_ASSERT_EQUAL_UINT32(8, robot.turns);
}

static void test_hemmed_in(void)
{
    for (int32_t x = 0; x < 10; x++) {
        put_column(x, 0, 9, JP_CELL_OCCUPIED);
    }
    put_column(4, 4, 4, JP_CELL_FREE);
    begin(18, 18);
    expect_failure(JP_NAVIGATOR_HEMMED_IN);
}

static void test_leaves_a_place_nearer_to_an_obstacle_than_the_planner_likes(void)
{
    /* 0.2 m from the wall, of which the disc takes 0.175. */
    put_column(1, 0, SIDE - 1, JP_CELL_OCCUPIED);
    origin.point = (struct jp_point){JP_Q16(0.4), JP_Q16(0.85)};
    begin(18, 8);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(18, 8);
}

static void test_too_many_legs(void)
{
    config.legs_max = 1;
    build_maze();
    begin(20, 18);
    expect_failure(JP_NAVIGATOR_TOO_LONG);
}

static void test_no_room_to_stand(void)
{
    put_column(21, 0, SIDE - 1, JP_CELL_OCCUPIED);
    robot.beyond = JP_Q16(1.5);
    begin(17, 4);
    expect_failure(JP_NAVIGATOR_NO_ROOM);
}

static void test_no_room_for_lines(void)
{
    config.radius = JP_Q16(1.5);
    begin(18, 4);
    expect_failure(JP_NAVIGATOR_NO_ROOM);
}

/* ---- A block that is too small ---- */

static void begin_in(size_t size)
{
    const char *field = "";

    make_planner(size);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_init(&navigator, &config, &origin, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(20, 18, JP_ANY_HEADING));
}

static void test_little_memory_is_enough(void)
{
    for (size_t more = 0; more < 2048; more += 128) {
        rig_reset();
        build_maze();
        begin_in(jp_planner_size(&map) + more);
        TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
        expect_at(20, 18);
    }
}

static void test_takes_the_way_when_the_planner_has_done_what_it_can(void)
{
    build_maze();
    begin_in(jp_planner_size(&map));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PROVING));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PLANNING));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    TEST_ASSERT_FALSE(navigator.internal.has_route);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(20, 18);
}

static void test_a_way_that_is_blocked_before_it_is_taken_is_looked_for_anew(void)
{
    unsigned ways = 0;

    build_maze();
    begin_in(jp_planner_size(&map));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PROVING));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PLANNING));
    occupy(22, 22);
    while (navigator.state != JP_NAVIGATOR_JOINING) {
        const enum jp_navigator_state before = navigator.state;

        (void)jp_navigator_work(&navigator);
        ways += before == JP_NAVIGATOR_PLANNING && navigator.state == JP_NAVIGATOR_PROVING ? 1U : 0U;
    }
    TEST_ASSERT_EQUAL_UINT32(1, ways);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(20, 18);
}

/* The planner finds the route, in time or not. */
static void test_a_better_route_that_is_late_is_taken_all_the_same(void)
{
    build_maze();
    config.patience = 1;
    begin_in(BLOCK_BYTES);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PROVING));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    TEST_ASSERT_TRUE(navigator.internal.has_route);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(20, 18);
}

static void block_its_way(void)
{
    for (int32_t y = 2; y < 8; y++) {
        occupy(13, y);
    }
}

static void test_on_its_way_it_waits_no_longer_than_its_patience(void)
{
    config.patience = 1;
    config.slice = 1;
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_TURNING));
    block_its_way();
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PLANNING));
    TEST_ASSERT_EQUAL_UINT32(1, navigator.replans);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PROVING));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    TEST_ASSERT_FALSE(navigator.internal.has_route);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(18, 4);
}

static void test_without_memory_for_a_way_it_waits_longer(void)
{
    config.patience = 1;
    config.slice = 1;
    config.way_block = NULL;
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_TURNING));
    block_its_way();
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    TEST_ASSERT_TRUE(navigator.internal.has_route);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
}

static void test_plans_while_it_brakes(void)
{
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    for (int i = 0; i < 8; i++) {
        (void)jp_navigator_work(&navigator);
    }
    block_its_way();
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_BRAKING));
    (void)jp_navigator_work(&navigator);
    robot.braking = 2000;
    for (int i = 0; i < 1500; i++) {
        TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_BRAKING, jp_navigator_work(&navigator));
    }
    TEST_ASSERT_TRUE(navigator.internal.has_route);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PLANNING));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_JOINING, jp_navigator_work(&navigator));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(18, 4);
}

/** Of the lattice's primitives. */
static unsigned count_moves(const struct jp_lattice *lattice)
{
    unsigned count = 0;

    for (unsigned i = 0; i < lattice->first_from[JP_HEADINGS]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];
        const unsigned end = primitive->first_move + (unsigned)primitive->move_count;
        count = end > count ? end : count;
    }
    return count;
}

/* As if unit steps led nowhere, and the planner had found nothing. */
static void test_curves_that_the_planner_has_no_memory_for(void)
{
    static uint8_t moves[MOVES_MAX];
    struct jp_lattice curves = jp_lattice_courier24;

    TEST_ASSERT_LESS_OR_EQUAL_UINT32(sizeof moves, count_moves(&curves));
    for (unsigned i = 0; i < count_moves(&curves); i++) {
        moves[i] = (uint8_t)((jp_lattice_courier24.moves[i] + 1U) % JP_MOVE_DIRECTIONS);
    }
    curves.moves = moves;
    build_maze();
    make_planner(jp_planner_size(&map));
    planner.internal.config.lattice = &curves;
    const char *field = "";
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_init(&navigator, &config, &origin, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(20, 18, JP_ANY_HEADING));
    expect_failure(JP_NAVIGATOR_MEMORY);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_ROUTE_ONLY, navigator.internal.search);
}

static void test_proves_in_little_memory_that_there_is_no_way(void)
{
    put_column(12, 0, SIDE - 1, JP_CELL_OCCUPIED);
    begin_in(jp_planner_size(&map));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PROVING));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_UNREACHABLE));
}

static void test_a_way_that_opens_during_the_proof_counts(void)
{
    put_column(12, 0, SIDE - 1, JP_CELL_OCCUPIED);
    config.slice = 1;
    begin_in(jp_planner_size(&map));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PROVING));
    (void)jp_navigator_work(&navigator);
    for (int32_t y = 8; y < 16; y++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_set_cell(&navigator, 12, y, JP_CELL_FREE));
    }
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_PLANNING, jp_navigator_work(&navigator));
    TEST_ASSERT_FALSE(work_until(JP_NAVIGATOR_UNREACHABLE));
}

static void test_without_memory_for_the_proof_it_is_a_failure(void)
{
    put_column(12, 0, SIDE - 1, JP_CELL_OCCUPIED);
    config.way_block = NULL;
    begin_in(jp_planner_size(&map));
    expect_failure(JP_NAVIGATOR_MEMORY);
}
