/* A balancer as a vehicle: its phases, turns on the spot, runs, and what it refuses. */
#include "tests/support/balancer_vehicle_rig.h"

/* ---- Arguments ---- */

static void test_null_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_balancer_vehicle_init(NULL, &pilot, &vehicle));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_balancer_vehicle_init(&balancer, NULL, &vehicle));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_balancer_vehicle_init(&balancer, &pilot, NULL));
}

/* ---- Phases ---- */

static void test_off_until_it_is_enabled(void)
{
    begin();
    expect_phase(JP_VEHICLE_OFF);
    expect_refusal();
    balance();
    expect_phase(JP_VEHICLE_STANDING);
    jp_robot_disable(&robot);
    tick();
    expect_phase(JP_VEHICLE_OFF);
    expect_refusal();
}

static void test_a_robot_that_stands(void)
{
    begin_balancing();
    for (unsigned i = 0; i < 100U; i++) {
        live();
        expect_phase(JP_VEHICLE_STANDING);
    }
}

/* Pushed, it rolls on either way. */
static void test_a_robot_that_rolls_is_moving(void)
{
    begin_balancing();
    for (int sign = -1; sign <= 1; sign += 2) {
        robot.internal.telemetry.motion.wheel_rate = sign * JP_Q24(0.1);
        expect_phase(JP_VEHICLE_MOVING);
        expect_refusal();
    }
    robot.internal.telemetry.motion.wheel_rate = JP_Q24(0.02);
    expect_phase(JP_VEHICLE_STANDING);
}

/* Between the two parts of a tick nothing is known. */
static void test_a_look_within_a_tick(void)
{
    struct jp_actuation actuation;

    begin_balancing();
    jp_robot_control(&robot, JP_OK, &sensors, &actuation);
    expect_phase(UNKNOWN);
    expect_refusal();
    jp_robot_account(&robot);
    expect_phase(JP_VEHICLE_STANDING);
}

/* ---- Turns ---- */

static void test_a_turn(void)
{
    const jp_angle headings[] = {JP_ANGLE_DEGREES(60), JP_ANGLE_DEGREES(-10), 0};

    begin_balancing();
    for (size_t i = 0; i < sizeof headings / sizeof headings[0]; i++) {
        TEST_ASSERT_EQUAL_INT32(JP_OK, vehicle.turn(vehicle.context, headings[i], NULL));
        expect_phase(JP_VEHICLE_MOVING);
        expect_refusal();
        tick();
        expect_phase(JP_VEHICLE_MOVING);
        expect_refusal();
        (void)live_until_stand();
        expect_heading(headings[i]);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), 0, look().position.x);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), 0, look().position.y);
    }
}

/* It comes back to the heading that it was to keep, and the turn counts from there. */
static void test_a_turn_of_a_robot_that_was_pushed_round(void)
{
    begin_balancing();
    robot.internal.telemetry.motion.yaw = JP_PHASE_TURN / 72;
    TEST_ASSERT_EQUAL_INT32(JP_OK, vehicle.turn(vehicle.context, JP_ANGLE_DEGREES(60), NULL));
    (void)live_until_stand();
    expect_heading(JP_ANGLE_DEGREES(60));
}

/* By at most 80° at once; the calls that it took. */
static unsigned turn_in_parts(jp_angle heading)
{
    const jp_angle most = jp_angle_from_radians(robot_config.limits.turn);
    unsigned calls = 0;

    while ((uint32_t)(look().heading - heading + DEGREE) > 2U * DEGREE && calls < 9U) {
        const jp_angle before = look().heading;

        TEST_ASSERT_EQUAL_INT32(JP_OK, vehicle.turn(vehicle.context, heading, NULL));
        (void)live_until_stand();
        TEST_ASSERT_INT32_WITHIN((int32_t)(most + DEGREE), 0, (int32_t)(look().heading - before));
        calls++;
    }
    expect_heading(heading);
    return calls;
}

static void test_large_turns_take_several_calls(void)
{
    begin_balancing();
    TEST_ASSERT_EQUAL_UINT32(2, turn_in_parts(JP_ANGLE_DEGREES(90)));
    TEST_ASSERT_EQUAL_UINT32(3, turn_in_parts(JP_ANGLE_DEGREES(-80)));
    TEST_ASSERT_EQUAL_UINT32(3, turn_in_parts(JP_ANGLE_DEGREES(110)));
}

static uint32_t ticks_of_turn(jp_q16 bandwidth)
{
    robot_config.reference.yaw_bandwidth = bandwidth;
    begin_balancing();
    TEST_ASSERT_EQUAL_INT32(JP_OK, vehicle.turn(vehicle.context, JP_ANGLE_DEGREES(30), NULL));
    tick();
    return telemetry().segment_ticks_left;
}

/* Ten time constants of a shaped heading; without one, what the model's turns take to settle. */
static void test_how_long_a_turn_takes(void)
{
    TEST_ASSERT_UINT32_WITHIN(2, 5400, ticks_of_turn(0));
    model.settling_time = JP_Q16(3);
    TEST_ASSERT_UINT32_WITHIN(2, 3000, ticks_of_turn(0));
    TEST_ASSERT_UINT32_WITHIN(2, 2500, ticks_of_turn(JP_Q16(4)));
    TEST_ASSERT_UINT32_WITHIN(2, 125, ticks_of_turn(JP_Q16(100)));
}

