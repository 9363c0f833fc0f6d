/* What the robot tells of its motors and frames: the currents with the voltages that drove them, frames left out. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "unity.h"

static struct jp_robot_config config;
static struct jp_robot robot;
static struct jp_sensors sensors;
static struct jp_actuation actuation;
static struct jp_motor_sample sample;

static void tick(enum jp_status read)
{
    jp_robot_tick(&robot, read, &sensors, &actuation);
}

void setUp(void)
{
    const char *field = "";

    config = jp_robot_courier24;
    config.monitor.freeze_ticks = 0;
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_init(&robot, &config, &field));
    tick(JP_OK);
}

void tearDown(void)
{
}

static void enable(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    tick(JP_OK);
    sensors.pitch_rate = JP_Q24(0.01);
}

static uint32_t dropped(void)
{
    struct jp_telemetry telemetry;

    jp_robot_telemetry(&robot, &telemetry);
    return telemetry.dropped_frames;
}

static void test_no_sample_while_the_motors_are_off(void)
{
    TEST_ASSERT_FALSE(jp_robot_motors(&robot, &sample));
    enable();
    TEST_ASSERT_TRUE(jp_robot_motors(&robot, &sample));
    jp_robot_disable(&robot);
    tick(JP_OK);
    TEST_ASSERT_FALSE(jp_robot_motors(&robot, &sample));
}

static void test_currents_come_with_the_voltages_that_drove_them(void)
{
    enable();
    for (int i = 0; i < 20; i++) {
        const struct jp_voltages applied = robot.internal.telemetry.voltages;

        sensors.current_left = applied.left / 4;
        sensors.current_right = applied.right / 4;
        sensors.encoder_left += 3;
        sensors.encoder_right += 5;
        tick(JP_OK);
        TEST_ASSERT_TRUE(jp_robot_motors(&robot, &sample));
        TEST_ASSERT_EQUAL_INT32(applied.left, sample.voltages.left);
        TEST_ASSERT_EQUAL_INT32(applied.right, sample.voltages.right);
        TEST_ASSERT_EQUAL_INT32(sensors.current_left, sample.current_left);
        TEST_ASSERT_EQUAL_INT32(sensors.current_right, sample.current_right);
        TEST_ASSERT_TRUE(i == 0 || applied.left != robot.internal.telemetry.voltages.left);
    }
    TEST_ASSERT_TRUE(sample.wheel_rate > 0 && sample.yaw_rate > 0);
}

static void test_no_sample_of_a_frame_that_was_dropped(void)
{
    enable();
    tick(JP_OK);
    tick(JP_ERR_HARDWARE);
    TEST_ASSERT_FALSE(jp_robot_motors(&robot, &sample));
    tick(JP_OK);
    TEST_ASSERT_TRUE(jp_robot_motors(&robot, &sample));
}

static void test_counts_frames_that_fail_or_are_implausible(void)
{
    enable();
    TEST_ASSERT_EQUAL_UINT32(0, dropped());
    for (uint32_t i = 0; i < 10; i++) {
        tick(JP_ERR_HARDWARE);
        tick(JP_OK);
        sensors.pitch_rate = INT32_MAX;
        tick(JP_OK);
        sensors.pitch_rate = 0;
        tick(JP_OK);
        TEST_ASSERT_EQUAL_UINT32(2U * (i + 1U), dropped());
    }
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, robot.internal.telemetry.state);
}

static void test_counts_anew_after_a_disable(void)
{
    enable();
    tick(JP_ERR_HARDWARE);
    tick(JP_OK);
    TEST_ASSERT_EQUAL_UINT32(1, dropped());
    jp_robot_disable(&robot);
    tick(JP_OK);
    TEST_ASSERT_EQUAL_UINT32(0, dropped());
}
