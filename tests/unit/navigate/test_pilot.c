/* The pilot: arguments and states, slices, what it learns, what replaces or ends a route. */
#include <joulepath/battery.h>
#include <joulepath/trajectory_energy.h>
#include <stddef.h>

#include "tests/support/energy_unit.h"
#include "tests/support/pilot_rig.h"

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

static void test_fields_out_of_range(void)
{
    config.model = NULL;
    expect_bad_field("model");
    config.model = &model;
    model.electronics_power = -1;
    expect_bad_field("model.electronics_power");
    model = jp_energy_model_gao2018;
    learning.identity = 0;
    expect_bad_field("learning.identity");
}

/* ---- Requests ---- */

static void test_requests_without_targets(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, follow(NULL, 1));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, follow(slalom, 0));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT,
                            jp_pilot_ask(&pilot, &(struct jp_pilot_route){NULL, 1, JP_PILOT_STAND, NULL, 0}));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT,
                            jp_pilot_ask(&pilot, &(struct jp_pilot_route){slalom, 0, JP_PILOT_STAND, NULL, 0}));
    expect_rest();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_NO_PLAN, jp_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_EQUAL_INT32(-1, forecast.energy);
}

static void test_null_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT,
                            jp_pilot_follow(NULL, &(struct jp_pilot_route){slalom, 1, JP_PILOT_PASS, NULL, 0}));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_follow(&pilot, NULL));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_ask(&pilot, NULL));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT,
                            jp_pilot_ask(NULL, &(struct jp_pilot_route){slalom, 1, JP_PILOT_PASS, NULL, 0}));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_answer(NULL, &forecast));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_answer(&pilot, NULL));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_work(NULL));
}

static void test_no_work_within_a_tick(void)
{
    struct jp_actuation actuation;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 1));
    jp_robot_control(&robot, JP_OK, &sensors, &actuation);
    for (int i = 0; i < 10; i++) {
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    }
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_PLANNING, pilot.phase);
    jp_robot_account(&robot);
    for (int i = 0; i < 10; i++) {
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    }
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_DRIVING, pilot.phase);
}

static void test_requests_with_motors_off(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, follow(slalom, SLALOM));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE,
                            jp_pilot_ask(&pilot, &(struct jp_pilot_route){slalom, 1, JP_PILOT_STAND, NULL, 0}));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
}

/* ---- Routes ---- */

static void test_route_is_driven(void)
{
    balance();
    follow_slalom();
    drive(slalom, SLALOM);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT32(SLALOM, pilot.legs_learned_from);
    TEST_ASSERT_EQUAL_UINT32(0, pilot.legs_left_out);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), 0, telemetry().reference_wheel_rate);
    ticks(200);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT16(SLALOM, telemetry().segments_ended);
}

/* A robot whose tables are in units of 8 J learns from its joules what it learns in joules, and plans the same. */
static void test_route_in_another_unit(void)
{
    struct jp_learned_state in_joules;
    jp_q16 energy;

    balance();
    follow_slalom();
    drive(slalom, SLALOM);
    expect_rest();
    in_joules = pilot.learner.state;
    energy = pilot.leg.energy;

    rig_reset();
    model = energy_model_in_unit(&jp_energy_model_gao2018, 3);
    learning = learning_in_unit(&jp_learning_gao2018, 3);
    init();
    balance();
    follow_slalom();
    drive(slalom, SLALOM);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT32(SLALOM, pilot.legs_learned_from);
    TEST_ASSERT_EQUAL_UINT32(in_joules.version, pilot.learner.state.version);
    for (unsigned i = 0; i < JP_LEARNING_DIRECTIONS; i++) {
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), in_joules.x[i], pilot.learner.state.x[i]);
    }
    TEST_ASSERT_INT32_WITHIN(energy / 1000, energy_in_unit(energy, 3), pilot.leg.energy);
}

static void test_route_that_ends_in_motion(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK,
                            jp_pilot_follow(&pilot, &(struct jp_pilot_route){slalom, 2, JP_PILOT_PASS, NULL, 0}));
    drive(slalom, 2);
    TEST_ASSERT_GREATER_THAN_INT32(JP_Q24(0.3), telemetry().motion.wheel_rate);
    expect_rest();
}

