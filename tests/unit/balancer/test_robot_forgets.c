/* What a robot leaves behind when it stands, switches off and begins anew, and which of two reasons counts. */
#include "src/trajectory/trajectory_blend.h"
#include "tests/support/robot_rig.h"

static struct jp_trajectory_leg legs[3];
static struct jp_trajectory trajectory;

static void make_following(void)
{
    trajectory = (struct jp_trajectory){.legs = legs, .places = 2, .count = 2, .start = {.speed = JP_Q24(0.02)}};
    for (int i = 0; i < 3; i++) {
        legs[i] = (struct jp_trajectory_leg){.speed = JP_Q24(0.02),
                                             .begin = {.set_points = 50},
                                             .middle = {.set_points = 50},
                                             .end = {.set_points = 50},
                                             .next = {.speed = JP_Q24(0.02)}};
        jp_leg_shape(&config.trajectory, &trajectory.start, &legs[i]);
    }
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive_trajectory(&robot, &trajectory));
    run(1);
}

static void expect_no_command(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, telemetry().segment_ticks_left);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().command.speed);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().command.turn_rate);
}

static void expect_no_trajectory(void)
{
    TEST_ASSERT_NULL(robot.internal.trajectory);
    TEST_ASSERT_FALSE(robot.internal.has_set_point);
    TEST_ASSERT_FALSE(robot.internal.set_point_is_new);
}

static void drive_a_while(void)
{
    const struct jp_segment_command segment = {.motion = {JP_Q24(0.1), JP_Q24(0.2)}, .duration = JP_Q16(1)};

    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &segment));
    run(20);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.2), telemetry().command.turn_rate);
}

static void test_a_stop_ends_the_command(void)
{
    drive_a_while();
    jp_robot_stop(&robot);
    run(1);
    expect_state(JP_ROBOT_BALANCING);
    expect_no_command();
}

static void test_the_end_of_a_segment_ends_the_command(void)
{
    drive_a_while();
    run(RATE);
    expect_state(JP_ROBOT_BALANCING);
    expect_no_command();
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.wheel.target_rate);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.yaw.target_rate);
}

static void test_switching_off_ends_the_command(void)
{
    drive_a_while();
    robot.internal.telemetry.voltages.saturated = true;
    jp_robot_disable(&robot);
    run(1);
    expect_state(JP_ROBOT_IDLE);
    expect_no_command();
    TEST_ASSERT_EQUAL_INT32(0, telemetry().voltages.left);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().voltages.right);
    TEST_ASSERT_FALSE(telemetry().voltages.saturated);
}

static void test_switching_off_and_stopping_leave_the_trajectory(void)
{
    static void (*const ways[])(struct jp_robot *) = {jp_robot_disable, jp_robot_stop};

    for (int i = 0; i < 2; i++) {
        setUp();
        make_following();
        run(20);
        while (!robot.internal.set_point_is_new) {
            run(1);
        }
        TEST_ASSERT_TRUE(robot.internal.has_set_point);
        ways[i](&robot);
        run(1);
        expect_no_trajectory();
        run(10);
        expect_no_trajectory();
    }
}

static void test_a_disable_takes_back_what_waits_at_once(void)
{
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    TEST_ASSERT_TRUE(jp_robot_has_next(&robot));
    jp_robot_disable(&robot);
    TEST_ASSERT_FALSE(jp_robot_has_next(&robot));
}

static void test_a_fault_takes_back_what_waits(void)
{
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(1);
    sensors.bus_voltage = 0;
    run(2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(1);
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_FALSE(jp_robot_has_next(&robot));
}

static void test_it_balances_without_what_it_integrated_and_counted_before(void)
{
    drive_a_while();
    run(RATE);
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().segments_ended);
    TEST_ASSERT_NOT_EQUAL(0, robot.internal.lqr.wheel_integral);
    TEST_ASSERT_NOT_EQUAL(0, robot.internal.lqr.yaw_integral);
    jp_robot_disable(&robot);
    run(2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().segments_ended);
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().segment);
    TEST_ASSERT_EQUAL_INT64(0, robot.internal.lqr.wheel_integral);
    TEST_ASSERT_EQUAL_INT64(0, robot.internal.lqr.yaw_integral);
}

/* The first frame shows how the robot leans, and the reference begins where the wheels are in the world. */
static void test_the_first_frame_is_a_measurement(void)
{
    sensors.accel_x = -JP_Q24(0.1);
    run(1);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(0.01586), telemetry().motion.pitch); /* atan 0.1 */
    TEST_ASSERT_TRUE(telemetry().motion.wheel != 0);
    TEST_ASSERT_EQUAL_UINT64(telemetry().motion.wheel, telemetry().reference_wheel);
    TEST_ASSERT_EQUAL_UINT64(telemetry().motion.wheel, telemetry().target_wheel);
}