static void test_a_turn_that_is_shaped(void)
{
    shape_reference();
    begin_balancing();
    TEST_ASSERT_EQUAL_UINT32(1, turn_in_parts(JP_ANGLE_DEGREES(70)));
    TEST_ASSERT_EQUAL_UINT32(2, turn_in_parts(JP_ANGLE_DEGREES(-20)));
}

/* Its segment is over, and it still turns. */
static void test_a_turn_that_has_not_settled(void)
{
    const struct jp_segment_command brief = {.turn = JP_Q24(1), .duration = JP_Q16(0.3)};
    struct jp_segment_command back = brief;

    back.turn = -brief.turn;
    shape_reference();
    begin_balancing();
    for (int i = 0; i < 2; i++) {
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_robot_drive(&robot, i == 0 ? &brief : &back));
        ticks(305);
        TEST_ASSERT_EQUAL_INT32(JP_ROBOT_BALANCING, telemetry().state);
        expect_phase(JP_VEHICLE_MOVING);
        TEST_ASSERT_GREATER_THAN_UINT32(100, live_until_stand());
    }
}

/* ---- Runs ---- */

static void test_a_run(void)
{
    begin_balancing();
    TEST_ASSERT_EQUAL_INT32(JP_OK, vehicle.turn(vehicle.context, jp_atan2(aside[0].y, aside[0].x), NULL));
    (void)live_until_stand();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow_run(aside, 2));
    expect_phase(JP_VEHICLE_MOVING);
    expect_refusal();
    live_until_driving();
    expect_phase(JP_VEHICLE_MOVING);
    expect_refusal();
    while (telemetry().segments_ended == 0U) {
        live();
    }
    expect_near(&aside[0]);
    (void)live_until_stand();
    expect_near(&aside[1]);
    TEST_ASSERT_EQUAL_INT32(telemetry().position.x, look().position.x);
    TEST_ASSERT_EQUAL_INT32(telemetry().position.y, look().position.y);
    TEST_ASSERT_EQUAL_UINT32(jp_phase_angle(telemetry().motion.yaw), look().heading);
    TEST_ASSERT_EQUAL_INT32(jp_energy_to_wrapping_q16(telemetry().energy_model, pilot.config.model->unit_exponent),
                            look().spent);
    pilot.config.meter = JP_PILOT_BATTERY;
    TEST_ASSERT_EQUAL_INT32(jp_energy_to_wrapping_q16(telemetry().energy_battery, pilot.config.model->unit_exponent),
                            look().spent);
}

static void test_two_runs(void)
{
    begin_balancing();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow_run(straight, 1));
    (void)live_until_stand();
    expect_near(&straight[0]);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow_run(&bend[1], 2));
    (void)live_until_stand();
    expect_near(&bend[2]);
}

static void test_runs_without_targets_are_refused(void)
{
    begin_balancing();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, follow_run(NULL, 1));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, follow_run(aside, 0));
    expect_phase(JP_VEHICLE_STANDING);
}

/* It brakes for a while, and is driven again from the stand. */
static void test_stop_ends_a_run(void)
{
    shape_reference();
    begin_balancing();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow_run(straight, 1));
    live_until_driving();
    ticks(1500);
    vehicle.stop(vehicle.context);
    expect_phase(JP_VEHICLE_MOVING);
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_BALANCING, telemetry().state);
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
    robot.internal.telemetry.motion.wheel_rate = 0; /* what it is to do counts too */
    expect_phase(JP_VEHICLE_MOVING);
    expect_refusal();
    TEST_ASSERT_GREATER_THAN_UINT32(500, live_until_stand());
    TEST_ASSERT_LESS_THAN_INT32(JP_Q16(1.4), look().position.x);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow_run(straight, 1));
    (void)live_until_stand();
    expect_near(&straight[0]);
}

static void test_stop_ends_a_turn(void)
{
    begin_balancing();
    TEST_ASSERT_EQUAL_INT32(JP_OK, vehicle.turn(vehicle.context, JP_ANGLE_DEGREES(60), NULL));
    vehicle.stop(vehicle.context);
    tick();
    expect_phase(JP_VEHICLE_STANDING);
    expect_heading(0);
}

/* Driven back by somebody else. */
static void test_a_robot_that_brakes_backwards(void)
{
    const struct jp_segment_command back = {{-JP_Q24(0.3), 0}, 0, JP_Q16(2)};

    shape_reference();
    begin_balancing();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_robot_drive(&robot, &back));
    ticks(2500);
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_BALANCING, telemetry().state);
    robot.internal.telemetry.motion.wheel_rate = 0;
    expect_phase(JP_VEHICLE_MOVING);
    (void)live_until_stand();
}

static void test_work_tells_what_the_pilot_cannot_do(void)
{
    begin_balancing();
    TEST_ASSERT_EQUAL_INT32(JP_OK, vehicle.work(vehicle.context));
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow_run(&origin, 1));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ZERO_LENGTH, vehicle.work(vehicle.context));
    expect_phase(JP_VEHICLE_STANDING);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow_run(aside, 2));
    live_until_driving();
    jp_robot_stop(&robot);
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, vehicle.work(vehicle.context));
}

static void test_a_run_that_is_slower_than_can_be_is_refused(void)
{
    const struct jp_vehicle_run run = {.targets = straight, .count = 1, .slower = JP_PILOT_SLOWER_MAX + 1U};

    begin_balancing();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, vehicle.follow(vehicle.context, &run));
}
