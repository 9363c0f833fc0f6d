/* The application without samples, on a bus that refuses its frames, and after a reset. */
#include "tests/support/ecu_rig.h"

/* At 1 kHz. */
#define HOLD_TICKS JP_SAMPLE_HOLD_MS

/* Outages */

static void test_samples_may_stay_away_for_the_hold_ticks(void)
{
    make_balancing();
    for (int i = 0; i < 5; i++) {
        run_without_samples(HOLD_TICKS);
        expect_state(JP_ROBOT_BALANCING);
        run(50);
        expect_state(JP_ROBOT_BALANCING);
    }
    TEST_ASSERT_EQUAL_UINT16(5U * HOLD_TICKS, jp_ecu_lost_samples(&ecu));
    TEST_ASSERT_EQUAL_HEX16(0, jp_robot_last_tick(&balancer.robot)->faults);
}

static void test_samples_that_stay_away_longer_are_a_fault(void)
{
    make_balancing();
    run_without_samples(HOLD_TICKS + config.monitor.confirm_ticks - 1U);
    expect_state(JP_ROBOT_BALANCING);
    run_without_samples(1);
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, jp_robot_last_tick(&balancer.robot)->faults);
    hold(JP_MODE_STAND, 0, 3);
    expect_state(JP_ROBOT_FAULT);
    hold(JP_MODE_OFF, 0, 3);
    expect_state(JP_ROBOT_IDLE);
    hold(JP_MODE_STAND, 0, 1);
    expect_state(JP_ROBOT_BALANCING);
}

/* Of samples that are all the same. */
static void test_only_samples_that_came_can_be_those_of_a_frozen_imu(void)
{
    make_balancing();
    config.monitor.freeze_ticks = 50;
    for (int i = 0; i < 7; i++) {
        run_without_samples(HOLD_TICKS);
        run(7);
        expect_state(JP_ROBOT_BALANCING);
    }
    run_without_samples(HOLD_TICKS);
    run(1);
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_IMU_FROZEN, jp_robot_last_tick(&balancer.robot)->faults);
}

/* Nothing is held over a fault that was cleared: the robot may have been carried elsewhere. */
static void test_samples_that_come_back_after_off_are_taken_as_they_are(void)
{
    sensors.encoder_left = 100000;
    sensors.encoder_right = 90000;
    make_balancing();
    run_without_samples(200);
    expect_state(JP_ROBOT_FAULT);
    for (int i = 0; i < 3; i++) {
        command(JP_MODE_OFF, 0);
        run_without_samples(100);
    }
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, jp_robot_state_now(&balancer.robot));
    sensors.encoder_left += 5000;
    run(1);
    TEST_ASSERT_EQUAL_UINT32(105000, balancer.robot.internal.estimator.encoder_left);
    TEST_ASSERT_EQUAL_UINT32(90000, balancer.robot.internal.estimator.encoder_right);
    run(100);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_HEX16(0, jp_robot_last_tick(&balancer.robot)->faults);
    TEST_ASSERT_EQUAL_INT32(0, jp_robot_last_tick(&balancer.robot)->motion.wheel_rate);
}

static void check_refusals(enum jp_status answer)
{
    setUp();
    make_balancing();
    bus.answer = answer;
    run(HOLD_TICKS);
    bus.answer = JP_OK;
    bus.commands = 0; /* the receiver at the other end begins anew */
    bus.receiver = (struct jp_e2e_receiver){.synchronised = false};
    TEST_ASSERT_GREATER_OR_EQUAL_UINT16(HOLD_TICKS, ecu.send_errors);
    run(100);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_HEX16(0, jp_robot_last_tick(&balancer.robot)->faults);

    bus.answer = answer;
    run(HOLD_TICKS + config.monitor.confirm_ticks);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&balancer.robot));
    run(1); /* what was not written shows in the tick after */
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_FAULT, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, jp_robot_last_tick(&balancer.robot)->faults);
}