/* Heading and speed at a target, also in what replaces the route before it is driven to its end. */
static void test_targets_are_passed_as_is_given(void)
{
    struct jp_passage passages[SLALOM] = {{.given = 0}};
    const struct jp_pilot_route route = {slalom, SLALOM, JP_PILOT_STAND, passages, 0};
    const struct jp_pilot_route onward = {&slalom[2], SLALOM - 2, JP_PILOT_STAND, &passages[2], 0};

    passages[0] = (struct jp_passage){JP_GIVEN_HEADING | JP_GIVEN_SPEED, JP_ANGLE_DEGREES(10), JP_Q24(0.25)};
    passages[SLALOM - 1] = (struct jp_passage){.given = JP_GIVEN_HEADING, .heading = JP_ANGLE_DEGREES(30)};
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, &route));
    drive(slalom, 1);
    TEST_ASSERT_INT32_WITHIN(JP_ANGLE_DEGREES(2), JP_ANGLE_DEGREES(10),
                             (int32_t)jp_phase_angle(telemetry().reference_yaw));
    TEST_ASSERT_INT32_WITHIN(jp_q24_multiply(JP_Q24(0.03), robot_config.trajectory.turns_per_metre),
                             jp_q24_multiply(JP_Q24(0.25), robot_config.trajectory.turns_per_metre),
                             telemetry().reference_wheel_rate);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_follow(&pilot, &onward));
    for (unsigned k = 0; k < PATIENCE && (pilot.phase != JP_PILOT_RESTING); k++) {
        work_and_tick();
    }
    expect_rest();
    expect_near(&slalom[SLALOM - 1]);
    TEST_ASSERT_INT32_WITHIN(JP_ANGLE_DEGREES(2), JP_ANGLE_DEGREES(30),
                             (int32_t)jp_phase_angle(telemetry().reference_yaw));
}

static void test_what_cannot_be_given_is_refused_before_the_robot_moves(void)
{
    const struct jp_passage passage = {.given = JP_GIVEN_SPEED, .speed = JP_Q24(9)};
    enum jp_status status;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK,
                            jp_pilot_follow(&pilot, &(struct jp_pilot_route){slalom, 1, JP_PILOT_PASS, &passage, 0}));
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, status);
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_BALANCING, telemetry().state);
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().segment);
}

/* The survey: a slice to begin, one for each leg, one to end; then the first leg. Meanwhile the robot stands. */
static void test_slices_of_a_plan(void)
{
    enum jp_status status;

    balance();
    follow_slalom();
    TEST_ASSERT_EQUAL_UINT32(SLALOM + 2, work_while(JP_PILOT_PLANNING, &status));
    TEST_ASSERT_EQUAL_INT32(JP_OK, status);
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_DRIVING, pilot.phase);
    TEST_ASSERT_EQUAL_UINT16(0, pilot.targets_planned);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_UINT16(1, pilot.targets_planned);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_UINT16(1, pilot.targets_planned);
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_BALANCING, telemetry().state);
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_DRIVING, telemetry().state);
    TEST_ASSERT_EQUAL_INT32(jp_cruise_speed(&model), telemetry().command.speed);
}

static void test_next_leg_is_planned_shortly_before_the_end(void)
{
    balance();
    follow_slalom();
    work_until_driving();
    while (telemetry().segment_ticks_left > robot_config.estimator.tick_rate / 5U) {
        TEST_ASSERT_EQUAL_UINT16(1, pilot.targets_planned);
        work_and_tick();
    }
    work_and_tick();
    TEST_ASSERT_EQUAL_UINT16(2, pilot.targets_planned);
}

static void test_no_faster_than_the_robot_may(void)
{
    robot_config.limits.speed = JP_Q24(0.3);
    init();
    balance();
    follow_slalom();
    work_until_driving();
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.3), telemetry().command.speed);
}

