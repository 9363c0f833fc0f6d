/* A skid-steered robot whose frames or wheels are at fault: what is held and what is not, and the way out. */
#include "tests/support/skid_robot_rig.h"

#include "src/base/integer.h"

static uint16_t faults(void)
{
    return telemetry().faults;
}

/** Nothing is held any more: when the robot has slowed down the motors are shorted. */
static void expect_shorted(void)
{
    run(RATE / 2);
    TEST_ASSERT_FALSE(robot.internal.holds);
    TEST_ASSERT_EQUAL_INT32(0, actuation.duty_left);
    TEST_ASSERT_EQUAL_INT32(0, actuation.duty_right);
    TEST_ASSERT_EQUAL_UINT8(1, actuation.enabled);
}

/* What it saw before says nothing of now. */
static void test_none_is_enabled_before_a_good_frame_after_a_disable(void)
{
    make_standing();
    jp_skid_robot_disable(&robot);
    sensors.bus_voltage = 0;
    run(1);
    expect_state(JP_SKID_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_enable(&robot));
    sensors.bus_voltage = JP_Q16(46);
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
    run(1);
    expect_state(JP_SKID_ROBOT_STANDING);
}

static void test_a_fault_of_the_bus_shorts_the_motors_and_stays(void)
{
    make_fault();
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_BUS_VOLTAGE, faults());
    expect_shorted();
    run(100);
    expect_state(JP_SKID_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_BUS_VOLTAGE, faults());
    jp_skid_robot_stop(&robot);
    run(1);
    expect_state(JP_SKID_ROBOT_FAULT);
}

static void test_sensors_that_do_not_answer_short_the_motors(void)
{
    make_driving();
    run(100);
    for (int i = 0; i < 3; i++) {
        expect_state(JP_SKID_ROBOT_DRIVING);
        tick_read(JP_ERR_HARDWARE);
    }
    expect_state(JP_SKID_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, faults());
    expect_shorted();
}

static void test_a_short_dropout_is_bridged(void)
{
    make_driving();
    run(100);
    tick_read(JP_ERR_HARDWARE);
    tick_read(JP_ERR_HARDWARE);
    run(10);
    expect_state(JP_SKID_ROBOT_DRIVING);
}

/** The IMU fails, and the wheels brake and hold as if stopped. */
static void test_an_imu_that_fails_leaves_the_wheels_controlled(void)
{
    make_driving();
    run(RATE / 2);
    sensors.pitch_rate = INT32_MAX;
    run(3);
    expect_state(JP_SKID_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_IMU_RANGE | JP_FAULT_IMU_JUMP, faults());
    TEST_ASSERT_TRUE(robot.internal.holds);
    TEST_ASSERT_TRUE(telemetry().reference.speed > JP_Q24(0.3));
    run(RATE / 4);
    TEST_ASSERT_TRUE(telemetry().reference.speed > 0);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.02), robot.internal.control.sides[JP_SKID_LEFT].reference,
                             robot.internal.control.sides[JP_SKID_LEFT].rate);
    run(RATE / 2);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().reference.speed);
    TEST_ASSERT_TRUE(robot.internal.holds);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_IMU_RANGE | JP_FAULT_IMU_JUMP, faults());
}

static void test_a_second_fault_ends_the_hold(void)
{
    make_driving();
    sensors.pitch_rate = INT32_MAX;
    run(3);
    TEST_ASSERT_TRUE(robot.internal.holds);
    sensors.bus_voltage = 0;
    run(1);
    expect_shorted();
    sensors.pitch_rate = 0;
    sensors.bus_voltage = JP_Q16(46);
    run(10);
    expect_shorted();
    expect_state(JP_SKID_ROBOT_FAULT);
}

/** Beyond what it may drive an accelerometer tells nothing of the ground. */
static void test_an_accelerometer_that_fails_does_not_drive_it_off(void)
{
    const jp_q16 most =
        jp_multiply_shift(config.control.climbing, jp_sin((jp_angle)config.monitor.tilt_limit << 8), 31);

    for (int sign = -1; sign <= 1; sign += 2) {
        set_up_rig();
        make_standing();
        sensors.accel_x = sign * JP_Q24(3.7);
        run(RATE);
        expect_state(JP_SKID_ROBOT_FAULT);
        TEST_ASSERT_EQUAL_HEX16(JP_FAULT_SLOPE, faults());
        TEST_ASSERT_TRUE(robot.internal.holds);
        for (int side = 0; side < JP_SKID_SIDES; side++) {
            TEST_ASSERT_TRUE(jp_magnitude32(robot.internal.control.sides[side].load) <= (uint32_t)most + 1U);
        }
    }
}

/** What else is wrong with a frame says nothing of its counts. */
static void test_wheels_are_followed_by_frames_that_are_implausible(void)
{
    make_driving();
    run(RATE / 2);
    const jp_turns_per_s before = robot.internal.control.sides[JP_SKID_LEFT].rate;

    false_current = JP_Q16(30);
    run(2);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_CURRENT_RANGE, robot.internal.monitor.suspected);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.02), before, robot.internal.control.sides[JP_SKID_LEFT].rate);
    TEST_ASSERT_EQUAL_UINT32(sensors.encoder_left, robot.internal.monitor.good.encoder_left);
    sensors.encoder_left += 2U * config.monitor.encoder_jump;
    jp_skid_robot_tick(&robot, JP_OK, &sensors, &actuation);
    TEST_ASSERT_TRUE(sensors.encoder_left != robot.internal.monitor.good.encoder_left);
}

