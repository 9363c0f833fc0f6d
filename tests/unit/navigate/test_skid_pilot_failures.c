/* The pilot of skid steer: routes that cannot be driven, are replaced or end early, and legs that cannot be believed.
 */
#include <joulepath/battery.h>

#include "tests/support/skid_pilot_rig.h"

/* ---- Routes that cannot be driven ---- */

static void expect_failure(const struct jp_point *targets, uint16_t count, enum jp_status expected)
{
    set_up_rig();
    set_up_pilot();
    TEST_ASSERT_EQUAL_INT(JP_OK, follow(targets, count));
    (void)plan();
    expect_phase(JP_SKID_PILOT_RESTING, expected);
    TEST_ASSERT_EQUAL_INT(expected, jp_skid_pilot_answer(&pilot, &forecast));
    run(2);
    TEST_ASSERT_EQUAL_INT(expected, jp_skid_pilot_work(&pilot));
    expect_state(JP_SKID_ROBOT_STANDING);
    TEST_ASSERT_EQUAL_UINT16(0, pilot.legs_begun);
    TEST_ASSERT_EQUAL_UINT32(0, pilot.legs_left_out);
}

static void test_targets_that_coincide_or_are_too_far(void)
{
    const struct jp_point here = {0, 0};
    const struct jp_point twice[] = {square[0], square[1], square[1]};
    const struct jp_point far = {JP_Q16(65), 0};

    expect_failure(&here, 1, JP_ERR_ZERO_LENGTH);
    expect_failure(twice, 3, JP_ERR_ZERO_LENGTH);
    expect_failure(&far, 1, JP_ERR_INFEASIBLE);
}

/* ---- Routes that end early ---- */

/** A second into the second leg of the square. */
static void be_on_the_way(void)
{
    set_up_pilot();
    follow_square();
    (void)plan();
    drive_legs(1, 1);
    run(RATE);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_work(&pilot));
    expect_phase(JP_SKID_PILOT_DRIVING, JP_OK);
}

static void expect_cut(enum jp_status status)
{
    (void)jp_skid_pilot_work(&pilot);
    expect_phase(JP_SKID_PILOT_RESTING, status);
    TEST_ASSERT_EQUAL_INT(JP_EVIDENCE_INCOMPLETE, pilot.evidence);
    TEST_ASSERT_EQUAL_UINT32(1, pilot.legs_left_out);
    TEST_ASSERT_EQUAL_UINT32(1, pilot.learner.state.version);
    TEST_ASSERT_EQUAL_UINT16(1, pilot.legs_ended);
}

static void test_a_stop_ends_the_route(void)
{
    be_on_the_way();
    jp_skid_pilot_stop(&pilot);
    expect_cut(JP_OK);
    run(2 * RATE);
    expect_state(JP_SKID_ROBOT_STANDING);
}

/* In the tick between its end and the stand. */
static void test_a_stop_after_the_last_leg(void)
{
    set_up_pilot();
    follow_square();
    (void)plan();
    drive_legs(SQUARE, 1);
    expect_phase(JP_SKID_PILOT_DRIVING, JP_OK);
    jp_skid_pilot_stop(&pilot);
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    TEST_ASSERT_EQUAL_UINT32(0, pilot.legs_left_out);
}

/* Before the tick has taken the path up. */
static void test_a_stop_before_the_robot_begins(void)
{
    set_up_pilot();
    follow_square();
    (void)plan();
    jp_skid_pilot_stop(&pilot);
    run(2);
    expect_state(JP_SKID_ROBOT_STANDING);
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    TEST_ASSERT_EQUAL_UINT32(1, pilot.legs_left_out);
}

static void test_a_stop_while_it_plans(void)
{
    set_up_pilot();
    follow_square();
    (void)jp_skid_pilot_work(&pilot);
    jp_skid_pilot_stop(&pilot);
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_skid_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_EQUAL_UINT32(0, pilot.legs_left_out);
}

static void test_a_stop_of_others_ends_the_route(void)
{
    be_on_the_way();
    jp_skid_robot_stop(&robot);
    drive_to_rest();
    expect_cut(JP_ERR_STATE);
    expect_state(JP_SKID_ROBOT_STANDING);
}

static void test_a_stop_of_others_before_the_robot_begins(void)
{
    set_up_pilot();
    follow_square();
    (void)plan();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_work(&pilot)); /* it waits */
    jp_skid_robot_stop(&robot);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_pilot_work(&pilot));
    expect_phase(JP_SKID_PILOT_RESTING, JP_ERR_STATE);
}