static void test_the_cruise_that_others_ask_for(void)
{
    TEST_ASSERT_EQUAL_INT32(jp_cruise_speed(&model), jp_pilot_cruise(&robot_config, &model));
    robot_config.limits.speed = JP_Q24(0.3);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.3), jp_pilot_cruise(&robot_config, &model));
}

/* In a metre the wheels turn four times, in a turn of the body three times. */
static void test_the_back_emf_that_others_ask_for(void)
{
    const struct jp_back_emf motors = jp_pilot_back_emf(&robot_config, JP_PILOT_MOTORS);
    struct jp_back_emf battery;

    TEST_ASSERT_EQUAL_INT32(0, motors.travel);
    TEST_ASSERT_EQUAL_INT32(0, motors.turning);
    robot_config.monitor.back_emf = JP_Q16(0.5);
    robot_config.monitor.half_track = JP_Q16(3);
    robot_config.trajectory.turns_per_metre = JP_Q24(4);
    battery = jp_pilot_back_emf(&robot_config, JP_PILOT_BATTERY);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(2), battery.travel);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(1.5), battery.turning);
}

/* The robot's meters are two: what is learned is of the one that was chosen. */
static void test_energy_of_the_battery(void)
{
    model = jp_energy_model_gao2018_battery;
    learning = jp_learning_gao2018_battery;
    config.meter = JP_PILOT_BATTERY;
    init();
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 2));
    drive(slalom, 2);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT32(2, pilot.legs_learned_from);
}

static void test_without_learning(void)
{
    config.learning = NULL;
    init();
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 2));
    drive(slalom, 2);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT32(0, pilot.legs_learned_from);
    TEST_ASSERT_EQUAL_UINT32(0, pilot.legs_left_out);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_GREATER_THAN_INT32(JP_Q16(20), forecast.energy);
    TEST_ASSERT_EQUAL_INT32(0, forecast.deviation);
}

static void test_doubt_is_not_learned(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 2));
    work_until_driving();
    work_and_tick();
    pilot.battery_flags = JP_BATTERY_EMPTY;
    work_and_tick();
    pilot.battery_flags = 0;
    drive(slalom, 2);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT32(1, pilot.legs_learned_from);
    TEST_ASSERT_EQUAL_UINT32(1, pilot.legs_left_out);
}

static void test_next_route_follows_a_stand(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 1));
    drive(slalom, 1);
    expect_rest();
    ticks(2000);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(aside, 2));
    drive(aside, 2);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT32(3, pilot.legs_learned_from);
}

static void expect_legs_end(uint16_t count, const struct jp_point *target)
{
    for (unsigned i = 0; i < PATIENCE && telemetry().segments_ended < count; i++) {
        work_and_tick();
    }
    TEST_ASSERT_EQUAL_UINT16(count, telemetry().segments_ended);
    expect_near(target);
}

/* From the end of the leg that is driven, without a stand. */
static void test_new_route_while_driving(void)
{
    balance();
    follow_slalom();
    work_until_driving();
    ticks(500);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(aside, 2));
    expect_legs_end(1, &slalom[0]);
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_DRIVING, telemetry().state);
    expect_legs_end(2, &aside[0]);
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_DRIVING, telemetry().state);
    expect_legs_end(3, &aside[1]);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT32(3, pilot.legs_learned_from);
}

static void test_new_route_while_the_first_leg_waits(void)
{
    enum jp_status status;

    balance();
    follow_slalom();
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(aside, 2));
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    expect_legs_end(1, &slalom[0]);
    expect_legs_end(3, &aside[1]);
    expect_rest();
}

/* That leg ends at a stand, from which the new route is planned. */
static void test_new_route_while_the_last_leg_is_driven(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 1));
    work_until_driving();
    ticks(500);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(aside, 2));
    expect_legs_end(1, &slalom[0]);
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_PLANNING, pilot.phase);
    drive(aside, 2);
    expect_rest();
}

static void test_new_route_while_planning(void)
{
    balance();
    follow_slalom();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(aside, 2));
    drive(aside, 2);
    expect_rest();
}

