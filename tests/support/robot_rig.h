/** A robot whose wheels are held, with the currents that belong to its voltages, for the tests of its states. */
#ifndef JOULEPATH_TESTS_SUPPORT_ROBOT_RIG_H
#define JOULEPATH_TESTS_SUPPORT_ROBOT_RIG_H

#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "unity.h"

#define RATE 1000 /* ticks a second */

static const struct jp_segment_command one_second = {{JP_Q24(0.1), 0}, 0, JP_Q16(1)};

static struct jp_robot_config config;
static struct jp_robot robot;
static struct jp_sensors sensors;
static struct jp_actuation actuation;

static inline void init(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_init(&robot, &config, &field));
}

void setUp(void)
{
    config = jp_robot_courier24;
    config.monitor.freeze_ticks = 0;
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)};
    init();
}

void tearDown(void)
{
}

static inline void tick_read(enum jp_status read)
{
    sensors.current_left = jp_q16_divide(robot.internal.telemetry.voltages.left, config.monitor.motor_resistance);
    sensors.current_right = jp_q16_divide(robot.internal.telemetry.voltages.right, config.monitor.motor_resistance);
    jp_robot_tick(&robot, read, &sensors, &actuation);
}

static inline void run(uint32_t ticks)
{
    for (uint32_t i = 0; i < ticks; i++) {
        tick_read(JP_OK);
    }
}

static inline struct jp_telemetry telemetry(void)
{
    struct jp_telemetry copy;

    jp_robot_telemetry(&robot, &copy);
    return copy;
}

static inline void expect_state(enum jp_robot_state state)
{
    bool on = state == JP_ROBOT_BALANCING || state == JP_ROBOT_DRIVING;

    TEST_ASSERT_EQUAL_INT(state, telemetry().state);
    TEST_ASSERT_EQUAL_UINT8(on ? 1 : 0, actuation.enabled);
    if (!on) {
        TEST_ASSERT_EQUAL_INT32(0, actuation.duty_left);
        TEST_ASSERT_EQUAL_INT32(0, actuation.duty_right);
        TEST_ASSERT_EQUAL_INT32(0, telemetry().voltages.left);
    }
}

static inline void make_balancing(void)
{
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    expect_state(JP_ROBOT_BALANCING);
}

static inline void make_driving(void)
{
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(1);
    expect_state(JP_ROBOT_DRIVING);
}

static inline void make_fallen(void)
{
    make_balancing();
    robot.internal.estimator.pitch = JP_PHASE_TURN / 8;
    run(1);
    expect_state(JP_ROBOT_FALLEN);
}

static inline void make_fault(void)
{
    make_balancing();
    sensors.bus_voltage = 0;
    run(3);
    sensors.bus_voltage = JP_Q16(24);
    expect_state(JP_ROBOT_FAULT);
}

/** Off, without its faults; then on again, and it stays on. */
static inline void disable(void)
{
    jp_robot_disable(&robot);
    run(1);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().faults);
    run(10);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    expect_state(JP_ROBOT_BALANCING);
    run(100);
    expect_state(JP_ROBOT_BALANCING);
}

#endif
