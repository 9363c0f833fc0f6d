/* The pilot: arguments and states, slices, routes shorter and longer than its legs, questions, what replaces or ends a
 * route, plans that fail or come late. */
#include <stddef.h>

#include "tests/support/pilot_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

/* ---- Configuration ---- */

static void test_bad_arguments(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_init(NULL, &config, &robot, &field));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_init(&pilot, NULL, &robot, &field));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_init(&pilot, &config, NULL, &field));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_init(&pilot, &config, &robot, NULL));
}

static void expect_bad_field(const char *expected)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT32(JP_ERR_CONFIG, jp_pilot_init(&pilot, &config, &robot, &field));
    TEST_ASSERT_EQUAL_STRING(expected, field);
}

static void test_field_that_is_missing(void)
{
    const struct jp_pilot_config good = config;

    config.model = NULL;
    expect_bad_field("model");
    config = good;
    config.horizon = NULL;
    expect_bad_field("horizon");
    config = good;
    config.learning = NULL;
    expect_bad_field("learning");
    config = good;
    config.legs = NULL;
    expect_bad_field("legs");
    config = good;
    config.leg_count = 0;
    expect_bad_field("leg_count");
    config.leg_count = JP_ROUTE_LEGS_MAX + 1;
    expect_bad_field("leg_count");
}

static void test_field_out_of_range(void)
{
    model.electronics_power = -1;
    expect_bad_field("model.electronics_power");
    model = jp_energy_model_gao2018;
    horizon.duration_min = 0;
    expect_bad_field("horizon.duration_min");
    horizon = jp_horizon_gao2018;
    learning.identity = 0;
    expect_bad_field("learning.identity");
    learning = jp_learning_gao2018;
    robot_config.limits.speed = 0;
    expect_bad_field("limits.speed");
}

/* ---- Requests ---- */

static void test_requests_without_targets(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_follow(&pilot, NULL, 1));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_follow(&pilot, slalom, 0));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_ask(&pilot, NULL, 1));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_ask(&pilot, slalom, 0));
    expect_rest();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_NO_PLAN, jp_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_EQUAL_INT32(-1, forecast.energy);
}

static void test_null_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_follow(NULL, slalom, 1));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_ask(NULL, slalom, 1));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_answer(NULL, &forecast));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_answer(&pilot, NULL));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_work(NULL));
}

static void test_no_work_within_a_tick(void)
{
    struct jp_actuation actuation;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, LEGS));
    jp_robot_control(&robot, JP_OK, &sensors, &actuation);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_DRIVING, pilot.phase);
    jp_robot_account(&robot);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_PLANNING, pilot.phase);
}

static void test_requests_with_motors_off(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_follow(&pilot, slalom, SLALOM));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_ask(&pilot, slalom, 1));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
}

/* ---- Routes ---- */

static void test_route_is_driven(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, LEGS));
    drive(slalom, LEGS);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT32(LEGS, pilot.segments_learned_from);
    ticks(200);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT16(LEGS, telemetry().segments_ended);
}

/* A slice begins the plan, then those that jp_route_work() states; meanwhile the robot stands. */
static void test_slices_of_a_plan(void)
{
    enum jp_status status;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, SLALOM));
    TEST_ASSERT_EQUAL_UINT32(1, work_while(JP_PILOT_DRIVING, &status));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_PLANNING, pilot.phase);
    TEST_ASSERT_EQUAL_UINT32(LEGS + JP_ROUTE_ITERATIONS + 1, work_while(JP_PILOT_PLANNING, &status));
    TEST_ASSERT_EQUAL_INT32(JP_OK, status);
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_DRIVING, pilot.phase);
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_BALANCING, telemetry().state);
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_DRIVING, telemetry().state);
    TEST_ASSERT_EQUAL_INT32(legs[0].segment.command.motion.speed, telemetry().command.speed);
    TEST_ASSERT_EQUAL_INT32(legs[0].segment.command.motion.turn_rate, telemetry().command.turn_rate);
}

static void test_more_targets_than_legs(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, SLALOM));
    drive(slalom, SLALOM);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT32(SLALOM, pilot.segments_learned_from);
}

static void test_one_leg_at_a_time(void)
{
    config.leg_count = 1;
    init();
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, 3));
    drive(slalom, 3);
    expect_rest();
}

/* The robot's meters are two: what is learned is of the one that was chosen. */
static void test_energy_of_the_battery(void)
{
    model = jp_energy_model_gao2018_battery;
    horizon = jp_horizon_gao2018_battery;
    learning = jp_learning_gao2018_battery;
    config.meter = JP_PILOT_BATTERY;
    init();
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, 2));
    drive(slalom, 2);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT32(2, pilot.segments_learned_from);
}

static void test_next_route_follows_a_stand(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, 1));
    drive(slalom, 1);
    expect_rest();
    ticks(2000);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, aside, 2));
    drive(aside, 2);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT32(3, pilot.segments_learned_from);
}

