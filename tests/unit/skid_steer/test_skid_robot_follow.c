/* A path that the skid-steered robot follows: begin, end, what ends it before, and where the robot is between the steps
 * of its odometry. */
#include <joulepath/line_path.h>
#include <joulepath/skid_path_energy.h>

#include "src/skid_steer/skid_follow.h"
#include "tests/support/skid_robot_rig.h"

#define PLACES 4

static struct jp_path_piece pieces[PLACES];
static struct jp_lattice_path path;

/* A turn to the left by a right angle and a line of 1 m, from where the robot was switched on. */
static void plan(void)
{
    const struct jp_point target = {0, JP_Q16(1)};
    const struct jp_line_route route = {.targets = &target, .count = 1};
    const struct jp_motion_price price = jp_skid_motion_price(&jp_skid_energy_zhang2018, 0);
    struct jp_path_cost cost;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, pieces, PLACES, &route));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_plan_speeds(&path, &jp_path_limits_zhang2018, &price, &cost));
}

static void begin(void)
{
    plan();
    make_standing();
    TEST_ASSERT_FALSE(jp_skid_robot_has_next(&robot));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_follow(&robot, &path));
    TEST_ASSERT_TRUE(jp_skid_robot_has_next(&robot));
    run(1);
    TEST_ASSERT_FALSE(jp_skid_robot_has_next(&robot));
    expect_state(JP_SKID_ROBOT_DRIVING);
}

static void test_it_arrives_at_the_end_and_stands(void)
{
    uint32_t seconds = 0;

    begin();
    while (jp_skid_robot_state_now(&robot) == JP_SKID_ROBOT_DRIVING && seconds < 60) {
        run(RATE);
        seconds++;
    }
    expect_state(JP_SKID_ROBOT_STANDING);
    const struct jp_skid_telemetry last = telemetry();
    TEST_ASSERT_EQUAL_HEX16(0, last.faults);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), 0, (jp_q16)(last.x >> 16));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), JP_Q16(1), (jp_q16)(last.y >> 16));
    TEST_ASSERT_NULL(robot.internal.follow.path);
}

static void test_what_is_refused(void)
{
    const struct jp_lattice_path empty = {.pieces = pieces};

    plan();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_robot_follow(NULL, &path));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_robot_follow(&robot, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_robot_follow(&robot, &empty));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_follow(&robot, &path));
    make_driving();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_follow(&robot, &path));
}

static void expect_stand_without_path(void)
{
    run(RATE);
    expect_state(JP_SKID_ROBOT_STANDING);
    TEST_ASSERT_NULL(robot.internal.follow.path);
}

static void test_a_stop_ends_it(void)
{
    begin();
    run(RATE);
    jp_skid_robot_stop(&robot);
    expect_stand_without_path();
}

static void test_a_command_replaces_it(void)
{
    const struct jp_skid_command slowly = {.motion = {JP_Q24(0.1), 0}, .duration = JP_Q16(0.5)};

    begin();
    run(RATE);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &slowly));
    run(1);
    TEST_ASSERT_NULL(robot.internal.follow.path);
    expect_state(JP_SKID_ROBOT_DRIVING);
    expect_stand_without_path();
}

static void test_a_disable_and_a_fault_end_it(void)
{
    begin();
    run(RATE);
    jp_skid_robot_disable(&robot);
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_IDLE, jp_skid_robot_state_now(&robot));
    TEST_ASSERT_NULL(robot.internal.follow.path);
    set_up_rig();
    begin();
    run(RATE);
    sensors.bus_voltage = 0;
    run(3);
    expect_state(JP_SKID_ROBOT_FAULT);
    TEST_ASSERT_NULL(robot.internal.follow.path);
}

static void test_a_configuration_that_cannot_follow(void)
{
    const char *field = "";

    config.path.way = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_skid_robot_init(&robot, &config, &field));
    TEST_ASSERT_EQUAL_STRING("path_drive.way", field);
    config = jp_skid_robot_zhang2018;
    config.path.tick_rate = RATE + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_skid_robot_init(&robot, &config, &field));
    TEST_ASSERT_EQUAL_STRING("control.tick_rate", field);
}

/* The pose moves on in every tick, and evenly. */
static void test_where_it_is_now(void)
{
    struct jp_point before;
    struct jp_point now;
    jp_angle heading;

    make_driving();
    run(RATE / 2);
    jp_skid_odometry_now(jp_skid_robot_odometry(&robot), &config.odometry, &before, &heading);
    for (int i = 0; i < 40; i++) {
        run(1);
        jp_skid_odometry_now(jp_skid_robot_odometry(&robot), &config.odometry, &now, &heading);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.0002), JP_Q16(0.4 / RATE), now.x - before.x);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.0002), before.y, now.y);
        before = now;
    }
}

/* The robot is held where it stands: to catch up the motion runs ahead of the path's, and the slope is told from the
 * accelerometer without that. */
static void test_the_acceleration_is_that_of_the_speed_with_the_way_back(void)
{
    static struct jp_skid_follow follow;
    const char *field = "";
    jp_q24 speed = 0;
    jp_q24 beyond = 0;

    plan();
    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_drive_init(&follow.drive, &config.path, &field));
    jp_skid_follow_begin(&follow, &path);
    for (uint32_t i = 0; i < 6 * RATE && follow.path != NULL; i++) {
        jp_skid_follow_work(&follow, jp_skid_robot_odometry(&robot), &config.odometry);
        if (follow.next == JP_SKID_FOLLOW_ADVANCE) {
            speed += follow.acceleration / (jp_q24)(RATE / JP_TICKS_PER_PATH_POINT);
            TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), follow.motion.speed, speed);
            if (follow.motion.speed - follow.at.motion.speed > beyond) {
                beyond = follow.motion.speed - follow.at.motion.speed;
            }
        }
    }
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), config.path.speed_correction, beyond);
}

/* The slope is told from the accelerometer without the acceleration of the path. */
static void test_a_path_accelerates_as_it_says(void)
{
    jp_q24 most = 0;

    begin();
    run(4);
    while (robot.internal.follow.path != NULL) {
        const jp_q24 asked = robot.internal.follow.acceleration;

        run(1);
        TEST_ASSERT_EQUAL_INT32(asked, robot.internal.acceleration);
        most = asked > most ? asked : most;
    }
    TEST_ASSERT_TRUE(most > JP_Q24(0.1));
    TEST_ASSERT_TRUE(telemetry().path_piece > 0);
}

/* As a flipped bit of the memory would leave it: the path goes on. */
static void test_a_part_that_is_none_advances(void)
{
    begin();
    run(RATE);
    robot.internal.follow.next = (enum jp_skid_follow_part)99;
    run(1);
    TEST_ASSERT_TRUE(robot.internal.follow.next <= JP_SKID_FOLLOW_TRACK);
    TEST_ASSERT_NOT_NULL(robot.internal.follow.path);
    expect_state(JP_SKID_ROBOT_DRIVING);
}