/* From the end of a segment that somebody else handed over. */
static void test_route_after_a_segment(void)
{
    const struct jp_segment_command ahead = {{JP_Q24(0.4), 0}, 0, JP_Q16(2)};

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_robot_drive(&robot, &ahead));
    ticks(2);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(&slalom[1], 2));
    while (telemetry().segments_ended == 0U) {
        work_and_tick();
    }
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_DRIVING, telemetry().state);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segment);
    TEST_ASSERT_EQUAL_INT32(jp_cruise_speed(&model), telemetry().command.speed);
    expect_legs_end(3, &slalom[2]);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT32(2, pilot.legs_learned_from);
}

static void test_stop(void)
{
    balance();
    follow_slalom();
    work_until_driving();
    ticks(500);
    jp_pilot_stop(&pilot);
    tick();
    for (unsigned i = 0; i < 500U; i++) {
        expect_rest();
        tick();
    }
    TEST_ASSERT_EQUAL_UINT32(0, pilot.legs_learned_from);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(aside, 2));
    drive(aside, 2);
    expect_rest();
}

/* Nothing is planned in the legs that the robot still drives, nor does the route begin while it rolls. */
static void test_new_route_before_a_stop_is_obeyed(void)
{
    enum jp_status status;

    balance();
    follow_slalom();
    work_until_driving();
    ticks(2000);
    jp_pilot_stop(&pilot);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(aside, 2));
    TEST_ASSERT_EQUAL_UINT32(1000, work_while(JP_PILOT_PLANNING, &status));
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_DRIVING, telemetry().state);
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_BALANCING, telemetry().state);
    TEST_ASSERT_EQUAL_UINT32(4, work_while(JP_PILOT_PLANNING, &status));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_UINT16(0, pilot.targets_planned);
    drive(aside, 2);
    expect_rest();
}

/* By somebody else: the route is over. */
static void test_stop_beside_the_pilot(void)
{
    balance();
    follow_slalom();
    work_until_driving();
    ticks(500);
    (void)jp_pilot_work(&pilot);
    jp_robot_stop(&robot);
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(aside, 2));
    drive(aside, 2);
    expect_rest();
}

static void hand_over(void)
{
    enum jp_status status;

    balance();
    follow_slalom();
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_UINT16(1, pilot.targets_planned);
}

/* Handed over, and not begun when the stop comes. */
static void test_stop_forgets_the_leg_that_waits(void)
{
    hand_over();
    jp_pilot_stop(&pilot);
    ticks(10);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().segment);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(aside, 2));
    drive(aside, 2);
}

static void test_stop_beside_the_pilot_of_a_leg_that_waits(void)
{
    hand_over();
    jp_robot_stop(&robot);
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
}

/* No slice until the leg has ended: the robot stands, and goes on from there. */
static void test_late_plan(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 3));
    work_until_driving();
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
    TEST_ASSERT_EQUAL_UINT32(3, pilot.legs_learned_from);
}

/* Nearer than the robot can slow down: it stands at the end of its leg first. */
static void test_new_route_that_cannot_go_on_in_motion(void)
{
    const struct jp_point near[] = {{JP_Q16(1.21), JP_Q16(0.4)}, {JP_Q16(0.2), JP_Q16(0.6)}};

    balance();
    follow_slalom();
    work_until_driving();
    ticks(500);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(near, 2));
    expect_legs_end(1, &slalom[0]);
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_BALANCING, telemetry().state);
    drive(near, 2);
    expect_rest();
}

static void test_a_leg_is_told_as_it_was_planned(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 2));
    work_until_driving();
    TEST_ASSERT_EQUAL_INT32(telemetry().command.speed, pilot.leg.speed);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.003), (jp_q16)((int64_t)telemetry().segment_ticks_left * JP_Q16_ONE / 1000),
                             pilot.leg.duration);
    /* From 0 to the mean of 18.4° and -14°. */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.02), JP_Q24(0.0383), pilot.leg.turn);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(2), JP_Q16(37), pilot.leg.energy);
}