static void test_new_route_while_driving(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, SLALOM));
    while (telemetry().segment == 0U) {
        work_and_tick();
    }
    ticks(500);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, aside, 2));
    drive(slalom, 1);
    while (telemetry().segments_ended < 3U) {
        work_and_tick();
    }
    expect_near(&aside[1]);
    expect_rest();
}

static void test_new_route_while_planning(void)
{
    enum jp_status status;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, SLALOM));
    (void)work_while(JP_PILOT_DRIVING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, aside, 2));
    drive(aside, 2);
    expect_rest();
}

static void test_stop(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, SLALOM));
    while (telemetry().segment == 0U) {
        work_and_tick();
    }
    ticks(500);
    jp_pilot_stop(&pilot);
    tick();
    for (unsigned i = 0; i < 500U; i++) {
        expect_rest();
        tick();
    }
    TEST_ASSERT_EQUAL_UINT32(0, pilot.segments_learned_from);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, aside, 2));
    drive(aside, 2);
    expect_rest();
}

/* By somebody else: the route is over. */
static void test_stop_beside_the_pilot(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, SLALOM));
    while (telemetry().segment == 0U) {
        work_and_tick();
    }
    ticks(500);
    (void)jp_pilot_work(&pilot);
    jp_robot_stop(&robot);
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, aside, 2));
    drive(aside, 2);
    expect_rest();
}

/* Handed over, and not begun when the stop comes. */
static void test_stop_forgets_the_segment_that_waits(void)
{
    enum jp_status status;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, SLALOM));
    (void)work_while(JP_PILOT_DRIVING, &status);
    (void)work_while(JP_PILOT_PLANNING, &status);
    jp_pilot_stop(&pilot);
    ticks(10);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().segment);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, aside, 2));
    drive(aside, 2);
}

/* No slice until the segment has ended: the robot stands, and goes on from there. */
static void test_late_plan(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, 3));
    while (telemetry().segment == 0U) {
        work_and_tick();
    }
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    while (telemetry().state == JP_ROBOT_DRIVING) {
        tick();
    }
    ticks(300);
    while (pilot.phase != JP_PILOT_RESTING) {
        work_and_tick();
    }
    expect_near(&slalom[2]);
    expect_rest();
}

/* ---- Plans that fail ---- */

static void expect_failure(const struct jp_point *targets, uint16_t count, enum jp_status expected)
{
    enum jp_status status;

    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, targets, count));
    (void)work_while(JP_PILOT_DRIVING, &status);
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(expected, status);
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
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

static void test_targets_that_coincide(void)
{
    const struct jp_point twice[] = {slalom[0], slalom[0]};

    balance();
    expect_failure(twice, 2, JP_ERR_ZERO_LENGTH);
    TEST_ASSERT_EQUAL_UINT32(1, pilot.route.planned);
}

/* More than 512 m away; and behind, where no arc within the limits leads. */
static void test_targets_out_of_reach(void)
{
    const struct jp_point far = {JP_Q16(600), 0};
    const struct jp_point behind = {JP_Q16(-400), 0};

    balance();
    expect_failure(&far, 1, JP_ERR_ARGUMENT);
    robot_config.limits.duration = JP_Q16(401);
    expect_failure(&behind, 1, JP_ERR_INFEASIBLE);
}

/* Three legs that take about 12 kJ each, and a sum that has no format. */
static void test_forecast_that_overflows(void)
{
    const struct jp_point far[] = {{JP_Q16(500), 0}, {JP_Q16(1000), 0}, {JP_Q16(1500), 0}};

    balance();
    expect_failure(far, 3, JP_ERR_OVERFLOW);
}

static void test_failure_is_forgotten_with_the_next_route(void)
{
    const struct jp_point here = {0, 0};

    balance();
    expect_failure(&here, 1, JP_ERR_ZERO_LENGTH);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, 2));
    drive(slalom, 2);
    expect_rest();
}

/* The robot drives the segment to its end. */
static void test_failure_on_the_way(void)
{
    const struct jp_point too_far[] = {slalom[0], {JP_Q16(600), 0}};
    enum jp_status status = JP_OK;

    config.leg_count = 1;
    init();
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, too_far, 2));
    for (unsigned i = 0; i < PATIENCE && status == JP_OK; i++) {
        status = jp_pilot_work(&pilot);
        tick();
    }
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, status);
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_DRIVING, telemetry().state);
    while (telemetry().state == JP_ROBOT_DRIVING) {
        TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_work(&pilot));
        tick();
    }
    expect_near(&slalom[0]);
}

static void test_somebody_else_hands_a_segment_over(void)
{
    const struct jp_segment_command other = {{JP_Q24(0.1), 0}, 0, JP_Q16(1)};
    enum jp_status status;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, 2));
    (void)work_while(JP_PILOT_DRIVING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_robot_drive(&robot, &other));
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_BUSY, status);
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
}

/* ---- Motors off ---- */

