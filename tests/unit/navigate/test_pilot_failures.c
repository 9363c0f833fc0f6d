/* The pilot: plans that fail or come late, motors that are switched off. */

#include "tests/support/pilot_rig.h"

static void expect_failure(const struct jp_point *targets, uint16_t count, enum jp_status expected)
{
    enum jp_status status;

    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(targets, count));
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(expected, status);
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
    TEST_ASSERT_EQUAL_INT32(expected, jp_pilot_answer(&pilot, &forecast));
    ticks(2);
    TEST_ASSERT_EQUAL_INT32(expected, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_BALANCING, telemetry().state);
}

static void test_target_where_the_robot_stands(void)
{
    const struct jp_point here = {0, 0};

    balance();
    expect_failure(&here, 1, JP_ERR_ZERO_LENGTH);
}

/* Nothing is driven before the whole route can be. */
static void test_last_targets_that_coincide(void)
{
    const struct jp_point twice[] = {slalom[0], slalom[1], slalom[2], slalom[2]};

    balance();
    expect_failure(twice, 4, JP_ERR_ZERO_LENGTH);
    TEST_ASSERT_EQUAL_UINT16(0, pilot.targets_planned);
}

static void test_target_out_of_reach(void)
{
    const struct jp_point far = {JP_Q16(600), 0};

    balance();
    expect_failure(&far, 1, JP_ERR_ARGUMENT);
}

static void test_motors_without_voltage_for_the_motion(void)
{
    robot_config.trajectory.voltage = 1;
    init();
    balance();
    expect_failure(slalom, 2, JP_ERR_INFEASIBLE);
}

/* 4 V are less than the cruise of least energy takes. */
static void test_what_cannot_be_driven_at_cruising_speed_is_driven_slower(void)
{
    robot_config.trajectory.voltage = JP_Q16(4);
    init();
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 2));
    drive(slalom, 2);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT8(1, pilot.internal.slower);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 2));
    TEST_ASSERT_EQUAL_UINT8(0, pilot.internal.slower);
}

static void test_failure_is_forgotten_with_the_next_route(void)
{
    const struct jp_point here = {0, 0};

    balance();
    expect_failure(&here, 1, JP_ERR_ZERO_LENGTH);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 2));
    drive(slalom, 2);
    expect_rest();
}

/* The robot drives the leg to its end, and the next route goes on from there. */
static void test_failure_on_the_way(void)
{
    const struct jp_point far = {JP_Q16(600), 0};
    enum jp_status status;

    balance();
    follow_slalom();
    work_until_driving();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(&far, 1));
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, status);
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_DRIVING, telemetry().state);
    while (telemetry().state == JP_ROBOT_DRIVING) {
        TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_work(&pilot));
        tick();
    }
    expect_near(&slalom[0]);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_UINT32(1, pilot.legs_learned_from);
}

/* The targets' memory changed under way. */
static void test_a_leg_that_fails_when_it_is_driven(void)
{
    struct jp_point targets[] = {slalom[0], slalom[1], slalom[2], slalom[3], {JP_Q16(60), 0}};
    enum jp_status status = JP_OK;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(targets, 5));
    work_until_driving();
    targets[4] = targets[3];
    while (status == JP_OK) {
        tick();
        status = jp_pilot_work(&pilot);
    }
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ZERO_LENGTH, status);
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
    TEST_ASSERT_EQUAL_UINT16(1, pilot.targets_planned);
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_DRIVING, telemetry().state);
}

/* They changed when the whole route was planned: the route that is driven is not gone on with. */
static void test_a_new_route_that_changes_before_it_is_taken(void)
{
    struct jp_point targets[] = {aside[0], aside[1]};

    balance();
    follow_slalom();
    work_until_driving();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(targets, 2));
    for (unsigned i = 0; i < 3U; i++) {
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    }
    TEST_ASSERT_EQUAL_UINT16(2, pilot.targets_surveyed);
    targets[1] = targets[0];
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ZERO_LENGTH, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
    TEST_ASSERT_EQUAL_UINT16(0, pilot.targets_planned);
}

static void test_somebody_else_hands_a_segment_over(void)
{
    const struct jp_segment_command other = {{JP_Q24(0.1), 0}, 0, JP_Q16(1)};
    enum jp_status status;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 2));
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_robot_drive(&robot, &other));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_BUSY, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
}

/* The targets' memory changed between the forecast and the first leg: found at once, or with the leg. */
static void test_a_first_leg_that_fails(void)
{
    enum jp_status status;

    for (unsigned which = 0; which < 2U; which++) {
        struct jp_point targets[] = {slalom[0], slalom[1], slalom[2]};

        rig_reset();
        balance();
        TEST_ASSERT_EQUAL_INT32(JP_OK, follow(targets, 3));
        (void)work_while(JP_PILOT_PLANNING, &status);
        targets[which + 1U] = targets[which];
        TEST_ASSERT_EQUAL_INT32(JP_ERR_ZERO_LENGTH, jp_pilot_work(&pilot));
        TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
        TEST_ASSERT_EQUAL_UINT16(0, pilot.targets_planned);
        tick();
        TEST_ASSERT_EQUAL_INT32(JP_ROBOT_BALANCING, telemetry().state);
    }
}

/* ---- Motors off ---- */

static void test_disabled_in_mid_plan(void)
{
    balance();
    follow_slalom();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    jp_robot_disable(&robot);
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 2));
    drive(slalom, 2);
    expect_rest();
}

static void test_fallen_while_driving(void)
{
    balance();
    follow_slalom();
    work_until_driving();
    robot.internal.estimator.pitch = JP_PHASE_TURN / 4;
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_FALLEN, telemetry().state);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, follow(slalom, SLALOM));
    TEST_ASSERT_EQUAL_UINT32(0, pilot.legs_learned_from);
}
