/* A robot's telemetry and duties; neither depends on where the encoders start. */
#include "tests/support/robot_rig.h"

static void test_telemetry_is_consistent(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, robot.internal.sequence);
    run(1);
    TEST_ASSERT_EQUAL_UINT32(2, robot.internal.sequence);
    robot.internal.sequence = UINT32_MAX - 1U;
    run(1);
    TEST_ASSERT_EQUAL_UINT32(0, robot.internal.sequence);
    make_driving();

    struct jp_telemetry copy = telemetry();

    TEST_ASSERT_EQUAL_INT(JP_ROBOT_DRIVING, copy.state);
    TEST_ASSERT_EQUAL_UINT32(robot.internal.telemetry.tick, copy.tick);
    TEST_ASSERT_EQUAL_MEMORY(&robot.internal.telemetry.motion, &copy.motion, sizeof copy.motion);
    TEST_ASSERT_EQUAL_INT32(robot.internal.telemetry.voltages.left, copy.voltages.left);
    TEST_ASSERT_EQUAL_INT32(robot.internal.telemetry.voltages.right, copy.voltages.right);
    TEST_ASSERT_EQUAL_UINT32(robot.internal.telemetry.segment_ticks_left, copy.segment_ticks_left);
    TEST_ASSERT_EQUAL_UINT16(1, copy.segment);
    TEST_ASSERT_EQUAL_INT32(robot.internal.reference.wheel.rate, copy.reference_wheel_rate);
    TEST_ASSERT_EQUAL_UINT64(robot.internal.reference.wheel.target, copy.target_wheel);
    TEST_ASSERT_EQUAL_INT32(jp_odometry_position(&robot.internal.odometry).x, copy.position.x);
    TEST_ASSERT_EQUAL_UINT64(robot.internal.reference.wheel.angle, copy.reference_wheel);
    TEST_ASSERT_EQUAL_UINT64(robot.internal.reference.yaw.angle, copy.reference_yaw);
    TEST_ASSERT_EQUAL_UINT64(robot.internal.reference.yaw.target, copy.target_yaw);
    TEST_ASSERT_EQUAL_INT64(robot.internal.meter.model, copy.energy_model);
    TEST_ASSERT_EQUAL_INT64(robot.internal.meter.battery, copy.energy_battery);
}

static void test_duty_is_the_share_of_the_bus(void)
{
    make_balancing();
    robot.internal.estimator.pitch = JP_PHASE_TURN / 100;
    run(1);
    TEST_ASSERT_TRUE(telemetry().voltages.left != 0);
    TEST_ASSERT_EQUAL_INT32(jp_divide((int64_t)telemetry().voltages.left * ((int64_t)1 << 31), JP_Q16(24)),
                            actuation.duty_left);
    robot.internal.estimator.pitch = JP_PHASE_TURN / 10; /* below the tilt limit, above the supply */
    sensors.bus_voltage = JP_Q16(20);
    run(1);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(20), telemetry().voltages.left);
    TEST_ASSERT_EQUAL_INT32(JP_Q31_MAX, actuation.duty_left);
    TEST_ASSERT_EQUAL_INT32(JP_Q31_MAX, actuation.duty_right);
    TEST_ASSERT_EQUAL_UINT32(1, telemetry().saturated_ticks);
    robot.internal.telemetry.saturated_ticks = UINT32_MAX;
    run(1);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, telemetry().saturated_ticks);
}

static jp_q31 share(jp_q16 voltage)
{
    return jp_divide((int64_t)voltage * ((int64_t)1 << 31), sensors.bus_voltage);
}

static void test_duties_are_rounded_at_every_voltage(void)
{
    config.monitor.voltage_min = 1;
    config.monitor.voltage_max = JP_Q16(1000);
    config.monitor.current_limit = JP_Q16(4000);
    init();
    make_balancing();
    for (uint32_t i = 0; i < 3000; i++) {
        const uint32_t random = i * 2654435761U;

        sensors.bus_voltage = JP_Q16(1000) >> (random >> 28);
        sensors.bus_voltage -= (jp_q16)(random & 0xFFFFU) % sensors.bus_voltage;
        robot.internal.estimator.pitch = (jp_phase)(int64_t)(int32_t)random << 20;
        run(1);
        TEST_ASSERT_EQUAL_INT32(share(telemetry().voltages.left), actuation.duty_left);
        TEST_ASSERT_EQUAL_INT32(share(telemetry().voltages.right), actuation.duty_right);
    }
    expect_state(JP_ROBOT_BALANCING);
}

static void test_start_counts_do_not_matter_to_the_bit(void)
{
    static const struct jp_segment_command two_seconds = {{JP_Q24(0.3), JP_Q24(0.1)}, JP_Q24(0.2), JP_Q16(2)};
    struct jp_telemetry expected = {0};

    for (uint32_t offset = 0; offset < 3; offset++) {
        setUp();
        sensors.encoder_left = 0U - 17U * offset;
        sensors.encoder_right = 0x7FFFFFFFU * offset;
        make_balancing();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &two_seconds));
        for (uint32_t i = 0; i < 1000; i++) {
            sensors.encoder_left += i / 100U;
            sensors.encoder_right += i / 90U;
            run(1);
        }
        expect_state(JP_ROBOT_DRIVING);
        if (offset == 0) {
            expected = telemetry();
        }
        TEST_ASSERT_EQUAL_UINT64(expected.motion.wheel, telemetry().motion.wheel);
        TEST_ASSERT_EQUAL_UINT64(expected.motion.yaw, telemetry().motion.yaw);
        TEST_ASSERT_EQUAL_INT32(expected.voltages.left, telemetry().voltages.left);
        TEST_ASSERT_EQUAL_INT32(expected.voltages.right, telemetry().voltages.right);
        TEST_ASSERT_EQUAL_INT32(expected.position.x, telemetry().position.x);
        TEST_ASSERT_EQUAL_INT64(expected.energy_battery, telemetry().energy_battery);
    }
}