/** After a reset in motion a sensor fails before the wheels' speed is known: it brakes from that speed all the same. */
static void test_a_fault_while_it_wakes_leaves_the_speed_known(void)
{
    driven_rate = JP_Q24(0.3);
    run(JP_SKID_WAKE_TICKS - 2);
    false_current = JP_Q16(30);
    while (robot.internal.wake_ticks > 0U) {
        run(1);
    }
    driven_rate = 0;
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), jp_q24_divide(JP_Q24(0.3), config.control.turns_per_metre),
                             telemetry().reference.speed);
}

static void test_idle_shows_faults_and_holds_nothing(void)
{
    wake();
    sensors.pitch_rate = INT32_MAX;
    run(3);
    expect_state(JP_SKID_ROBOT_FAULT);
    expect_shorted();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_enable(&robot));
    jp_skid_robot_disable(&robot); /* the cause is still there */
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_enable(&robot));
    run(JP_SKID_WAKE_TICKS + 2);
    expect_state(JP_SKID_ROBOT_FAULT);
}

static void test_an_enable_that_meets_a_fault_does_nothing(void)
{
    wake();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
    robot.internal.monitor.implausible_ticks = 2;
    sensors.bus_voltage = 0;
    run(1);
    expect_state(JP_SKID_ROBOT_FAULT);
    expect_shorted();
}

static void test_a_stalled_side_stops_both_at_once(void)
{
    make_driving();
    run(RATE / 2);
    held[JP_SKID_LEFT] = true;
    run(2 * (uint32_t)config.wheels.stall_calls - 50);
    expect_state(JP_SKID_ROBOT_DRIVING);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &one_second));
    run(150);
    expect_state(JP_SKID_ROBOT_FAULT);
    TEST_ASSERT_TRUE((faults() & JP_FAULT_STALLED_LEFT) != 0);
    TEST_ASSERT_TRUE(robot.internal.holds);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().reference.speed);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.control.sides[JP_SKID_RIGHT].reference);
}

/** Its left side takes nothing of what the ground takes, once it drives steadily with this turn rate. */
static void lift_left_side(jp_q24 turn_rate)
{
    const struct jp_skid_command command = {.motion = {JP_Q24(0.4), turn_rate}, .duration = JP_Q16(8)};

    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &command));
    run(2 * RATE);
    false_current = config.wheels.friction - sensors.current_left;
    for (uint32_t tick = 0; tick < 4U * RATE && robot.internal.state == JP_SKID_ROBOT_DRIVING; tick++) {
        run(1);
    }
}

/** In a turn the sides take what they take; straight on they take alike. */
static void test_a_side_in_the_air_is_found_straight_on(void)
{
    lift_left_side(0);
    expect_state(JP_SKID_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_WHEEL_IN_AIR, faults());
    set_up_rig();
    lift_left_side(JP_Q24(0.05));
    TEST_ASSERT_EQUAL_HEX16(0, faults() & JP_FAULT_WHEEL_IN_AIR);
}

static void test_the_slope_stops_it_and_keeps_it(void)
{
    make_driving();
    run(RATE / 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &one_second));
    sensors.accel_x = JP_Q24(0.5);
    run(RATE / 2);
    expect_state(JP_SKID_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_SLOPE, faults());
    TEST_ASSERT_TRUE(robot.internal.holds);
    run(RATE);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().reference.speed);
    jp_skid_robot_disable(&robot);
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_enable(&robot));
    sensors.accel_x = 0;
    run(RATE);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
}

static void test_an_encoder_that_contradicts_its_current_shorts_the_motors(void)
{
    make_driving();
    run(10);
    false_current = JP_Q16(8);
    run(2 * (uint32_t)config.monitor.residual_ticks + 2);
    expect_state(JP_SKID_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_ENCODER_LEFT, faults());
    expect_shorted();
}

/** Downhill, faster than the motors hold back. */
static void test_wheels_that_run_away_are_slowed_down_blindly(void)
{
    make_driving();
    run(RATE / 2);
    driven_rate = robot.internal.control.sides[JP_SKID_LEFT].reference;
    for (int i = 0; i < RATE && jp_skid_robot_state_now(&robot) == JP_SKID_ROBOT_DRIVING; i++) {
        driven_rate += driven_rate < config.monitor.wheel_rate_limit + JP_Q24(0.05) ? JP_Q24(0.01) : 0;
        run(1);
    }
    expect_state(JP_SKID_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_OVERSPEED, faults());
    expect_shorted();
}

/** What it moves in a fault is not counted. */
static void test_position_goes_on_after_a_fault(void)
{
    make_driving();
    run(RATE);
    sensors.bus_voltage = 0;
    run(3);
    expect_state(JP_SKID_ROBOT_FAULT);
    const int64_t before = telemetry().x;

    TEST_ASSERT_TRUE(before > 0);
    sensors.bus_voltage = JP_Q16(46);
    run(RATE / 2);
    TEST_ASSERT_TRUE(telemetry().x == before);
    jp_skid_robot_disable(&robot);
    run(RATE / 2);
    TEST_ASSERT_TRUE(telemetry().x - before < (int64_t)1 << 24);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
    run(2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &one_second));
    run(RATE);
    TEST_ASSERT_TRUE(telemetry().x - before > (int64_t)1 << 30);
}
