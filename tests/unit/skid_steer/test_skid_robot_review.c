/* What a skid-steered robot judges of its motors and its ground, in which ticks, and what a fault leaves. */
#include "tests/support/skid_robot_rig.h"

static struct jp_skid_robot_internal *const inside = &robot.internal;

/* Motors are judged in even ticks, from the second one on in which they are controlled. */
static void test_motors_are_judged_from_their_second_tick_on(void)
{
    for (uint32_t more = 0; more < 2; more++) {
        set_up_rig();
        run(JP_SKID_WAKE_TICKS + 4 + more);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
        const uint32_t enabling = telemetry().tick;
        const uint32_t first = enabling + 1U + (enabling + 1U) % 2U;
        const uint32_t confirmed = first + 2U * (config.monitor.residual_ticks - 1U);

        false_current = JP_Q16(8);
        run(confirmed - enabling + 1U);
        TEST_ASSERT_EQUAL_UINT32(confirmed + 1U, telemetry().tick);
        expect_state(JP_SKID_ROBOT_STANDING);
        TEST_ASSERT_EQUAL_HEX16(JP_FAULT_ENCODER_LEFT, inside->found);
        run(1);
        expect_state(JP_SKID_ROBOT_FAULT);
    }
}

static void test_motors_that_are_not_controlled_are_not_judged(void)
{
    wake();
    false_current = JP_Q16(8);
    run(4 * (uint32_t)config.monitor.residual_ticks);
    expect_state(JP_SKID_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_HEX16(0, telemetry().faults);
}

/* Currents of a frame that was dropped tell nothing of the voltages. */
static void test_a_frame_that_was_dropped_is_not_judged(void)
{
    for (uint32_t more = 0; more < 2; more++) {
        set_up_rig();
        config.monitor.residual_ticks = 1;
        init();
        make_driving();
        run(RATE / 2 + more);
        inside->monitor.good.current_left += JP_Q16(10); /* as if it was taken before the voltage changed */
        tick_read(JP_ERR_HARDWARE);
        TEST_ASSERT_EQUAL_HEX16(0, inside->found);
    }
}

/* Braking on after its IMU has failed, it makes up for no heading, and its ground names no other fault. */
static void test_an_imu_that_failed_is_not_believed(void)
{
    const struct jp_skid_command bend = {.motion = {JP_Q24(0.4), JP_Q24(0.2)}, .duration = JP_Q16(4)};

    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &bend));
    run(RATE / 2);
    sensors.pitch_rate = INT32_MAX;
    run(3);
    expect_state(JP_SKID_ROBOT_FAULT);
    const uint16_t faults = telemetry().faults;

    sensors.pitch_rate = 0;
    sensors.accel_x = JP_Q24(0.7);
    for (uint32_t i = 0; i < 4U * config.wheels.slope_calls; i++) {
        move_wheels();
        sensors.yaw_rate = JP_Q24(0.05);
        jp_skid_robot_tick(&robot, JP_OK, &sensors, &actuation);
        TEST_ASSERT_TRUE(inside->holds);
        TEST_ASSERT_EQUAL_INT32(0, inside->heading_error);
    }
    TEST_ASSERT_EQUAL_HEX16(faults, telemetry().faults);
}

/* What the last tick found before a disable is cleared with the rest. */
static void test_a_disable_clears_what_was_just_found(void)
{
    make_driving();
    run(RATE / 4);
    sensors.pitch_rate = INT32_MAX;
    run(3);
    sensors.pitch_rate = 0;
    TEST_ASSERT_TRUE(inside->holds);
    false_current = JP_Q16(8);
    while (inside->found == 0U) {
        run(1);
    }
    TEST_ASSERT_TRUE(inside->holds);
    false_current = 0;
    jp_skid_robot_disable(&robot);
    for (int i = 0; i < JP_SKID_WAKE_TICKS + 4; i++) {
        run(1);
        TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_IDLE, jp_skid_robot_state_now(&robot));
        TEST_ASSERT_EQUAL_HEX16(0, telemetry().faults);
    }
}

/* Its range alone: the gyro came there slowly. */
static void test_wheels_are_followed_where_the_gyro_is_beyond_its_range(void)
{
    make_driving();
    while (sensors.pitch_rate + JP_Q24(0.1) <= config.monitor.gyro_limit) {
        sensors.pitch_rate += JP_Q24(0.1);
        run(1);
        TEST_ASSERT_EQUAL_HEX16(0, inside->monitor.suspected);
    }
    sensors.pitch_rate += JP_Q24(0.1);
    run(1);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_IMU_RANGE, inside->monitor.suspected);
    TEST_ASSERT_EQUAL_UINT32(sensors.encoder_left, inside->monitor.good.encoder_left);
    TEST_ASSERT_EQUAL_UINT32(sensors.encoder_right, inside->monitor.good.encoder_right);
}

/* The first frame says where the counts begin, not how fast the wheels are; the odometry begins at 0. */
static void test_the_first_frame_is_no_motion(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, inside->odometry.internal.encoder[JP_SKID_LEFT]);
    TEST_ASSERT_EQUAL_UINT32(0, inside->odometry.internal.encoder[JP_SKID_RIGHT]);
    angles[JP_SKID_LEFT] = 5 * JP_PHASE_TURN;
    angles[JP_SKID_RIGHT] = 9 * JP_PHASE_TURN;
    run(1);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT32(0, inside->control.sides[JP_SKID_LEFT].rate);
        TEST_ASSERT_EQUAL_INT32(0, inside->control.sides[JP_SKID_RIGHT].rate);
        run(1);
    }
}
