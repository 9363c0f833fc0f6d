/* The navigator with a robot that does what it is told: drives, corners, changes of the map, and what it tells. */
#define LEVEL_MAP_BYTES 1344 /* 24 × 24 cells with elevation */
#include "tests/support/navigator_rig.h"

#include <string.h>

#define QUARTER_TURN ((jp_angle)1 << 30)

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

/* From 8, 0 up: the robot has to go round. */
static void build_wall(int32_t last)
{
    put_column(12, 0, last, JP_CELL_OCCUPIED);
}

static void test_refuses_configurations(void)
{
    const struct jp_navigator_config good = config;
    const char *field = "";

    make_planner(sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigator_init(NULL, &config, &origin, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigator_init(&navigator, NULL, &origin, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigator_init(&navigator, &config, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigator_init(&navigator, &config, &origin, NULL));
    config.planner = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_navigator_init(&navigator, &config, &origin, &field));
    TEST_ASSERT_EQUAL_STRING("planner", field);
    config = good;
    config.vehicle = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_navigator_init(&navigator, &config, &origin, &field));
    TEST_ASSERT_EQUAL_STRING("vehicle", field);
    config = good;
    config.slice = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_navigator_init(&navigator, &config, &origin, &field));
    TEST_ASSERT_EQUAL_STRING("slice", field);
    config = good;
    config.legs_max = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_navigator_init(&navigator, &config, &origin, &field));
    TEST_ASSERT_EQUAL_STRING("legs_max", field);
}

static void test_refuses_goals(void)
{
    init();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigator_go(NULL, &(struct jp_goal){9, 9, 1}));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigator_go(&navigator, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, go_to(SIDE, 9, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, go_to(0, 0, 1));
    robot.view.phase = JP_VEHICLE_OFF;
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, go_to(18, 18, 1));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_IDLE, jp_navigator_work(&navigator));
}

static void test_drives_to_the_goal_on_free_ground(void)
{
    begin(18, 15);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(18, 15);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_NO_REASON, navigator.reason);
    TEST_ASSERT_EQUAL_UINT32(1, robot.follows);
    TEST_ASSERT_EQUAL_UINT32(0, robot.stops);
    TEST_ASSERT_EQUAL_UINT32(0, navigator.replans);
}

static void test_drives_where_odometry_began_in_any_direction(void)
{
    for (jp_angle heading = 0; heading < 7U * (QUARTER_TURN / 2U); heading += QUARTER_TURN / 2U + 12345U) {
        rig_reset();
        origin.heading = heading;
        begin(17, 6);
        TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
        expect_at(17, 6);
        TEST_ASSERT_LESS_OR_EQUAL_UINT(robot.legs, robot.turns); /* once a leg */
    }
}

static void test_turns_to_the_heading_of_the_goal(void)
{
    init();
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(18, 15, 1U << 12));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(18, 15);
    TEST_ASSERT_UINT32_WITHIN(1U << 23, 3U * QUARTER_TURN, jp_navigator_place(&navigator).heading);
}

/* Half a degree is facing. */
static void test_turns_again_until_it_faces(void)
{
    robot.turned_by = JP_ANGLE_DEGREES(0.45);
    begin(17, 6);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_LESS_OR_EQUAL_UINT(robot.legs, robot.turns);
    rig_reset();
    robot.turned_by = JP_ANGLE_DEGREES(0.55);
    begin(17, 6);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_GREATER_THAN_UINT32(robot.legs, robot.turns);
}

static void test_a_goal_begins_without_what_was_of_the_last(void)
{
    init();
    navigator.replans = 3;
    navigator.status = JP_ERR_HARDWARE;
    navigator.reason = JP_NAVIGATOR_VEHICLE;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, go_to(SIDE, 9, 1));
    TEST_ASSERT_EQUAL_UINT16(3, navigator.replans);
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(9, 9, JP_ANY_HEADING));
    TEST_ASSERT_EQUAL_UINT16(0, navigator.replans);
    TEST_ASSERT_EQUAL_INT(JP_OK, navigator.status);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_NO_REASON, navigator.reason);
}