static void test_disabled_in_mid_plan(void)
{
    enum jp_status status;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, SLALOM));
    (void)work_while(JP_PILOT_DRIVING, &status);
    jp_robot_disable(&robot);
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, 2));
    drive(slalom, 2);
    expect_rest();
}

static void test_fallen_while_driving(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, slalom, SLALOM));
    while (telemetry().segment == 0U) {
        work_and_tick();
    }
    robot.internal.estimator.pitch = JP_PHASE_TURN / 4;
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_FALLEN, telemetry().state);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_follow(&pilot, slalom, SLALOM));
    TEST_ASSERT_EQUAL_UINT32(0, pilot.segments_learned_from);
}

/* ---- Questions ---- */

/* What the built-in model says of the plan in the legs. */
static jp_q16 energy_of_legs(uint16_t count)
{
    struct jp_energy_start start = {{0, 0}, {{0}, {0}}};
    jp_q16 sum = 0;

    for (uint16_t k = 0; k < count; k++) {
        jp_q16 energy = 0;

        TEST_ASSERT_EQUAL_INT32(
            JP_OK, jp_energy_forecast(&model, &horizon, &start, &legs[k].segment.command, &energy, &start));
        sum = jp_add(sum, energy);
    }
    return sum;
}

static void test_question(void)
{
    enum jp_status status;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, slalom, LEGS));
    TEST_ASSERT_EQUAL_INT32(JP_WORKING, jp_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_EQUAL_INT32(-1, forecast.energy);
    (void)work_while(JP_PILOT_DRIVING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_WORKING, jp_pilot_answer(&pilot, &forecast));
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), energy_of_legs(LEGS), forecast.energy);
    TEST_ASSERT_GREATER_THAN_INT32(0, forecast.deviation);
    jp_pilot_stop(&pilot);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_answer(&pilot, &forecast));
    ticks(100);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().segment);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().position.x);
}

/* A leg at a time: only the first one's deviation has nothing that planning anew adds. */
static void test_longer_routes_are_less_sure(void)
{
    enum jp_status status;
    struct jp_forecast one;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, slalom, 1));
    (void)work_while(JP_PILOT_DRIVING, &status);
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_answer(&pilot, &one));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, slalom, LEGS));
    (void)work_while(JP_PILOT_DRIVING, &status);
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_GREATER_THAN_INT32(2 * one.energy, forecast.energy);
    TEST_ASSERT_GREATER_THAN_INT32(one.deviation, forecast.deviation);
}

static void test_question_about_more_targets_than_legs(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_MEMORY, jp_pilot_ask(&pilot, slalom, LEGS + 1));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_NO_PLAN, jp_pilot_answer(&pilot, &forecast));
}

static void test_question_in_the_wrong_moment(void)
{
    const struct jp_segment_command other = {{JP_Q24(0.1), 0}, 0, JP_Q16(1)};

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, slalom, 1));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_ask(&pilot, slalom, 1));
    jp_pilot_stop(&pilot);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_robot_drive(&robot, &other));
    ticks(2);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_ask(&pilot, slalom, 1));
}

static void test_question_that_has_no_answer(void)
{
    const struct jp_point here = {0, 0};
    enum jp_status status;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, &here, 1));
    (void)work_while(JP_PILOT_DRIVING, &status);
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ZERO_LENGTH, status);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ZERO_LENGTH, jp_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
}

/* Nobody is to take the last plan's energy for the answer. */
static void test_question_that_is_given_up(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, slalom, 2));
    jp_pilot_stop(&pilot);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_NO_PLAN, jp_pilot_answer(&pilot, &forecast));
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, slalom, 2));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, aside, 2));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_NO_PLAN, jp_pilot_answer(&pilot, &forecast));
    drive(aside, 2);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_NO_PLAN, jp_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_EQUAL_INT32(-1, forecast.energy);
}

static void test_question_of_a_robot_that_falls(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, slalom, 2));
    robot.internal.estimator.pitch = JP_PHASE_TURN / 4;
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_answer(&pilot, &forecast));
}

/* A horizon under which what turns leave behind never ends and grows beyond its format: the route is planned, but its
 * energy cannot be told. */
static void test_transients_beyond_their_range(void)
{
    /* Each turn is of 170° to the left. */
    static const struct jp_point star[] = {{JP_Q16(-0.985), JP_Q16(0.174)},
                                           {JP_Q16(-0.045), JP_Q16(-0.168)},
                                           {JP_Q16(-0.911), JP_Q16(0.332)},
                                           {JP_Q16(-0.145), JP_Q16(-0.311)}};

    horizon = (struct jp_horizon){.duration_min = JP_Q16(0.5), .yaw = {.count = 1}};
    horizon.yaw.mode[0].decay = 1;
    horizon.yaw.step[1][0] = JP_Q16(512);
    robot_config.limits.turn = JP_Q24(3.14);
    robot_config.limits.turn_rate = JP_Q24(0.01);
    balance();
    expect_failure(star, 4, JP_ERR_OVERFLOW);
}
