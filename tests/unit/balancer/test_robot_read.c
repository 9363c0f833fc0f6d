/* What others read of a robot in place: the same as in a whole copy, and what waits. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "unity.h"

static const struct jp_segment_command one_second = {.motion = {JP_Q24(0.1), JP_Q24(0.2)}, .duration = JP_Q16(1)};

static struct jp_robot_config config;
static struct jp_robot robot;
static struct jp_sensors sensors;

static void tick(void)
{
    struct jp_actuation actuation;

    sensors.current_left = jp_q16_divide(robot.internal.telemetry.voltages.left, config.monitor.motor_resistance);
    sensors.current_right = jp_q16_divide(robot.internal.telemetry.voltages.right, config.monitor.motor_resistance);
    jp_robot_tick(&robot, JP_OK, &sensors, &actuation);
}

void setUp(void)
{
    const char *field = "";

    config = jp_robot_courier24;
    config.monitor.freeze_ticks = 0;
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_init(&robot, &config, &field));
}

void tearDown(void)
{
}

static void enable(void)
{
    tick();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    tick();
}

static void test_a_new_robot_shows_what_it_was_prepared_with(void)
{
    TEST_ASSERT_EQUAL_PTR(&config, jp_robot_configuration(&robot));
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, jp_robot_state_now(&robot));
    TEST_ASSERT_FALSE(jp_robot_has_next(&robot));
}

static void test_in_place_stands_what_a_whole_copy_holds(void)
{
    const struct jp_tick_telemetry *last = jp_robot_last_tick(&robot);
    const struct jp_reference *reference = jp_robot_reference(&robot);
    const struct jp_meter *meter = jp_robot_meter(&robot);
    struct jp_telemetry copy;

    enable();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    for (int i = 0; i < 50; i++) {
        sensors.encoder_left += 3;
        sensors.encoder_right += 5;
        tick();
        TEST_ASSERT_TRUE(jp_robot_telemetry(&robot, &copy));
        TEST_ASSERT_EQUAL_INT(copy.state, last->state);
        TEST_ASSERT_EQUAL_UINT32(copy.tick, last->tick);
        TEST_ASSERT_EQUAL_UINT64(copy.motion.wheel, last->motion.wheel);
        TEST_ASSERT_EQUAL_INT32(copy.voltages.left, last->voltages.left);
        TEST_ASSERT_EQUAL_UINT64(copy.reference_wheel, reference->wheel.angle);
        TEST_ASSERT_EQUAL_INT32(copy.reference_yaw_rate, reference->yaw.rate);
        TEST_ASSERT_EQUAL_INT64(copy.energy_model, meter->model);
        TEST_ASSERT_EQUAL_INT64(copy.energy_battery, meter->battery);
        TEST_ASSERT_EQUAL_INT32(copy.position.x, jp_robot_position(&robot).x);
        TEST_ASSERT_EQUAL_INT32(copy.position.y, jp_robot_position(&robot).y);
    }
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_DRIVING, copy.state);
    TEST_ASSERT_TRUE(copy.position.x > 0 && copy.position.y != 0 && copy.energy_model > 0);
}

static void test_there_is_no_good_frame_before_a_plausible_one(void)
{
    const jp_q16 plausible = sensors.bus_voltage;

    TEST_ASSERT_NULL(jp_robot_good_frame(&robot));
    sensors.bus_voltage = INT32_MAX;
    tick();
    TEST_ASSERT_NULL(jp_robot_good_frame(&robot));
    sensors.bus_voltage = plausible;
    enable();
    TEST_ASSERT_EQUAL_MEMORY(&sensors, jp_robot_good_frame(&robot), sizeof sensors);
    sensors.bus_voltage = INT32_MAX;
    tick();
    TEST_ASSERT_EQUAL_INT32(plausible, jp_robot_good_frame(&robot)->bus_voltage);
    jp_robot_disable(&robot);
    tick();
    TEST_ASSERT_NULL(jp_robot_good_frame(&robot));
}

static void test_a_segment_is_next_until_it_begins(void)
{
    enable();
    TEST_ASSERT_FALSE(jp_robot_has_next(&robot));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    TEST_ASSERT_TRUE(jp_robot_has_next(&robot));
    tick();
    TEST_ASSERT_FALSE(jp_robot_has_next(&robot));
}

static void test_motors_have_samples_while_they_run(void)
{
    struct jp_motor_sample sample;

    tick();
    TEST_ASSERT_FALSE(jp_robot_motors(&robot, &sample));
    enable();
    TEST_ASSERT_TRUE(jp_robot_motors(&robot, &sample));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    for (int i = 0; i < 50; i++) {
        sensors.encoder_left += 3;
        sensors.encoder_right += 5;
        tick();
        TEST_ASSERT_TRUE(jp_robot_motors(&robot, &sample));
    }
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_DRIVING, jp_robot_state_now(&robot));
    TEST_ASSERT_EQUAL_INT32(sensors.current_left, sample.current_left);
    TEST_ASSERT_EQUAL_INT32(sensors.current_right, sample.current_right);
    TEST_ASSERT_EQUAL_INT32(robot.internal.estimator.wheel.rate, sample.wheel_rate);
    TEST_ASSERT_EQUAL_INT32(robot.internal.estimator.yaw.rate, sample.yaw_rate);
    sensors.bus_voltage = INT32_MAX;
    tick();
    TEST_ASSERT_FALSE(jp_robot_motors(&robot, &sample));
}