static void test_a_command_of_others_ends_the_route(void)
{
    be_on_the_way();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &one_second));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_work(&pilot)); /* no tick has taken it up */
    run(1);
    expect_cut(JP_ERR_STATE);
}

static void test_a_disable_ends_the_route(void)
{
    be_on_the_way();
    jp_skid_robot_disable(&robot);
    run(1);
    expect_cut(JP_ERR_STATE);
}

static void test_a_disable_ends_the_planning(void)
{
    set_up_pilot();
    follow_square();
    (void)jp_skid_pilot_work(&pilot);
    jp_skid_robot_disable(&robot);
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_pilot_work(&pilot));
    expect_phase(JP_SKID_PILOT_RESTING, JP_ERR_STATE);
    TEST_ASSERT_EQUAL_UINT32(0, pilot.legs_left_out);
}

static void test_a_fault_ends_the_route(void)
{
    be_on_the_way();
    sensors.bus_voltage = 0;
    run(3);
    expect_cut(JP_ERR_STATE);
    expect_state(JP_SKID_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, follow(square, 1));
}

/* ---- Routes that are replaced ---- */

/* The robot brakes, and the new route begins where it stands then. */
static void test_a_route_replaces_another(void)
{
    static const struct jp_point other[] = {{JP_Q16(3), JP_Q16(1)}};

    be_on_the_way();
    TEST_ASSERT_EQUAL_INT(JP_OK, follow(other, 1));
    TEST_ASSERT_EQUAL_UINT32(1, pilot.legs_left_out);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_work(&pilot));
    TEST_ASSERT_FALSE(pilot.internal.is_laid);
    drive_to_rest();
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    expect_near(&other[0]);
    TEST_ASSERT_EQUAL_UINT16(1, pilot.legs_ended);
    TEST_ASSERT_EQUAL_UINT32(2, pilot.legs_learned_from);
}

static void test_a_turn_replaces_a_route(void)
{
    be_on_the_way();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_turn(&pilot, JP_ANGLE_DEGREES(180), NULL));
    drive_to_rest();
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    TEST_ASSERT_INT32_WITHIN((int32_t)JP_ANGLE_DEGREES(1), 0,
                             (int32_t)(jp_phase_angle(telemetry().heading) - JP_ANGLE_DEGREES(180)));
}

/* A command of others that waits when the route comes is forgotten. */
static void test_what_waits_is_forgotten(void)
{
    set_up_pilot();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &one_second));
    TEST_ASSERT_EQUAL_INT(JP_OK, follow(square, 1));
    TEST_ASSERT_FALSE(jp_skid_robot_has_next(&robot));
    drive_to_rest();
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    expect_near(&square[0]);
}

/* While others hand over a command the planning waits. */
static void test_planning_waits_for_what_waits(void)
{
    set_up_pilot();
    follow_square();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &one_second));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_work(&pilot));
    TEST_ASSERT_FALSE(pilot.internal.is_laid);
}

/* ---- Legs that cannot be believed ---- */

static void drive_a_leg(void)
{
    drive_to_rest();
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    TEST_ASSERT_EQUAL_UINT16(1, pilot.legs_ended);
}

static void begin_a_leg(void)
{
    set_up_rig();
    set_up_pilot();
    TEST_ASSERT_EQUAL_INT(JP_OK, follow(square, 1));
    (void)plan();
}

static void expect_left_out(enum jp_evidence evidence)
{
    drive_a_leg();
    TEST_ASSERT_EQUAL_INT(evidence, pilot.evidence);
    TEST_ASSERT_EQUAL_UINT32(1, pilot.legs_left_out);
    TEST_ASSERT_EQUAL_UINT32(0, pilot.legs_learned_from);
    TEST_ASSERT_EQUAL_UINT32(0, pilot.learner.state.version);
}

static void test_evidence(void)
{
    begin_a_leg();
    pilot.battery_flags = JP_BATTERY_VOLTAGE_LOW;
    expect_left_out(JP_EVIDENCE_BATTERY);
    begin_a_leg();
    robot.internal.saturated_ticks = 1000;
    expect_left_out(JP_EVIDENCE_SATURATED);
    begin_a_leg();
    robot.internal.monitor.dropped_frames = 1000;
    expect_left_out(JP_EVIDENCE_DROPPED);
}

/* An energy that has no format is no evidence against the sensors, and yet teaches nothing. */
static void test_a_leg_whose_energy_has_no_format(void)
{
    begin_a_leg();
    pilot.internal.watch.drive.on[0].energy = (int64_t)1 << 40;
    expect_left_out(JP_EVIDENCE_GOOD);
}
