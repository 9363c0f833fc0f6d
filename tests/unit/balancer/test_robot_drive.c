/* Segments that a robot drives: to the tick, one of them waiting, with their energies; stop. */
#include "tests/support/robot_rig.h"

static void test_drive_refuses_what_is_out_of_range(void)
{
    struct jp_segment_command segment = one_second;

    make_balancing();
#define REFUSED(member, value)                                                                                         \
    do {                                                                                                               \
        segment = one_second;                                                                                          \
        segment.member = (value);                                                                                      \
        TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_drive(&robot, &segment));                                      \
    } while (0)
    REFUSED(motion.speed, config.limits.speed + 1);
    REFUSED(motion.speed, -config.limits.speed - 1);
    REFUSED(motion.speed, INT32_MIN);
    REFUSED(motion.turn_rate, JP_Q24(8) + 1);
    REFUSED(motion.turn_rate, INT32_MIN);
    REFUSED(turn, JP_Q24(6.283185307179586) + 1);
    REFUSED(turn, -JP_Q24(6.283185307179586) - 1);
    REFUSED(duration, 0);
    REFUSED(duration, -1);
    REFUSED(duration, JP_Q16(16384) + 1);
#undef REFUSED
    segment = (struct jp_segment_command){{-config.limits.speed, -JP_Q24(8)}, JP_Q24(6.283185307179586), JP_Q16(16384)};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &segment));
    run(1);
    TEST_ASSERT_EQUAL_UINT32(16384U * RATE - 1U, telemetry().segment_ticks_left);
}

static void test_drive_needs_running_motors(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_drive(&robot, &one_second));
    make_fallen();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_drive(&robot, &one_second));
    setUp();
    make_fault();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_drive(&robot, &one_second));
}

static void test_one_segment_may_wait(void)
{
    make_driving();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    TEST_ASSERT_EQUAL_INT(JP_ERR_BUSY, jp_robot_drive(&robot, &one_second));
    run(RATE);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segment);
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().segments_ended);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
}

/** Ticks in state driving. */
static uint32_t driven_ticks(jp_q16 duration)
{
    const struct jp_segment_command segment = {{JP_Q24(0.1), 0}, 0, duration};
    uint32_t ticks = 0;

    setUp();
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &segment));
    for (run(1); telemetry().state == JP_ROBOT_DRIVING; run(1)) {
        ticks++;
        TEST_ASSERT_EQUAL_INT32(segment.motion.speed, telemetry().command.speed);
    }
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().command.speed);
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().segments_ended);
    return ticks;
}

static void test_segments_last_to_the_tick(void)
{
    TEST_ASSERT_EQUAL_UINT32(1000, driven_ticks(JP_Q16(1)));
    TEST_ASSERT_EQUAL_UINT32(125, driven_ticks(JP_Q16(0.125)));
    TEST_ASSERT_EQUAL_UINT32(2, driven_ticks(JP_Q16(0.002)));
    TEST_ASSERT_EQUAL_UINT32(2, driven_ticks(JP_Q16(0.0016)));
    TEST_ASSERT_EQUAL_UINT32(1, driven_ticks(JP_Q16(0.0014)));
    TEST_ASSERT_EQUAL_UINT32(1, driven_ticks(1));
}

static void test_segment_steps_the_reference(void)
{
    const struct jp_segment_command segment = {{JP_Q24(0.5), JP_Q24(0.2)}, JP_Q24(1), JP_Q16(0.5)};

    make_balancing();

    jp_phase heading = telemetry().target_yaw;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &segment));
    run(1);
    TEST_ASSERT_INT32_WITHIN(2000, JP_Q24(0.15915494309189535), jp_phase_difference(telemetry().target_yaw, heading));
    TEST_ASSERT_EQUAL_INT32(jp_q24_multiply(JP_Q24(0.5), config.reference.turns_per_metre),
                            robot.internal.reference.wheel.target_rate);
    run(500);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.wheel.target_rate);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.yaw.target_rate);
    /* σ + w T = 1.1 rad */
    TEST_ASSERT_INT32_WITHIN(200, JP_Q24(0.17507043740108488), jp_phase_difference(telemetry().target_yaw, heading));
}

static void test_energies_of_segments_add_up_to_the_meter(void)
{
    jp_energy sum_model = 0;
    jp_energy sum_battery = 0;

    make_balancing();

    jp_energy start_model = telemetry().energy_model;
    jp_energy start_battery = telemetry().energy_battery;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(1);
    start_model = telemetry().energy_model;
    start_battery = telemetry().energy_battery;
    for (int segment = 0; segment < 5; segment++) {
        if (segment < 4) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
        }
        run(RATE);
        TEST_ASSERT_EQUAL_UINT16(segment + 1, telemetry().segments_ended);
        TEST_ASSERT_GREATER_THAN_INT64(0, telemetry().segment_energy_model);
        sum_model += telemetry().segment_energy_model;
        sum_battery += telemetry().segment_energy_battery;
    }
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_INT64(telemetry().energy_model - start_model, sum_model);
    TEST_ASSERT_EQUAL_INT64(telemetry().energy_battery - start_battery, sum_battery);
}

static void test_counts_restart_when_the_robot_stood(void)
{
    make_driving();
    run(RATE);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().segment);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(1);
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().segment);
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().segments_ended);
    robot.internal.telemetry.segment = UINT16_MAX;
    robot.internal.telemetry.segments_ended = UINT16_MAX;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(RATE);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, telemetry().segment);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, telemetry().segments_ended);
}

static void test_stop_stands_at_once_and_drops_the_waiting_segment(void)
{
    make_driving();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    jp_robot_stop(&robot);
    run(1);
    expect_state(JP_ROBOT_BALANCING);
    run(2 * RATE);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.wheel.target_rate);
}

static void test_drive_after_stop_is_driven(void)
{
    make_driving();
    jp_robot_stop(&robot);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(2);
    expect_state(JP_ROBOT_DRIVING);
    TEST_ASSERT_EQUAL_UINT32(RATE - 1U, telemetry().segment_ticks_left);
}

static void test_nothing_waits_over_a_disable(void)
{
    make_driving();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    disable(); /* balancing again, and stays so */

    robot.internal.next_full = 1; /* handed over while the tick switched off */
    jp_robot_disable(&robot);
    run(2);
    robot.internal.next_full = 1;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(5);
    expect_state(JP_ROBOT_BALANCING);
}