static void test_a_stop_while_idle_is_over_when_it_balances(void)
{
    run(1);
    jp_robot_stop(&robot);
    run(1);
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(1);
    expect_state(JP_ROBOT_DRIVING);
}

static void test_a_stop_does_not_undo_a_fault_or_a_fall(void)
{
    make_balancing();
    sensors.bus_voltage = 0;
    run(2);
    jp_robot_stop(&robot);
    run(1);
    expect_state(JP_ROBOT_FAULT);
    setUp();
    make_balancing();
    config.monitor.tilt_limit = -1;
    jp_robot_stop(&robot);
    run(1);
    expect_state(JP_ROBOT_FALLEN);
}

static void test_a_fault_counts_more_than_a_fall(void)
{
    make_balancing();
    sensors.bus_voltage = 0;
    run(2);
    config.monitor.tilt_limit = -1;
    run(1);
    expect_state(JP_ROBOT_FAULT);
}

/* Without gains the pitch stays that of the first frame. */
static void test_a_fall_is_beyond_the_limit_and_not_at_it(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        config.estimator.tilt_gain = 0;
        config.estimator.bias_gain = 0;
        sensors.accel_x = -sign * JP_Q24(0.1);
        make_balancing();
        const jp_q24 pitch = telemetry().motion.pitch;

        run(3);
        TEST_ASSERT_EQUAL_INT32(pitch, telemetry().motion.pitch);
        config.monitor.tilt_limit = sign * pitch;
        run(1);
        expect_state(JP_ROBOT_BALANCING);
        config.monitor.tilt_limit = sign * pitch - 1;
        run(1);
        expect_state(JP_ROBOT_FALLEN);
    }
}

/* In the tick that switches them on no voltage has driven the motors yet. */
static void test_motors_are_judged_from_their_second_tick_on(void)
{
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    sensors.current_left = JP_Q16(5);
    jp_robot_tick(&robot, JP_OK, &sensors, &actuation);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(0, robot.internal.monitor.residual_ticks[0]);
    jp_robot_tick(&robot, JP_OK, &sensors, &actuation);
    TEST_ASSERT_EQUAL_UINT16(1, robot.internal.monitor.residual_ticks[0]);
}

static void test_a_segment_ends_once(void)
{
    drive_a_while();
    while (telemetry().segments_ended == 0U) {
        run(1);
    }
    jp_robot_disable(&robot);
    run(1);
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().segments_ended);
}

static void test_each_leg_of_a_trajectory_is_looked_at_and_no_other(void)
{
    make_following();
    legs[0].speed = config.limits.speed + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_drive_trajectory(&robot, &trajectory));
    legs[0].speed = JP_Q24(0.02);
    legs[2].speed = config.limits.speed + 1; /* is not of it */
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive_trajectory(&robot, &trajectory));
    while (jp_robot_has_next(&robot)) {
        run(1);
    }
    trajectory.count = 1; /* the second is not of it */
    legs[1].speed = config.limits.speed + 1;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive_trajectory(&robot, &trajectory));
    while (jp_robot_has_next(&robot)) {
        run(1);
    }
    legs[1].speed = JP_Q24(0.02);
    trajectory.count = 3; /* the third takes the place of the first */
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive_trajectory(&robot, &trajectory));
}

static void test_a_balancing_robot_will_stand_where_its_wheels_are_to_be(void)
{
    struct jp_telemetry shown = {.state = JP_ROBOT_BALANCING,
                                 .motion = {.wheel = (jp_phase)3 << 55},
                                 .target_wheel = (jp_phase)5 << 55,
                                 .position = {JP_Q16(1), JP_Q16(2)}};
    struct jp_point end;
    jp_angle heading;

    jp_robot_predict_end(&robot, &shown, &end, &heading);
    TEST_ASSERT_INT32_WITHIN(1, JP_Q16(1) + (config.metres_per_turn >> 8), end.x);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(2), end.y);
    TEST_ASSERT_EQUAL_HEX32(0, heading);
    shown.command.speed = JP_Q24(0.1);
    shown.segment_ticks_left = RATE;
    jp_robot_predict_end(&robot, &shown, &end, &heading);
    TEST_ASSERT_INT32_WITHIN(2, JP_Q16(1.1) + (config.metres_per_turn >> 8), end.x);
    shown.state = JP_ROBOT_DRIVING;
    jp_robot_predict_end(&robot, &shown, &end, &heading);
    TEST_ASSERT_INT32_WITHIN(1, JP_Q16(1.1), end.x);
    shown.command.speed = 127; /* together with one more it would be rounded up */
    jp_robot_predict_end(&robot, &shown, &end, &heading);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(1), end.x);
}
