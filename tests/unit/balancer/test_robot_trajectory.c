/* Trajectories that a robot follows: refusals, legs as segments, what comes before and after, stop and disable. */
#include "src/trajectory/trajectory_blend.h"
#include "tests/support/robot_rig.h"

enum { LEG_TICKS = 300 };

/* Gently forward: two legs of 0.3 s. */
static struct jp_trajectory_leg legs[] = {
    {.speed = JP_Q24(0.02),
     .begin = {.set_points = 50},
     .middle = {.set_points = 50},
     .end = {.set_points = 50},
     .next = {.speed = JP_Q24(0.02)}},
    {.speed = JP_Q24(0.03),
     .begin = {.set_points = 50},
     .middle = {.set_points = 50},
     .end = {.set_points = 50},
     .next = {.speed = JP_Q24(0.02)}},
};

static const struct jp_trajectory trajectory = {
    .legs = legs, .places = 2, .count = 2, .start = {.speed = JP_Q24(0.02)}};

static enum jp_status drive_trajectory(void)
{
    jp_leg_shape(&config.trajectory, &trajectory.start, &legs[0]);
    jp_leg_shape(&config.trajectory, &legs[0].next, &legs[1]);
    return jp_robot_drive_trajectory(&robot, &trajectory);
}

static void make_following(void)
{
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, drive_trajectory());
    run(1);
    expect_state(JP_ROBOT_DRIVING);
}

static void test_refuses_bad_arguments(void)
{
    struct jp_trajectory bad = trajectory;

    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_drive_trajectory(NULL, &trajectory));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_drive_trajectory(&robot, NULL));
    bad.count = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_drive_trajectory(&robot, &bad));
    bad = trajectory;
    bad.legs = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_drive_trajectory(&robot, &bad));
    config.limits.speed = legs[1].speed - 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, drive_trajectory());
    config.limits.speed++;
    TEST_ASSERT_EQUAL_INT(JP_OK, drive_trajectory());
}

static void test_needs_running_motors(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, drive_trajectory());
    make_fallen();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, drive_trajectory());
}

static void test_one_may_wait(void)
{
    make_following();
    TEST_ASSERT_EQUAL_INT(JP_OK, drive_trajectory());
    TEST_ASSERT_EQUAL_INT(JP_ERR_BUSY, drive_trajectory());
    TEST_ASSERT_EQUAL_INT(JP_ERR_BUSY, jp_robot_drive(&robot, &one_second));
}

static void test_legs_count_as_segments(void)
{
    make_following();
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().segment);
    TEST_ASSERT_EQUAL_UINT32(LEG_TICKS - 1, telemetry().segment_ticks_left);
    TEST_ASSERT_EQUAL_INT32(legs[0].speed, telemetry().command.speed);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().command.turn_rate);
    run(LEG_TICKS - 1);
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().segments_ended);
    TEST_ASSERT_EQUAL_UINT32(0, telemetry().segment_ticks_left);
    run(1);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segment);
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().segments_ended);
    TEST_ASSERT_EQUAL_INT32(legs[1].speed, telemetry().command.speed);
    TEST_ASSERT_EQUAL_UINT32(LEG_TICKS - 1, telemetry().segment_ticks_left);
    TEST_ASSERT_GREATER_THAN_INT64(0, telemetry().segment_energy_model);
    run(LEG_TICKS);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segments_ended);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().command.speed);
}

/* The third leg is in the place of the first. */
static void test_legs_in_a_ring(void)
{
    struct jp_trajectory ring = trajectory;

    make_balancing();
    ring.count = 3;
    TEST_ASSERT_EQUAL_INT(JP_OK, drive_trajectory());
    jp_robot_stop(&robot);
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive_trajectory(&robot, &ring));
    run(1 + 2 * LEG_TICKS);
    TEST_ASSERT_EQUAL_UINT16(3, telemetry().segment);
    TEST_ASSERT_EQUAL_INT32(legs[0].speed, telemetry().command.speed);
    run(LEG_TICKS);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(3, telemetry().segments_ended);
}

/* One tick later: that of the beginning prepares the first. Each serves for two. */
static void test_the_reference_is_the_set_point(void)
{
    struct jp_trajectory_drive drive;
    struct jp_set_point point;

    jp_trajectory_begin(&drive, &trajectory);
    make_following();
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.wheel.rate);
    for (int i = 0; i < 2 * LEG_TICKS - 1; i++) {
        run(1);
        if (i % 2 == 0) {
            TEST_ASSERT_TRUE(jp_trajectory_advance(&drive, &config.trajectory, &point));
        }
        TEST_ASSERT_EQUAL_INT32(point.wheel_rate, robot.internal.reference.wheel.rate);
        TEST_ASSERT_EQUAL_INT32(point.pitch, robot.internal.reference.pitch);
        TEST_ASSERT_EQUAL_INT32(point.common, robot.internal.reference.common);
    }
    run(1);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.pitch);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.common);
}

static void test_a_segment_after_a_trajectory(void)
{
    make_following();
    run(LEG_TICKS);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(LEG_TICKS);
    expect_state(JP_ROBOT_DRIVING);
    TEST_ASSERT_EQUAL_UINT16(3, telemetry().segment);
    TEST_ASSERT_EQUAL_INT32(one_second.motion.speed, telemetry().command.speed);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.common);
    run(RATE);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(3, telemetry().segments_ended);
}

static void test_a_trajectory_after_a_segment(void)
{
    make_driving();
    TEST_ASSERT_EQUAL_INT(JP_OK, drive_trajectory());
    run(RATE - 1);
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().segment);
    run(1);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segment);
    TEST_ASSERT_EQUAL_INT32(legs[0].speed, telemetry().command.speed);
    run(2 * LEG_TICKS);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(3, telemetry().segments_ended);
}

static void test_a_trajectory_after_a_trajectory(void)
{
    make_following();
    TEST_ASSERT_EQUAL_INT(JP_OK, drive_trajectory());
    run(2 * LEG_TICKS);
    TEST_ASSERT_EQUAL_UINT16(3, telemetry().segment);
    run(2 * LEG_TICKS);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(4, telemetry().segments_ended);
}

/* Also where a leg ends. */
static void test_stop_in_the_middle(void)
{
    const uint32_t moments[] = {50, LEG_TICKS - 1};

    for (int i = 0; i < 2; i++) {
        setUp();
        make_following();
        run(moments[i]);
        jp_robot_stop(&robot);
        run(1);
        expect_state(JP_ROBOT_BALANCING);
        TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.common);
        TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.wheel.target_rate);
        run(LEG_TICKS);
        expect_state(JP_ROBOT_BALANCING);
        TEST_ASSERT_EQUAL_UINT16(1, telemetry().segment);
    }
}

static void test_disable_in_the_middle(void)
{
    make_following();
    run(50);
    disable();
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().segment);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(1);
    TEST_ASSERT_EQUAL_INT32(one_second.motion.speed, telemetry().command.speed);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.common);
}