static void test_the_bus_may_refuse_frames_for_the_hold_ticks_and_longer_is_a_fault(void)
{
    check_refusals(JP_ERR_BUSY);
    check_refusals(JP_ERR_HARDWARE);
}

static void test_send_errors_saturate(void)
{
    ecu.send_errors = UINT16_MAX;
    bus.answer = JP_ERR_BUSY;
    run(10);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, ecu.send_errors);
}

static void test_each_bus_off_is_counted_once(void)
{
    for (uint8_t i = 1; i <= 3; i++) {
        bus.state = JP_CAN_BUS_OFF;
        run(5);
        TEST_ASSERT_EQUAL_UINT8(i, ecu.bus_offs);
        bus.state = JP_CAN_ON;
        run(5);
        TEST_ASSERT_EQUAL_UINT8(i, ecu.bus_offs);
    }
    bus.state = JP_CAN_DOWN;
    run(5);
    TEST_ASSERT_EQUAL_UINT8(3, ecu.bus_offs);
    ecu.bus_offs = UINT8_MAX;
    bus.state = JP_CAN_BUS_OFF;
    run(5);
    TEST_ASSERT_EQUAL_UINT8(UINT8_MAX, ecu.bus_offs);
}

/* A reset */

static void reset(void)
{
    bus.commands = 0;
    bus.receiver = (struct jp_e2e_receiver){.synchronised = false};
    bus.actuation = (struct jp_actuation){0, 0, 0};
    init();
}

static void test_a_reset_in_motion_balances_from_the_first_sample_on(void)
{
    struct jp_point position;

    make_driving();
    position = jp_robot_position(&balancer.robot);
    reset();
    TEST_ASSERT_EQUAL_UINT32(1, ecu.resets);
    expect_operator(JP_OPERATOR_LOST, JP_MODE_STAND);
    run_without_samples(10);
    TEST_ASSERT_EQUAL_UINT(0, bus.commands);
    (void)give_sample();
    TEST_ASSERT_TRUE(give_sample());
    tick();
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_EQUAL_UINT(1, bus.commands);
    TEST_ASSERT_INT32_WITHIN(8, position.x, jp_robot_position(&balancer.robot).x);
    TEST_ASSERT_INT32_WITHIN(8, position.y, jp_robot_position(&balancer.robot).y);
    run(1000);
    expect_state(JP_ROBOT_BALANCING);
    expect_operator(JP_OPERATOR_LOST, JP_MODE_STAND);
    TEST_ASSERT_EQUAL_HEX8(JP_ROBOT_BALANCING | JP_MODE_STAND << 3 | JP_OPERATOR_LOST << 5, bus.last[0][0]);
    TEST_ASSERT_EQUAL_UINT8(1, bus.last[0][1]);
}

