/** A skid-steered robot whose wheels turn as its controller asks, unless they are held, with the currents and the gyro
 * that belong to it, for the tests of its states. */
#ifndef JOULEPATH_TESTS_SUPPORT_SKID_ROBOT_RIG_H
#define JOULEPATH_TESTS_SUPPORT_SKID_ROBOT_RIG_H

#include <joulepath/skid_robot.h>
#include <joulepath/tables.h>

#include "unity.h"

#define RATE 500 /* ticks a second */

static const struct jp_skid_command one_second = {.motion = {JP_Q24(0.4), 0}, .duration = JP_Q16(1)};

static struct jp_skid_robot_config config;
static struct jp_skid_robot robot;
static struct jp_sensors sensors;
static struct jp_actuation actuation;
static jp_phase angles[JP_SKID_SIDES];
static bool held[JP_SKID_SIDES];
static jp_q16 false_current;
static jp_turns_per_s driven_rate; /**< of both sides, by what no motor does; 0: none */

static inline void init(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_init(&robot, &config, &field));
}

static inline void set_up_rig(void)
{
    config = jp_skid_robot_zhang2018;
    config.monitor.freeze_ticks = 0;
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(46)};
    angles[JP_SKID_LEFT] = 0;
    angles[JP_SKID_RIGHT] = 0;
    held[JP_SKID_LEFT] = false;
    held[JP_SKID_RIGHT] = false;
    false_current = 0;
    driven_rate = 0;
    actuation = (struct jp_actuation){0};
    init();
}

void setUp(void)
{
    set_up_rig();
}

void tearDown(void)
{
}

static inline jp_turns_per_s wheel_rate(int side)
{
    const jp_turns_per_s asked = driven_rate != 0 ? driven_rate : robot.internal.control.sides[side].reference;

    return held[side] ? 0 : asked;
}

static inline uint32_t counts_of(int side)
{
    angles[side] += jp_phase_step(wheel_rate(side), jp_phase_per_rate(RATE));
    return (uint32_t)((int64_t)angles[side] / (int64_t)config.control.wheel_per_count);
}

/** (u − K ω)/R; none where the bridges are off. */
static inline jp_q16 current_of(int side, jp_q16 voltage)
{
    if (actuation.enabled == 0U) {
        return 0;
    }
    const jp_q16 back_emf = jp_multiply_shift(config.control.back_emf, robot.internal.control.sides[side].rate, 24);

    return jp_q16_divide(voltage - back_emf, config.control.resistance);
}

static inline void move_wheels(void)
{
    const jp_turns_per_s ahead = wheel_rate(JP_SKID_RIGHT) - wheel_rate(JP_SKID_LEFT);

    sensors.encoder_left = counts_of(JP_SKID_LEFT);
    sensors.encoder_right = counts_of(JP_SKID_RIGHT);
    sensors.current_left = current_of(JP_SKID_LEFT, robot.internal.voltages.left) + false_current;
    sensors.current_right = current_of(JP_SKID_RIGHT, robot.internal.voltages.right);
    sensors.yaw_rate = jp_q24_multiply(jp_q24_multiply(ahead, config.wheels.turn_per_wheel), config.odometry.ratio);
}

static inline void tick_read(enum jp_status read)
{
    move_wheels();
    jp_skid_robot_tick(&robot, read, &sensors, &actuation);
}

static inline void run(uint32_t ticks)
{
    for (uint32_t i = 0; i < ticks; i++) {
        tick_read(JP_OK);
    }
}

static inline struct jp_skid_telemetry telemetry(void)
{
    struct jp_skid_telemetry copy;

    TEST_ASSERT_TRUE(jp_skid_robot_telemetry(&robot, &copy));
    return copy;
}

/** Bridges are always on; idle and at rest they short the motors. */
static inline void expect_state(enum jp_skid_robot_state state)
{
    TEST_ASSERT_EQUAL_INT(state, jp_skid_robot_state_now(&robot));
    TEST_ASSERT_EQUAL_INT(state, telemetry().state);
    TEST_ASSERT_EQUAL_UINT8(1, actuation.enabled);
    if (state == JP_SKID_ROBOT_IDLE && telemetry().reference.speed == 0 && robot.internal.acceleration == 0) {
        TEST_ASSERT_EQUAL_INT32(0, actuation.duty_left);
        TEST_ASSERT_EQUAL_INT32(0, actuation.duty_right);
        TEST_ASSERT_EQUAL_INT32(0, telemetry().voltages.left);
    }
}

/** From the first frame on. */
static inline void wake(void)
{
    run(JP_SKID_WAKE_TICKS + 2);
}

static inline void make_standing(void)
{
    wake();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
    run(1);
    expect_state(JP_SKID_ROBOT_STANDING);
}

static inline void make_driving(void)
{
    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &one_second));
    run(1);
    expect_state(JP_SKID_ROBOT_DRIVING);
}

/** After a fault of the bus. */
static inline void make_fault(void)
{
    make_standing();
    sensors.bus_voltage = 0;
    run(3);
    sensors.bus_voltage = JP_Q16(46);
    expect_state(JP_SKID_ROBOT_FAULT);
}

#endif
