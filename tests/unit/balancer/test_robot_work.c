/* Motors that switch off while a segment is planned, by an optimiser of the test's own. */
#include <joulepath/robot.h>

#include "unity.h"

extern const struct jp_robot_config jp_robot_courier24;
extern const struct jp_energy_model jp_energy_model_courier24;

static const struct jp_sensors at_rest = {.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)};
static const struct jp_point route[] = {{JP_Q16(2), 0}, {JP_Q16(4), 0}};

static struct jp_robot_config config;
static struct jp_robot robot;
static enum jp_status optimised;
static void (*meanwhile)(void);

enum jp_status jp_segment_limits_check(const struct jp_segment_limits *limits, const struct jp_energy_model *model,
                                       const char **field)
{
    (void)limits;
    (void)model;
    (void)field;
    return JP_OK;
}

enum jp_status jp_segment_optimise(const struct jp_energy_model *model, const struct jp_segment_limits *limits,
                                   const struct jp_motion *before, const struct jp_point *start, jp_angle heading,
                                   const struct jp_point *target, struct jp_segment *segment)
{
    (void)model;
    (void)limits;
    (void)before;
    (void)start;
    (void)heading;
    (void)target;
    meanwhile();
    *segment = (struct jp_segment){.command = {.motion = {JP_Q24(0.2), 0}, .duration = JP_Q16(1)}};
    return optimised;
}

static void nothing(void)
{
}

static void tick(void)
{
    struct jp_actuation actuation;
    struct jp_sensors frame = at_rest;

    frame.current_left = jp_q16_divide(robot.internal.telemetry.voltages.left, config.monitor.motor_resistance);
    frame.current_right = jp_q16_divide(robot.internal.telemetry.voltages.right, config.monitor.motor_resistance);
    jp_robot_tick(&robot, JP_OK, &frame, &actuation);
}

static void fall(void)
{
    robot.internal.estimator.pitch = JP_PHASE_TURN / 8;
    tick();
}

void setUp(void)
{
    const char *field = "";

    config = jp_robot_courier24;
    config.monitor.freeze_ticks = 0;
    optimised = JP_OK;
    meanwhile = nothing;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_init(&robot, &config, &jp_energy_model_courier24, &field));
    tick();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    tick();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
}

void tearDown(void)
{
}

static void test_a_plan_is_handed_over(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    TEST_ASSERT_EQUAL_UINT16(1, robot.internal.route_planned);
    tick();
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_DRIVING, jp_robot_state_now(&robot));
}

static void test_a_fall_during_the_plan_is_no_failure_of_the_plan(void)
{
    meanwhile = fall;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_FALLEN, jp_robot_state_now(&robot));
    TEST_ASSERT_EQUAL_UINT16(0, robot.internal.route_planned);
    meanwhile = nothing;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    TEST_ASSERT_EQUAL_UINT16(0, robot.internal.route_planned);
}

static void test_a_plan_that_fails_is_told_until_the_next_route(void)
{
    optimised = JP_ERR_INFEASIBLE;
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, jp_robot_work(&robot));
    TEST_ASSERT_EQUAL_UINT16(0, robot.internal.route_planned);
    optimised = JP_OK;
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, jp_robot_work(&robot));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    TEST_ASSERT_EQUAL_UINT16(1, robot.internal.route_planned);
}
