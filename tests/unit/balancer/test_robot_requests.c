/* Requests that meet a robot which cannot serve them: they leave it as it is. What is known before the first tick.
 * Where it will be when what it drives ends. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "unity.h"

static const struct jp_sensors at_rest = {.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)};
static const struct jp_sensors without_power = {.accel_z = JP_Q24_ONE, .bus_voltage = 0};

static struct jp_robot_config config;
static struct jp_robot robot;
static struct jp_actuation actuation;

static void init(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_init(&robot, &config, &field));
}

void setUp(void)
{
    config = jp_robot_courier24;
    config.monitor.freeze_ticks = 0;
    init();
}

void tearDown(void)
{
}

static void run(const struct jp_sensors *sensors, enum jp_status read, unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        struct jp_sensors frame = *sensors;
        frame.current_left = jp_q16_divide(robot.internal.telemetry.voltages.left, config.monitor.motor_resistance);
        frame.current_right = jp_q16_divide(robot.internal.telemetry.voltages.right, config.monitor.motor_resistance);
        jp_robot_tick(&robot, read, &frame, &actuation);
    }
}

static struct jp_telemetry telemetry(void)
{
    struct jp_telemetry copy;

    jp_robot_telemetry(&robot, &copy);
    return copy;
}

/* The robot was idle when it was asked, and a fault came first. */
static void test_fault_before_the_request_is_seen(void)
{
    run(&at_rest, JP_OK, 1);
    run(&without_power, JP_OK, 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(&without_power, JP_OK, 1);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_FAULT, telemetry().state);
    TEST_ASSERT_EQUAL_UINT8(0, actuation.enabled);
    run(&at_rest, JP_OK, 10);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_FAULT, telemetry().state);
    TEST_ASSERT_EQUAL_UINT8(0, actuation.enabled);
}

/* Written by hand, since jp_robot_enable() refuses before the first frame. */
static void test_request_before_the_first_frame(void)
{
    robot.internal.enable_requested = 1;
    run(&at_rest, JP_ERR_STATE, 1);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, telemetry().state);
    run(&at_rest, JP_OK, 3);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, telemetry().state);
    TEST_ASSERT_EQUAL_UINT8(0, actuation.enabled);
}

/* A gyro that turns by its bias while the robot stands: known from the first tick, or yet to be learned. */
static void test_bias_that_is_known(void)
{
    const jp_q24 offset = JP_Q24(0.001);
    struct jp_sensors biased = at_rest;

    biased.pitch_rate = offset;
    run(&biased, JP_OK, 2);
    TEST_ASSERT_INT32_WITHIN(offset / 20, offset, telemetry().motion.pitch_rate);
    init();
    jp_robot_know_gyro_bias(&robot, (int64_t)offset * ((int64_t)1 << 32));
    run(&biased, JP_OK, 2);
    TEST_ASSERT_INT32_WITHIN(offset / 20, 0, telemetry().motion.pitch_rate);
}

static void balance(void)
{
    run(&at_rest, JP_OK, 1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(&at_rest, JP_OK, 1);
}

static void test_null_is_refused(void)
{
    const struct jp_segment_command segment = {.duration = JP_Q16(1)};

    balance();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_enable(NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_drive(NULL, &segment));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_drive(&robot, NULL));
}

/* As a HAL that asks from its write(): between the two halves of the tick. */
static void test_within_a_tick_there_is_no_copy(void)
{
    const uint32_t tick = telemetry().tick;
    struct jp_telemetry copy;
    struct jp_motor_sample sample;

    balance();
    run(&at_rest, JP_OK, 3);
    jp_robot_control(&robot, JP_OK, &at_rest, &actuation);
    TEST_ASSERT_FALSE(jp_robot_telemetry(&robot, &copy));
    TEST_ASSERT_FALSE(jp_robot_motors(&robot, &sample));
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&robot));
    jp_robot_account(&robot);
    TEST_ASSERT_TRUE(jp_robot_telemetry(&robot, &copy));
    TEST_ASSERT_TRUE(jp_robot_motors(&robot, &sample));
    TEST_ASSERT_EQUAL_UINT32(tick + 6U, copy.tick);
}

/* A quarter turn to the left at 0.1 m/s in 1 s leads 64 mm ahead and as much aside. */
static void test_the_end_of_a_segment_is_foretold(void)
{
    const struct jp_segment_command quarter = {.motion = {JP_Q24(0.1), JP_Q24(1.5707963)}, .duration = JP_Q16(1)};
    struct jp_telemetry now;
    struct jp_point end;
    jp_angle heading;

    balance();
    now = telemetry();
    jp_robot_predict_end(&robot, &now, &end, &heading);
    TEST_ASSERT_INT32_WITHIN(10, 0, end.x);
    TEST_ASSERT_INT32_WITHIN(10, 0, end.y);
    TEST_ASSERT_EQUAL_HEX32(0, heading);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &quarter));
    run(&at_rest, JP_OK, 1);
    now = telemetry();
    jp_robot_predict_end(&robot, &now, &end, &heading);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.008), JP_Q16(0.0637), end.x);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.008), JP_Q16(0.0637), end.y);
    TEST_ASSERT_INT32_WITHIN(1 << 22, 1 << 30, (int32_t)heading);
}
