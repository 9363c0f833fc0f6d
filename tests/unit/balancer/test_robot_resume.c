/* A robot that resumes from a snapshot after its controller was reset. */
#include "tests/support/robot_rig.h"

static struct jp_snapshot snapshot;

/* Another controller that knows but the snapshot. */
static void reset(void)
{
    jp_robot_snapshot(&robot, &snapshot);
    init();
    jp_robot_resume(&robot, &snapshot);
    actuation = (struct jp_actuation){0, 0, 0};
}

static void expect_snapshot(bool balancing)
{
    jp_robot_snapshot(&robot, &snapshot);
    TEST_ASSERT_EQUAL_INT(balancing, snapshot.balancing);
    TEST_ASSERT_EQUAL_MEMORY(&robot.internal.estimator, &snapshot.estimator, sizeof snapshot.estimator);
    TEST_ASSERT_EQUAL_MEMORY(&robot.internal.odometry, &snapshot.odometry, sizeof snapshot.odometry);
}

static void test_a_snapshot_tells_whether_the_motors_ran(void)
{
    run(1);
    expect_snapshot(false);
    setUp();
    make_balancing();
    expect_snapshot(true);
    setUp();
    make_driving();
    expect_snapshot(true);
    setUp();
    make_fallen();
    expect_snapshot(false);
    setUp();
    make_fault();
    expect_snapshot(false);
}

/* Wheels that roll, with the currents that belong to them; the robot is off. */
static void roll_in_idle(uint32_t left, uint32_t right, uint32_t ticks)
{
    for (uint32_t i = 0; i < ticks; i++) {
        sensors.encoder_left += left;
        sensors.encoder_right += right;
        run(1);
    }
}

static void test_a_resumed_robot_balances_from_the_first_frame_on(void)
{
    make_driving();
    run(200);
    reset();
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, telemetry().state);
    run(1);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().segment);
    run(2 * RATE);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(1);
    expect_state(JP_ROBOT_DRIVING);
}

static void test_a_resumed_robot_waits_for_a_plausible_frame(void)
{
    make_balancing();
    reset();
    for (int i = 0; i < 2; i++) {
        tick_read(JP_ERR_HARDWARE);
        expect_state(JP_ROBOT_IDLE);
    }
    run(1);
    expect_state(JP_ROBOT_BALANCING);
}

/* A fault is kept until it is disabled, and then it is enabled anew or not at all. */
static void test_a_resumed_robot_whose_sensors_fail_stays_off(void)
{
    make_balancing();
    reset();
    for (int i = 0; i < 10; i++) {
        tick_read(JP_ERR_HARDWARE);
    }
    expect_state(JP_ROBOT_FAULT);
    run(10);
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_UINT8(0, actuation.enabled);
    jp_robot_disable(&robot);
    run(10);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_a_resumed_robot_that_is_disabled_before_it_sees_stays_off(void)
{
    make_balancing();
    reset();
    jp_robot_disable(&robot);
    tick_read(JP_ERR_HARDWARE);
    run(10);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_UINT8(0, actuation.enabled);
}

static void test_a_resumed_robot_knows_where_it_is(void)
{
    struct jp_telemetry before;

    run(1);
    roll_in_idle(30, 40, 2000);
    roll_in_idle(0, 0, 2000);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    expect_state(JP_ROBOT_BALANCING);
    before = telemetry();
    TEST_ASSERT_TRUE(before.position.x != 0 && before.position.y != 0);
    reset();
    run(1);
    TEST_ASSERT_INT32_WITHIN(4, before.position.x, telemetry().position.x);
    TEST_ASSERT_INT32_WITHIN(4, before.position.y, telemetry().position.y);
    TEST_ASSERT_INT32_WITHIN(4, 0, jp_phase_difference(before.motion.yaw, telemetry().motion.yaw));
    TEST_ASSERT_EQUAL_UINT64(telemetry().motion.yaw, telemetry().target_yaw);
}

static void test_a_resumed_robot_counts_the_way_of_the_gap(void)
{
    const uint32_t counts = 300;
    jp_q24 turns;
    struct jp_point before;

    make_balancing();
    before = telemetry().position;
    reset();
    sensors.encoder_left += counts;
    sensors.encoder_right += counts;
    run(1);
    turns = (jp_q24)((2U * counts * config.estimator.wheel_per_count) >> 32);
    TEST_ASSERT_INT32_WITHIN(16, before.x + jp_q24_multiply(turns, config.metres_per_turn) / 256,
                             telemetry().position.x);
    TEST_ASSERT_EQUAL_INT32(before.y, telemetry().position.y);
}

static void test_a_resumed_robot_slows_down_from_its_speed(void)
{
    jp_q24 rate;

    make_balancing();
    robot.internal.estimator.wheel.rate = JP_Q24(0.5);
    robot.internal.estimator.yaw.rate = JP_Q24(-0.1);
    reset();
    robot.internal.estimator.wheel.angle =
        robot.internal.estimator.wheel_encoder - jp_phase_step(JP_Q24(0.5), robot.internal.estimator.phase_per_rate);
    robot.internal.estimator.yaw.angle =
        robot.internal.estimator.yaw_encoder + jp_phase_step(JP_Q24(0.1), robot.internal.estimator.phase_per_rate);
    run(1);
    rate = telemetry().motion.wheel_rate;
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.5), rate);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.005), rate, telemetry().reference_wheel_rate); /* a tick later */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.005), telemetry().motion.yaw_rate, telemetry().reference_yaw_rate);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.wheel.target_rate);
}

static void test_a_robot_that_fell_during_the_reset_switches_off(void)
{
    make_balancing();
    robot.internal.estimator.pitch = JP_PHASE_TURN / 8;
    jp_robot_snapshot(&robot, &snapshot);
    reset();
    run(1);
    expect_state(JP_ROBOT_FALLEN);
}

static void test_a_snapshot_with_motors_off_starts_anew(void)
{
    run(1);
    roll_in_idle(30, 40, 100);
    reset();
    run(1);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().position.x);
    TEST_ASSERT_EQUAL_UINT64(0, telemetry().motion.yaw);
    run(100);
    expect_state(JP_ROBOT_IDLE);
}

static void test_resuming_happens_once(void)
{
    make_balancing();
    reset();
    run(1);
    sensors.bus_voltage = 0;
    run(3);
    sensors.bus_voltage = JP_Q16(24);
    expect_state(JP_ROBOT_FAULT);
    jp_robot_disable(&robot);
    run(10);
    expect_state(JP_ROBOT_IDLE);
}
