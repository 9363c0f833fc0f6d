/* Requests that meet a robot which cannot serve them: they leave it as it is. Work without anything to plan. What is
 * known before the first tick. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "unity.h"

static const struct jp_sensors at_rest = {.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)};
static const struct jp_sensors without_power = {.accel_z = JP_Q24_ONE, .bus_voltage = 0};
static const struct jp_point corner[] = {{JP_Q16(2), 0}, {JP_Q16(4), JP_Q16(1.5)}};

static struct jp_robot_config config;
static struct jp_robot robot;
static struct jp_actuation actuation;

static void init(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_init(&robot, &config, &jp_energy_model_courier24, &field));
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

static void follow_corner(void)
{
    run(&at_rest, JP_OK, 1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(&at_rest, JP_OK, 1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, corner, 2));
}

/* A segment that waits for its tick is not planned over. */
static void test_no_work_while_a_segment_waits(void)
{
    follow_corner();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    const uint32_t planned = robot.internal.route_planned;
    const struct jp_next_segment waiting = robot.internal.next;
    TEST_ASSERT_EQUAL_UINT32(1, planned);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    TEST_ASSERT_EQUAL_UINT32(planned, robot.internal.route_planned);
    TEST_ASSERT_EQUAL_MEMORY(&waiting, &robot.internal.next, sizeof waiting);
    run(&at_rest, JP_OK, 1);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_DRIVING, telemetry().state);
}

/* Ticks until the second segment is planned while the first is driven. */
static void plan_second(void)
{
    follow_corner();
    for (unsigned i = 0; i < 100000 && robot.internal.route_planned < 2U; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
        run(&at_rest, JP_OK, 1);
    }
    TEST_ASSERT_EQUAL_UINT32(2, robot.internal.route_planned);
    TEST_ASSERT_TRUE(telemetry().command.speed > 0);
}

/* A tracker without a bandwidth turns at once: the next segment begins where the robot is, not further on. */
static void test_turn_without_a_tracker(void)
{
    config.reference.yaw_bandwidth = 0;
    init();
    plan_second();
    const jp_q24 at_once = robot.internal.planned.command.turn;
    config = jp_robot_courier24;
    config.monitor.freeze_ticks = 0;
    init();
    plan_second();
    TEST_ASSERT_TRUE(at_once != robot.internal.planned.command.turn);
}

static void test_null_is_refused(void)
{
    const struct jp_segment_command segment = {.duration = JP_Q16(1)};

    follow_corner();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_enable(NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_drive(NULL, &segment));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_drive(&robot, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_follow(NULL, corner, 2));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_follow(&robot, NULL, 2));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_work(NULL));
}

/* As a HAL that asks from its write(): between the two halves of the tick. */
static void test_within_a_tick_there_is_no_copy(void)
{
    const uint32_t tick = telemetry().tick;
    struct jp_telemetry copy;
    struct jp_motor_sample sample;

    follow_corner();
    run(&at_rest, JP_OK, 3);
    jp_robot_control(&robot, JP_OK, &at_rest, &actuation);
    TEST_ASSERT_FALSE(jp_robot_telemetry(&robot, &copy));
    TEST_ASSERT_FALSE(jp_robot_motors(&robot, &sample));
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&robot));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    TEST_ASSERT_EQUAL_UINT16(0, robot.internal.route_planned);
    jp_robot_account(&robot);
    TEST_ASSERT_TRUE(jp_robot_telemetry(&robot, &copy));
    TEST_ASSERT_TRUE(jp_robot_motors(&robot, &sample));
    TEST_ASSERT_EQUAL_UINT32(tick + 6U, copy.tick);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    TEST_ASSERT_EQUAL_UINT16(1, robot.internal.route_planned);
}