/* Where the place of the robot has no room for the planner, the nearest cell has that is on the far side. */
static void test_plans_from_a_cell_near_the_robot(void)
{
    static const struct {
        int32_t obstacle[2];
        int32_t start[2];
    } cases[] = {{{6, 4}, {3, 3}}, {{2, 4}, {5, 3}}, {{4, 6}, {3, 3}}, {{4, 2}, {3, 5}}};

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        rig_reset();
        /* The disc is clear by 5 mm, the cell that it stands on is not. */
        origin.point.x += (4 - cases[i].obstacle[0]) * JP_Q16(0.015);
        origin.point.y += (4 - cases[i].obstacle[1]) * JP_Q16(0.015);
        put_column(cases[i].obstacle[0], cases[i].obstacle[1], cases[i].obstacle[1], JP_CELL_OCCUPIED);
        begin(18, 15);
        TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
        TEST_ASSERT_EQUAL_INT(cases[i].start[0], navigator.internal.start.x);
        TEST_ASSERT_EQUAL_INT(cases[i].start[1], navigator.internal.start.y);
        TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    }
}

static void test_turns_where_it_is(void)
{
    init();
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(4, 4, 1U << 4));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_UINT32(0, robot.follows);
    TEST_ASSERT_UINT32_WITHIN(1U << 23, QUARTER_TURN, jp_navigator_place(&navigator).heading);
}

static void test_goes_round_a_wall_in_motion(void)
{
    build_wall(14);
    begin(19, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(19, 4);
    TEST_ASSERT_EQUAL_UINT32(1, robot.follows);
}

static void test_stands_at_corners_that_it_cannot_take(void)
{
    build_wall(14);
    robot.infeasible = 1;
    begin(19, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(19, 4);
    TEST_ASSERT_EQUAL_UINT32(robot.legs, robot.follows);
    TEST_ASSERT_GREATER_THAN_UINT32(1, robot.follows);
}

static void test_stands_at_the_sharper_corner_of_a_leg(void)
{
    unsigned follows[2];

    for (uint16_t i = 0; i < 2; i++) {
        rig_reset();
        build_wall(14);
        robot.infeasible = (uint16_t)(i + 2U);
        begin(19, 4);
        TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
        expect_at(19, 4);
        follows[i] = robot.follows;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(1, follows[0]);
    TEST_ASSERT_GREATER_THAN_UINT32(1, follows[1]);
}

static void test_stands_at_corners_for_which_there_is_no_room(void)
{
    build_wall(14);
    robot.aside = JP_Q16(0.3);
    begin(19, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(19, 4);
    TEST_ASSERT_GREATER_THAN_UINT32(1, robot.follows);
}

static void test_takes_corners_for_which_there_is_room(void)
{
    build_wall(14);
    robot.aside = JP_Q16(0.005);
    begin(19, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_UINT32(1, robot.follows);
}

static void test_slows_down_where_there_is_little_room_behind_its_stand(void)
{
    /* 0.3 m before a wall, of which disc and margin take 0.205. */
    put_column(21, 0, SIDE - 1, JP_CELL_OCCUPIED);
    robot.beyond = JP_Q16(0.2);
    begin(17, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_GREATER_THAN_UINT32(1, robot.slowest);
    TEST_ASSERT_LESS_THAN_UINT32(8, robot.slowest);
    expect_at(17, 4);
}

static void test_stands_where_its_margin_is_room_enough(void)
{
    put_column(20, 0, SIDE - 1, JP_CELL_OCCUPIED);
    config.margin = JP_Q16(0.06);
    robot.beyond = JP_Q16(0.1);
    begin(17, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_UINT32(8, robot.slowest);
    expect_at(17, 4);
}

static void test_is_there_already(void)
{
    begin(4, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, jp_planner_plan(&planner)->answer);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_UINT32(0, robot.turns + robot.follows);
}

static void test_drives_by_a_route_that_is_there_in_time(void)
{
    config.patience = 100000000;
    begin(18, 15);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    config.patience = 1;
    begin(6, 6);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
}

/* ---- Changes of the map ---- */

static void test_brakes_and_goes_round_what_comes_into_its_way(void)
{
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    for (int i = 0; i < 8; i++) {
        (void)jp_navigator_work(&navigator);
    }
    for (int32_t y = 2; y < 8; y++) {
        occupy(13, y);
    }
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_BRAKING, jp_navigator_work(&navigator));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_BLOCKED, navigator.reason);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PLANNING));
    TEST_ASSERT_EQUAL_UINT32(1, robot.stops);
    TEST_ASSERT_EQUAL_UINT32(1, navigator.replans);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(18, 4);
}

static void test_drives_on_when_something_appears_beside_its_way(void)
{
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    (void)jp_navigator_work(&navigator);
    occupy(13, 20);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_UINT32(0, navigator.replans);
}

static void test_says_that_the_goal_cannot_be_reached_any_more(void)
{
    config.patience = 100000000;
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    (void)jp_navigator_work(&navigator);
    for (int32_t y = 0; y < SIDE; y++) {
        occupy(13, y);
    }
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_UNREACHABLE));
    TEST_ASSERT_EQUAL_INT(JP_VEHICLE_STANDING, robot.view.phase);
}

/* A wall of cells x, from one edge of the map to the other, while it drives. */
static void wall_off(int32_t x)
{
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    (void)jp_navigator_work(&navigator);
    for (int32_t y = 0; y < SIDE; y++) {
        occupy(x, y);
    }
}

/* The wall is a cell and a half from the goal: its nearest standing place is a cell this side of the goal. */
static void test_a_goal_that_is_blocked_on_the_way_is_covered(void)
{
    config.radius = JP_Q16(0.2);
    begin(17, 10);
    wall_off(19);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(16, 10);
    TEST_ASSERT_EQUAL_INT16(17, navigator.internal.asked.x);
    TEST_ASSERT_EQUAL_INT16(16, navigator.internal.goal.x);
}

static void test_a_goal_that_is_free_again_is_gone_to(void)
{
    config.radius = JP_Q16(0.2);
    begin(17, 10);
    wall_off(19);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    (void)jp_navigator_work(&navigator);
    TEST_ASSERT_EQUAL_INT16(16, navigator.internal.goal.x);
    for (int32_t y = 0; y < SIDE; y++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_set_cell(&navigator, 19, y, JP_CELL_FREE));
    }
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(17, 10);
}

