/* The robot: its configuration; switching on and off from every state. */
#include "tests/support/config_check.h"
#include "tests/support/robot_rig.h"

/* Configuration */

static void test_init_refuses_null(void)
{
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_init(NULL, &config, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_init(&robot, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_init(&robot, &config, NULL));
}

static enum jp_status init_as(const struct jp_robot_config *tried, const char **field)
{
    return jp_robot_init(&robot, tried, field);
}

DEFINE_EXPECT_CONFIG_OF(init_as, jp_robot_courier24)

static void test_init_checks_every_part(void)
{
    const char *field = "";

    expect_config(NULL);
    FIELD(estimator.tilt_gain, -1, "estimator.tilt_gain");
    FIELD(reference.travel_bandwidth, -1, "reference.travel_bandwidth");
    FIELD(lqr.pitch_reserve, -1, "lqr.pitch_reserve");
    FIELD(monitor.tilt_limit, 0, "monitor.tilt_limit");
    FIELD(meter.electronics_power, -1, "meter.electronics_power");
    RANGE("", metres_per_turn, JP_Q24(0.0625), JP_Q24(4));
    FIELD(reference.tick_rate, 999, "estimator.tick_rate");
    FIELD(lqr.tick_rate, 1001, "estimator.tick_rate");
    FIELD(meter.tick_rate, 500, "estimator.tick_rate");
    FIELD(trajectory.tick_rate, 499, "estimator.tick_rate");
    FIELD(trajectory.lag, -1, "trajectory.lag");
    FIELD(limits.speed, 0, "limits.speed");
    config = jp_robot_gao2018;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_init(&robot, &config, &field));
}

/* On and off */

static void test_starts_idle_and_stays(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, telemetry().state);
    run(100);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_UINT32(100, telemetry().tick);
}

static void test_enable_needs_a_frame(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    tick_read(JP_ERR_HARDWARE);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    make_balancing();
}

static void test_enable_is_refused_when_tilted(void)
{
    run(1);
    robot.internal.estimator.pitch = (jp_phase)(uint32_t)config.monitor.tilt_limit << 32;
    robot.internal.estimator.pitch += (jp_phase)1 << 44; /* levelling takes less in a tick */
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    robot.internal.estimator.pitch = 0 - robot.internal.estimator.pitch;
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    robot.internal.estimator.pitch = 3 * JP_PHASE_TURN; /* rolled over on its way back */
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_enable_only_from_idle(void)
{
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    setUp();
    make_driving();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    setUp();
    make_fallen();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    setUp();
    make_fault();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
}

static void test_disable_leads_to_idle_from_every_state(void)
{
    run(1);
    disable();
    setUp();
    make_balancing();
    disable();
    setUp();
    make_driving();
    disable();
    setUp();
    make_fault();
    disable();
    setUp();
    make_fallen();
    robot.internal.estimator.pitch = 0;
    run(1);
    disable();
}

static void test_disable_after_enable_wins(void)
{
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    jp_robot_disable(&robot);
    run(10);
    expect_state(JP_ROBOT_IDLE);

    jp_robot_disable(&robot);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    expect_state(JP_ROBOT_BALANCING);
}