/* What was learned makes a leg's energy too large for its format: it is driven, and nothing is learned from it. */
static void test_legs_that_cannot_be_learned_from(void)
{
    const struct jp_point corners[] = {{JP_Q16(0.1), JP_Q16(1)}, {JP_Q16(1.2), JP_Q16(1.1)}};
    enum jp_status status;

    for (unsigned j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
        learning.direction[JP_ENERGY_TERMS + 1][j] = JP_Q16(4096);
    }
    init();
    for (unsigned j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
        pilot.learner.state.x[j] = JP_LEARNED_MAX;
    }
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(corners, 2));
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_pilot_answer(&pilot, &forecast));
    drive(corners, 2);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT32(0, pilot.legs_learned_from);
    TEST_ASSERT_EQUAL_UINT32(2, pilot.legs_left_out);
}

static void test_a_robot_that_rolls_does_not_begin(void)
{
    enum jp_status status;

    balance();
    follow_slalom();
    (void)work_while(JP_PILOT_PLANNING, &status);
    for (int sign = -1; sign <= 1; sign += 2) {
        robot.internal.telemetry.motion.wheel_rate = sign * JP_Q24(0.1);
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
        TEST_ASSERT_EQUAL_UINT16(0, pilot.targets_planned);
    }
    robot.internal.telemetry.motion.wheel_rate = 0;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_UINT16(1, pilot.targets_planned);
}

/* The robot stands then, and its count of legs begins anew. */
static void test_no_more_legs_than_can_be_counted(void)
{
    balance();
    follow_slalom();
    work_until_driving();
    while (telemetry().segment_ticks_left > robot_config.estimator.tick_rate / 5U) {
        work_and_tick();
    }
    robot.internal.telemetry.segment = UINT16_MAX;
    pilot.internal.drive.begun = UINT16_MAX;
    pilot.internal.drive.trajectory.count = UINT16_MAX;
    work_and_tick();
    TEST_ASSERT_EQUAL_UINT16(1, pilot.targets_planned);
}

/* A bus that lacks voltage */

static jp_q16 duration_of_slalom(void)
{
    enum jp_status status;

    follow_slalom();
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    return pilot.leg.duration;
}

static void test_lacking_voltage_slows_what_is_planned(void)
{
    const jp_q16 designed = robot_config.trajectory.voltage;
    jp_q16 usual;

    robot_config.limits.speed = jp_cruise_speed(&model);
    init();
    balance();
    usual = duration_of_slalom();
    init();
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_lack_voltage(&pilot, designed / 2));
    TEST_ASSERT_INT32_WITHIN(2, jp_cruise_speed(&model) / 2, jp_pilot_cruise_now(&pilot, &model));
    TEST_ASSERT_GREATER_THAN_INT32(usual, duration_of_slalom());
    TEST_ASSERT_LESS_OR_EQUAL_INT32(jp_cruise_speed(&model) / 2 + 2, pilot.leg.speed);
}

static void test_voltage_that_comes_back_is_used_again(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_lack_voltage(&pilot, JP_Q16_ONE));
    TEST_ASSERT_EQUAL_INT32(robot_config.trajectory.voltage - JP_Q16_ONE, pilot.internal.trajectory.voltage);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_lack_voltage(&pilot, 0));
    TEST_ASSERT_EQUAL_INT32(robot_config.trajectory.voltage, pilot.internal.trajectory.voltage);
    TEST_ASSERT_EQUAL_INT32(jp_pilot_cruise(&robot_config, &model), jp_pilot_cruise_now(&pilot, &model));
}

static void test_voltage_that_leaves_no_motion_is_refused(void)
{
    const jp_q16 designed = robot_config.trajectory.voltage;

    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_lack_voltage(&pilot, designed - designed / 8));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_INFEASIBLE, jp_pilot_lack_voltage(&pilot, designed - designed / 8 + 1));
    TEST_ASSERT_EQUAL_INT32(designed / 8, pilot.internal.trajectory.voltage);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_lack_voltage(&pilot, -1));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pilot_lack_voltage(NULL, 0));
}