static void occupy_row(int32_t y)
{
    for (int32_t x = 0; x < SIDE; x++) {
        occupy(x, y);
    }
}

/* At first it can be covered from a cell before it. */
static void test_a_goal_that_nothing_covers_any_more_cannot_be_reached(void)
{
    config.radius = JP_Q16(0.2);
    begin(10, 17);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    (void)jp_navigator_work(&navigator);
    occupy_row(19);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    (void)jp_navigator_work(&navigator);
    TEST_ASSERT_EQUAL_INT16(16, navigator.internal.goal.y);
    occupy_row(17);
    occupy_row(14);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_UNREACHABLE));
}

static void test_a_goal_is_covered_from_beside_it_too(void)
{
    config.radius = JP_Q16(0.2);
    begin(17, 10);
    for (int32_t x = 0; x < SIDE; x++) {
        occupy(x, 12);
    }
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(17, 9);
    TEST_ASSERT_EQUAL_INT16(17, navigator.internal.goal.x);
    TEST_ASSERT_EQUAL_INT16(9, navigator.internal.goal.y);
}

/* First it can be covered, then it cannot: the planner keeps the goal that it had. */
static void test_a_goal_that_the_planner_refuses_is_not_taken(void)
{
    config.radius = JP_Q16(0.2);
    begin(17, 10);
    wall_off(19);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    TEST_ASSERT_EQUAL_INT16(16, navigator.internal.goal.x);
    wall_off(17);
    for (int32_t y = 0; y < SIDE; y++) {
        occupy(15, y);
    }
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_UNREACHABLE));
    TEST_ASSERT_EQUAL_INT16(16, navigator.internal.goal.x);
}

static void test_plans_anew_when_the_map_changes_before_it_drives(void)
{
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    (void)jp_navigator_work(&navigator);
    occupy(13, 4);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_PLANNING, jp_navigator_work(&navigator));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_TURNING));
    for (int32_t x = 6; x < 10; x++) {
        for (int32_t y = 6; y < 9; y++) {
            occupy(x, y);
        }
    }
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(18, 4);
}

static void test_a_later_run_that_is_blocked_does_not_stop_the_present_one(void)
{
    build_wall(14);
    robot.infeasible = 1;
    begin(19, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    (void)jp_navigator_work(&navigator);
    for (int32_t y = 8; y < 12; y++) {
        occupy(19, y);
    }
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_DRIVING, jp_navigator_work(&navigator));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PLANNING));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_BLOCKED, navigator.reason);
    TEST_ASSERT_EQUAL_UINT32(0, robot.stops);
}

static void test_a_change_while_it_turns_at_the_goal_does_not_matter(void)
{
    init();
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(18, 4, 1U << 8));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_TURNING));
    occupy(10, 18);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_UINT32(0, navigator.replans);
}

