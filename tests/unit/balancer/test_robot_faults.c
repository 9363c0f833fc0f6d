/* A robot that falls, or whose frames are at fault: it switches off and stays so until it is disabled. */
#include "tests/support/robot_rig.h"

static void test_falls_from_balancing_and_driving_both_ways(void)
{
    make_fallen();
    setUp();
    make_driving();
    robot.internal.estimator.pitch = 0 - JP_PHASE_TURN / 8;
    run(1);
    expect_state(JP_ROBOT_FALLEN);
    TEST_ASSERT_EQUAL_UINT32(0, telemetry().segment_ticks_left);
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().faults);
    robot.internal.estimator.pitch = 0; /* upright again: it stays off */
    run(100);
    expect_state(JP_ROBOT_FALLEN);
}

static void test_idle_does_not_fall(void)
{
    run(1);
    robot.internal.estimator.pitch = JP_PHASE_TURN / 8;
    run(10);
    expect_state(JP_ROBOT_IDLE);
}

static void test_faults_switch_off_and_stay(void)
{
    make_fault();
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_BUS_VOLTAGE, telemetry().faults);
    run(100);
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_BUS_VOLTAGE, telemetry().faults);
    jp_robot_stop(&robot);
    run(1);
    expect_state(JP_ROBOT_FAULT);

    setUp();
    make_driving();
    for (int i = 0; i < 3; i++) {
        expect_state(JP_ROBOT_DRIVING);
        tick_read(JP_ERR_HARDWARE);
    }
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, telemetry().faults);
}

static void test_fallen_stays_fallen_under_a_fault(void)
{
    make_fallen();
    sensors.bus_voltage = 0;
    run(10);
    expect_state(JP_ROBOT_FALLEN);
}

static void test_a_short_dropout_is_bridged(void)
{
    make_balancing();
    tick_read(JP_ERR_HARDWARE);
    tick_read(JP_ERR_HARDWARE);
    run(1);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_idle_shows_faults_and_refuses_to_start(void)
{
    run(1);
    sensors.bus_voltage = 0;
    run(3);
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    jp_robot_disable(&robot); /* the cause is still there */
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    run(3);
    expect_state(JP_ROBOT_FAULT);
}

static void test_disable_recovers_from_an_encoder_that_jumped(void)
{
    make_balancing();
    sensors.encoder_left += 100000;
    run(3);
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_ENCODER_JUMP, telemetry().faults);
    disable();
}

static void test_residual_counts_anew_after_disable(void)
{
    make_balancing();
    /* The motors are reviewed after the duties are out, so the next tick switches off. */
    for (uint32_t i = 0; i <= config.monitor.residual_ticks; i++) {
        expect_state(JP_ROBOT_BALANCING);
        sensors.current_left = JP_Q16(5);
        jp_robot_tick(&robot, JP_OK, &sensors, &actuation);
    }
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_ENCODER_LEFT, telemetry().faults);
    jp_robot_disable(&robot);
    run(2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    sensors.current_left = JP_Q16(5);
    jp_robot_tick(&robot, JP_OK, &sensors, &actuation);
    expect_state(JP_ROBOT_BALANCING);
}