static void test_after_a_reset_drive_needs_a_stand(void)
{
    make_driving();
    reset();
    run(3);
    offer(7, near_route, 2);
    hold(JP_MODE_DRIVE, 7, 10);
    expect_operator(JP_OPERATOR_LOST, JP_MODE_STAND);
    expect_state(JP_ROBOT_BALANCING);
    command(JP_MODE_STAND, 0);
    hold(JP_MODE_DRIVE, 7, 3);
    expect_operator(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
    expect_state(JP_ROBOT_DRIVING);
}

static void test_after_a_reset_off_is_obeyed(void)
{
    make_balancing();
    reset();
    run(3);
    expect_state(JP_ROBOT_BALANCING);
    hold(JP_MODE_OFF, 0, 4);
    expect_state(JP_ROBOT_IDLE);
}

static void test_a_reset_in_idle_stays_idle(void)
{
    run(10);
    reset();
    run(10);
    expect_state(JP_ROBOT_IDLE);
    expect_operator(JP_OPERATOR_NONE, JP_MODE_OFF);
    TEST_ASSERT_EQUAL_UINT32(1, ecu.resets);
}

static void test_resets_are_counted(void)
{
    for (uint32_t i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_UINT32(i, ecu.resets);
        run(3);
        reset();
    }
}

static void test_after_loss_of_power_nothing_goes_on(void)
{
    make_driving();
    memset(&retained, 0xA5, sizeof retained);
    reset();
    run(10);
    expect_state(JP_ROBOT_IDLE);
    expect_operator(JP_OPERATOR_NONE, JP_MODE_OFF);
    TEST_ASSERT_EQUAL_UINT32(0, ecu.resets);
}

/* Writes what the robot would, but for one thing, and resets; true when the controller goes on from it. */
static bool goes_on_from(void (*change)(struct jp_snapshot *))
{
    static union jp_retained_snapshot snapshot;
    bool balancing;

    setUp();
    make_balancing();
    jp_robot_snapshot(&balancer.robot, &snapshot.balancer);
    change(&snapshot.balancer);
    jp_retained_write(&retained, JP_RETAINED_BALANCER, &snapshot, 4);
    reset();
    TEST_ASSERT_EQUAL_UINT32(5, ecu.resets);
    run(3);
    balancing = jp_robot_state_now(&balancer.robot) == JP_ROBOT_BALANCING;
    expect_operator(balancing ? JP_OPERATOR_LOST : JP_OPERATOR_NONE, balancing ? JP_MODE_STAND : JP_MODE_OFF);
    expect_state(balancing ? JP_ROBOT_BALANCING : JP_ROBOT_IDLE);
    return balancing;
}

static void nothing(struct jp_snapshot *snapshot)
{
    (void)snapshot;
}

static void other_wheels(struct jp_snapshot *snapshot)
{
    snapshot->odometry.metres_per_turn++;
}

static void other_tick_rate(struct jp_snapshot *snapshot)
{
    snapshot->estimator.phase_per_rate *= 2;
}

static void wild_bias(struct jp_snapshot *snapshot)
{
    snapshot->estimator.gyro_bias = INT64_MIN;
}

static void wild_position(struct jp_snapshot *snapshot)
{
    snapshot->odometry.y = INT64_MAX;
}

static void no_bool(struct jp_snapshot *snapshot)
{
    memset(&snapshot->balancing, 2, sizeof snapshot->balancing);
}

static void test_only_a_record_that_can_be_this_robots_is_taken_up(void)
{
    TEST_ASSERT_TRUE(goes_on_from(nothing));
    TEST_ASSERT_FALSE(goes_on_from(other_wheels));
    TEST_ASSERT_FALSE(goes_on_from(other_tick_rate));
    TEST_ASSERT_FALSE(goes_on_from(wild_bias));
    TEST_ASSERT_FALSE(goes_on_from(wild_position));
    TEST_ASSERT_FALSE(goes_on_from(no_bool));
}

/* The bits of a sample hold a part of the count: one wheel is beyond it, the other is not. */
static void test_a_reset_keeps_pose_beyond_the_range_of_a_sample(void)
{
    const uint32_t far = 3U << (JP_SAMPLE_COUNT_BITS - 1U);
    struct jp_telemetry before;

    jp_sample_link_resume(&ecu.internal.samples, far, 0);
    sensors.encoder_left = far;
    make_balancing();
    TEST_ASSERT_EQUAL_UINT32(far, balancer.robot.internal.estimator.encoder_left);
    jp_robot_telemetry(&balancer.robot, &before);
    reset();
    run(3);
    TEST_ASSERT_EQUAL_UINT32(far, balancer.robot.internal.estimator.encoder_left);
    TEST_ASSERT_EQUAL_INT32(before.position.x, jp_robot_position(&balancer.robot).x);
    TEST_ASSERT_EQUAL_UINT64(before.motion.yaw, jp_robot_last_tick(&balancer.robot)->motion.yaw);
}