static void test_what_appears_when_it_has_rolled_beyond_the_end_is_not_in_its_way(void)
{
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    (void)jp_navigator_work(&navigator);
    robot.view.position.x = JP_Q16(1.43);
    occupy(10, 18);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_UINT32(0, navigator.replans);
}

static void test_begins_anew_when_the_map_was_changed_behind_its_back(void)
{
    begin(18, 4);
    (void)jp_navigator_work(&navigator);
    put_column(13, 2, 8, JP_CELL_OCCUPIED);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(18, 4);
}

static void test_goes_on_from_a_waypoint_where_it_is_already(void)
{
    build_wall(14);
    begin(19, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    (void)jp_navigator_work(&navigator);
    robot.work_status = JP_ERR_ZERO_LENGTH;
    robot.count = 0;
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_TURNING, jp_navigator_work(&navigator));
    /* It says so until it is told something else. */
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_DRIVING, jp_navigator_work(&navigator));
    robot.work_status = JP_OK;
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(19, 4);
}

static void test_waits_while_the_robot_sways(void)
{
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    for (int i = 0; i < 5; i++) {
        robot.turning = 2;
        TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_DRIVING, jp_navigator_work(&navigator));
        TEST_ASSERT_EQUAL_UINT32(0, robot.follows);
    }
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
}

static void test_brakes_when_it_leaves_its_course(void)
{
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    robot.drift = JP_Q16(0.015);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_BRAKING));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_ASTRAY, navigator.reason);
    robot.drift = 0;
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(18, 4);
}

/** Somebody else stops it so far before the end of its run. */
static void stop_before(jp_q16 left)
{
    while (robot.count == 0 || robot.view.position.x < robot.targets[robot.count - 1].x - left) {
        (void)jp_navigator_work(&navigator);
    }
    robot.count = 0;
    robot.view.phase = JP_VEHICLE_STANDING;
}

static void test_plans_anew_where_it_was_stopped_on_its_way(void)
{
    begin(18, 4);
    stop_before(JP_Q16(0.5));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_PLANNING, jp_navigator_work(&navigator));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_ASTRAY, navigator.reason);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_UINT16(1, navigator.replans);
    expect_at(18, 4);
}

/* From within a cell of the end there is nothing to plan. */
static void test_a_stand_within_a_cell_of_the_end_is_the_end(void)
{
    begin(18, 4);
    stop_before(map.resolution);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_UINT16(0, navigator.replans);
}

/* Exactly a cell is not more than one; the least more is. */
static void test_more_than_a_cell_is_short(void)
{
    for (jp_q16 more = -2; more <= 2; more++) {
        setUp();
        begin(18, 4);
        stop_before(JP_Q16(0.5));
        robot.view.position.x += legs[0].end.x - map.resolution - more - jp_navigator_place(&navigator).point.x;
        (void)jp_navigator_work(&navigator);
        TEST_ASSERT_EQUAL_UINT16(more > 0 ? 1 : 0, navigator.replans);
        TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    }
}

/* ---- Requests ---- */

static void test_stops(void)
{
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    (void)jp_navigator_work(&navigator);
    jp_navigator_stop(&navigator);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_IDLE, navigator.state);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_TOLD, navigator.reason);
    TEST_ASSERT_EQUAL_UINT32(1, robot.stops);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_IDLE, jp_navigator_work(&navigator));
}

static void test_another_goal_while_it_drives(void)
{
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    for (int i = 0; i < 10; i++) {
        (void)jp_navigator_work(&navigator);
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(4, 18, JP_ANY_HEADING));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_BRAKING, navigator.state);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(4, 18);
}

/* ---- What it tells ---- */

static void test_tells_what_is_left(void)
{
    struct jp_progress progress;
    struct jp_progress later;
    uint16_t count;

    begin(18, 4);
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_navigator_progress(&navigator, &progress));
    (void)jp_navigator_legs(&navigator, &count);
    TEST_ASSERT_EQUAL_UINT32(0, count);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_progress(&navigator, &progress));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(1.4), progress.length);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(1), progress.duration);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(2), progress.energy.energy);
    TEST_ASSERT_GREATER_THAN_INT32(JP_Q16(0.25), progress.energy.deviation);

    const struct jp_course_leg *ahead = jp_navigator_legs(&navigator, &count);
    TEST_ASSERT_EQUAL_UINT32(1, count);
    TEST_ASSERT_EQUAL_INT32(centre(18, 4).x, ahead[0].end.x);

    for (int i = 0; i < 36; i++) {
        (void)jp_navigator_work(&navigator);
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_progress(&navigator, &later));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.03), JP_Q16(0.7), later.length);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), progress.duration / 2, later.duration);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.1), progress.energy.energy / 2, later.energy.energy);
}

static void test_what_is_left_falls_from_leg_to_leg(void)
{
    struct jp_progress before;
    struct jp_progress now;
    unsigned legs_seen = 0;

    build_wall(14);
    begin(19, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_progress(&navigator, &before));
    while (jp_navigator_work(&navigator) == JP_NAVIGATOR_DRIVING) {
        uint16_t count;

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_progress(&navigator, &now));
        TEST_ASSERT_LESS_OR_EQUAL_INT32(before.length + JP_Q16(0.01), now.length);
        (void)jp_navigator_legs(&navigator, &count);
        legs_seen = count > legs_seen ? count : legs_seen;
        before = now;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(1, legs_seen);
    TEST_ASSERT_LESS_THAN_INT32(JP_Q16(0.05), before.length);
}

static void test_nothing_is_left_at_the_goal(void)
{
    struct jp_progress progress;

    init();
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(4, 4, 1U << 4));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_TURNING));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_progress(&navigator, &progress));
    TEST_ASSERT_EQUAL_INT32(0, progress.length);
    TEST_ASSERT_EQUAL_INT32(0, progress.energy.energy);
}

/* ---- On slopes ---- */

/* By 10 cm, which is more than its margin. */
static void test_drives_a_leg_from_where_its_turn_has_left_it(void)
{
    begin(4, 18);
    robot.slide = JP_Q16(0.1);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(4, 18);
    TEST_ASSERT_EQUAL_UINT16(0, navigator.replans);
    TEST_ASSERT_EQUAL_UINT32(0, robot.stops);
}

/* There an obstacle is beside the leg. */
static void test_plans_anew_where_its_turn_has_left_it_no_room(void)
{
    begin(4, 18);
    put_column(1, 9, 12, JP_CELL_OCCUPIED);
    robot.slide = JP_Q16(0.1);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_BRAKING));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_ASTRAY, navigator.reason);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(4, 18);
}

static jp_elevation slope(int32_t x, int32_t y)
{
    return (jp_elevation)(10 * x + 5 * y);
}

/* It asks for it as its odometry counts, which began a quarter turn to the left. */
static void test_the_vehicle_knows_the_ground(void)
{
    const struct jp_point ahead = {JP_Q16(0.4), JP_Q16(-0.3)};

    begin(18, 15);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_NULL(robot.ground);
    TEST_ASSERT_NULL(robot.run.ground);
    map.has_elevation = true;
    make_level_map(&map);
    raise_map(slope);
    robot.view.position = (struct jp_point){0, 0};
    origin.heading = QUARTER_TURN;
    begin(18, 15);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(18, 15);
    const struct jp_point place = {origin.point.x - ahead.y, origin.point.y + ahead.x};

    TEST_ASSERT_EQUAL_PTR(robot.run.ground, robot.ground);
    TEST_ASSERT_INT32_WITHIN(4, jp_terrain_height(&terrain, &place),
                             robot.ground->elevation(robot.ground->context, &ahead));
    TEST_ASSERT_EQUAL_INT32(map.resolution, robot.ground->spacing);
    TEST_ASSERT_EQUAL_INT(0, robot.ground->class_at(robot.ground->context, &ahead));
}

/* Level, so that only what it is tells it apart. */
static void test_the_vehicle_knows_the_classes_of_the_ground(void)
{
    const struct jp_point ahead = {JP_Q16(0.4), JP_Q16(-0.3)};

    map.has_classes = true;
    make_level_map(&map);
    origin.heading = QUARTER_TURN;
    begin(18, 15);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    const struct jp_point place = {origin.point.x - ahead.y, origin.point.y + ahead.x};

    TEST_ASSERT_NOT_NULL(robot.ground);
    TEST_ASSERT_EQUAL_PTR(robot.run.ground, robot.ground);
    TEST_ASSERT_EQUAL_INT(0, robot.ground->class_at(robot.ground->context, &ahead));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_class(&terrain, place.x / map.resolution, place.y / map.resolution, 3));
    TEST_ASSERT_EQUAL_INT(3, robot.ground->class_at(robot.ground->context, &ahead));
    TEST_ASSERT_EQUAL_INT32(0, robot.ground->elevation(robot.ground->context, &ahead));
}
