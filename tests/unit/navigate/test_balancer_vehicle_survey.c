/* What a balancer says of runs beforehand: energy, time, corners and stands. */
#include "tests/support/balancer_vehicle_rig.h"

/* ---- The survey ---- */

/* To its end, or its first failure; `off`: the largest that a leg leaves its line by. */
static enum jp_status survey(const struct jp_vehicle_run *run, bool anew, jp_q16 *off)
{
    enum jp_status status = vehicle.survey(vehicle.context, run, anew);

    *off = 0;
    for (unsigned i = 0; i < run->count && status == JP_OK; i++) {
        struct jp_leg_extent of_leg = {-1, -1};

        status = vehicle.survey_leg(vehicle.context, &of_leg);
        *off = of_leg.aside > *off ? of_leg.aside : *off;
    }
    return status;
}

static void survey_from_origin(const struct jp_point *targets, uint16_t count, bool anew)
{
    const struct jp_vehicle_run run = {.targets = targets, .count = count};
    jp_q16 off;

    TEST_ASSERT_EQUAL_INT32(JP_OK, survey(&run, anew, &off));
    vehicle.forecast(vehicle.context, &duration, &forecast);
}

/* The same run from a metre farther on, after what was surveyed. */
static void survey_after(const struct jp_point *targets, uint16_t count)
{
    static struct jp_point moved[SLALOM];
    const struct jp_vehicle_run run = {.start = {JP_Q16(1), 0}, .targets = moved, .count = count};
    jp_q16 off;

    for (uint16_t i = 0; i < count; i++) {
        moved[i] = (struct jp_point){targets[i].x + JP_Q16(1), targets[i].y};
    }
    TEST_ASSERT_EQUAL_INT32(JP_OK, survey(&run, false, &off));
    vehicle.forecast(vehicle.context, &duration, &forecast);
}

/* What the pilot says of a route from where it stands. */
static struct jp_forecast ask(const struct jp_point *targets, uint16_t count)
{
    const struct jp_pilot_route route = {.targets = targets, .count = count, .end = JP_PILOT_STAND};
    struct jp_forecast answer;
    enum jp_status status;

    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, &route));
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_answer(&pilot, &answer));
    return answer;
}

static void expect_as_asked(const struct jp_point *targets, uint16_t count)
{
    const struct jp_forecast asked = ask(targets, count);

    survey_from_origin(targets, count, true);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), asked.energy, forecast.energy);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), asked.deviation, forecast.deviation);
    TEST_ASSERT_GREATER_THAN_INT32(JP_Q16(10), forecast.energy);
}

static void test_forecast_is_that_of_the_pilot(void)
{
    begin_balancing();
    expect_as_asked(straight, 1);
    expect_as_asked(bend, 3);
    TEST_ASSERT_GREATER_THAN_INT32(0, forecast.deviation);
}

static void test_forecast_by_what_was_learned(void)
{
    jp_q16 before;

    begin_balancing();
    expect_as_asked(bend, 3);
    before = forecast.energy;
    pilot.learner.state.x[0] = JP_Q24(1);
    pilot.learner.state.x[1] = -JP_Q24(0.5);
    expect_as_asked(bend, 3);
    TEST_ASSERT_GREATER_THAN_INT32(JP_Q16(1),
                                   before < forecast.energy ? forecast.energy - before : before - forecast.energy);
}

static void test_forecast_without_learning(void)
{
    config.learning = NULL;
    begin_balancing();
    expect_as_asked(straight, 1);
    expect_as_asked(bend, 3);
    TEST_ASSERT_EQUAL_INT32(0, forecast.deviation);
}

static void test_forecast_of_the_battery(void)
{
    model = jp_energy_model_gao2018_battery;
    learning = jp_learning_gao2018_battery;
    config.meter = JP_PILOT_BATTERY;
    begin_balancing();
    expect_as_asked(bend, 3);
}

static void test_forecast_of_nothing(void)
{
    begin();
    vehicle.forecast(vehicle.context, &duration, &forecast);
    TEST_ASSERT_EQUAL_INT32(0, duration);
    TEST_ASSERT_EQUAL_INT32(0, forecast.energy);
}

/* The robot's legs last as long as was said; it does not count how long it plans. */
static void test_duration_is_that_of_the_drive(void)
{
    unsigned driven = 0;

    begin_balancing();
    survey_from_origin(bend, 3, true);
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow_run(bend, 3));
    live_until_driving();
    while (telemetry().state == JP_ROBOT_DRIVING) {
        live();
        driven++;
    }
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), duration, (jp_q16)((uint64_t)driven * JP_Q16_ONE / 1000U));
}

/* By a3 σ² = 13.16 J/rad² of 80° and of 10°, and 6 W for 5.4 s each. */
static void test_turns_before_a_run(void)
{
    const jp_angle headings[] = {JP_ANGLE_DEGREES(90), JP_ANGLE_DEGREES(-90)};
    struct jp_vehicle_run run = {.targets = straight, .count = 1};
    struct jp_forecast without;
    jp_q16 shorter;
    jp_q16 off;

    begin_balancing();
    survey_from_origin(straight, 1, true);
    without = forecast;
    shorter = duration;
    for (size_t i = 0; i < sizeof headings / sizeof headings[0]; i++) {
        run.heading = headings[i];
        TEST_ASSERT_EQUAL_INT32(JP_OK, survey(&run, true, &off));
        vehicle.forecast(vehicle.context, &duration, &forecast);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(10.8), duration - shorter);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), JP_Q16(90.86), forecast.energy - without.energy);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), 0, off);
    }
}

/* Anywhere, in any direction. */
static void test_a_run_from_elsewhere(void)
{
    const struct jp_point target = {JP_Q16(7), JP_Q16(-1)};
    const struct jp_vehicle_run run = {
        .start = {JP_Q16(7), JP_Q16(0.5)}, .heading = JP_ANGLE_DEGREES(-90), .targets = &target, .count = 1};
    struct jp_forecast ahead;
    jp_q16 off;

    begin_balancing();
    survey_from_origin(straight, 1, true);
    ahead = forecast;
    TEST_ASSERT_EQUAL_INT32(JP_OK, survey(&run, true, &off));
    vehicle.forecast(vehicle.context, &duration, &forecast);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), ahead.energy, forecast.energy);
}

/* ---- Several runs ---- */

static void expect_runs_add_up(void)
{
    struct jp_forecast first;
    struct jp_forecast second;
    jp_q16 durations;

    survey_from_origin(bend, 3, true);
    second = forecast;
    durations = duration;
    survey_from_origin(straight, 1, true);
    first = forecast;
    durations += duration;
    survey_after(bend, 3);
    TEST_ASSERT_EQUAL_INT32(durations, duration);
    TEST_ASSERT_INT32_WITHIN(2, first.energy + second.energy, forecast.energy);
    TEST_ASSERT_TRUE(forecast.deviation <= first.deviation + second.deviation + 2);
    TEST_ASSERT_TRUE(forecast.deviation >= second.deviation);
    survey_from_origin(straight, 1, true);
    TEST_ASSERT_EQUAL_INT32(first.energy, forecast.energy);
    TEST_ASSERT_EQUAL_INT32(first.deviation, forecast.deviation);
}

static void test_runs_add_up(void)
{
    begin_balancing();
    expect_runs_add_up();
}

static void test_runs_add_up_without_learning(void)
{
    config.learning = NULL;
    begin_balancing();
    expect_runs_add_up();
}

/* A run counts when all of it was surveyed, and once; what was begun before is forgotten. */
static void test_a_run_that_is_surveyed_again(void)
{
    const struct jp_vehicle_run given_up = {
        .start = {JP_Q16(1), 0}, .heading = JP_ANGLE_DEGREES(120), .targets = slalom, .count = SLALOM};
    struct jp_forecast first;
    struct jp_forecast both;
    struct jp_leg_extent off;

    begin_balancing();
    survey_from_origin(straight, 1, true);
    first = forecast;
    survey_after(bend, 3);
    both = forecast;
    survey_after(bend, 3);
    TEST_ASSERT_EQUAL_INT32(both.energy, forecast.energy);
    survey_from_origin(straight, 1, true);
    for (unsigned legs = 0; legs < 3U; legs++) {
        TEST_ASSERT_EQUAL_INT32(JP_OK, vehicle.survey(vehicle.context, &given_up, false));
        for (unsigned i = 0; i < legs; i++) {
            TEST_ASSERT_EQUAL_INT32(JP_OK, vehicle.survey_leg(vehicle.context, &off));
        }
        vehicle.forecast(vehicle.context, &duration, &forecast);
        TEST_ASSERT_EQUAL_INT32(first.energy, forecast.energy);
    }
    survey_after(bend, 3);
    TEST_ASSERT_EQUAL_INT32(both.energy, forecast.energy);
    TEST_ASSERT_EQUAL_INT32(both.deviation, forecast.deviation);
}

static void test_there_is_no_leg_after_the_last(void)
{
    jp_q16 energy;
    struct jp_leg_extent off = {-1, -1};

    begin_balancing();
    survey_from_origin(straight, 1, true);
    energy = forecast.energy;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, vehicle.survey_leg(vehicle.context, &off));
    TEST_ASSERT_EQUAL_INT32(-1, off.aside);
    vehicle.forecast(vehicle.context, &duration, &forecast);
    TEST_ASSERT_EQUAL_INT32(energy, forecast.energy);
}

/* What was learned makes a leg's energy too large for its format: the built-in model's counts. */
static void test_legs_that_what_was_learned_cannot_tell(void)
{
    const struct jp_point corner[] = {{JP_Q16(1.2), 0}, {JP_Q16(1.2), JP_Q16(1.2)}};
    jp_q16 built_in;

    config.learning = NULL;
    begin_balancing();
    survey_from_origin(corner, 2, true);
    built_in = forecast.energy;
    config.learning = &learning;
    memset(learning.direction, 0, sizeof learning.direction);
    for (unsigned j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
        learning.direction[JP_ENERGY_TERMS + 1][j] = JP_Q16(4096);
    }
    begin();
    for (unsigned j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
        pilot.learner.state.x[j] = JP_LEARNED_MAX;
    }
    survey_from_origin(corner, 2, true);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), built_in, forecast.energy);
}

/* 10 kJ each. */
static void test_a_forecast_that_overflows(void)
{
    const struct jp_point far[] = {{JP_Q16(500), 0}, {JP_Q16(1000), 0}, {JP_Q16(1500), 0}, {JP_Q16(2000), 0}};

    for (int pass = 0; pass < 2; pass++) {
        begin();
        survey_from_origin(far, 4, true);
        TEST_ASSERT_EQUAL_INT32(INT32_MAX, forecast.energy);
        config.learning = NULL;
    }
}

/* ---- Corners and short legs ---- */

static void test_how_far_it_leaves_its_lines(void)
{
    const struct jp_vehicle_run along = {.targets = straight, .count = 1};
    const struct jp_vehicle_run round = {.targets = bend, .count = 3};
    jp_q16 off;

    begin_balancing();
    TEST_ASSERT_EQUAL_INT32(JP_OK, survey(&along, true, &off));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), 0, off);
    TEST_ASSERT_EQUAL_INT32(JP_OK, survey(&round, true, &off));
    TEST_ASSERT_GREATER_THAN_INT32(JP_Q16(0.005), off);
    TEST_ASSERT_LESS_THAN_INT32(JP_Q16(0.2), off);
}

static void test_runs_of_one_short_leg(void)
{
    begin_balancing();
    for (jp_q16 length = JP_Q16(0.005); length < JP_Q16(0.2); length += JP_Q16(0.005)) {
        const struct jp_point target = {length, 0};

        survey_from_origin(&target, 1, true);
        TEST_ASSERT_GREATER_THAN_INT32(0, duration);
    }
}

/* It has the voltage for less than its usual pace only, which one of several legs does not take; then for none. */
static void test_a_run_of_one_leg_goes_slower(void)
{
    const struct jp_vehicle_run run = {.targets = straight, .count = 1};
    const struct jp_vehicle_run round = {.targets = bend, .count = 3};
    jp_q16 usual;
    jp_q16 off;

    begin_balancing();
    survey_from_origin(straight, 1, true);
    usual = duration;
    robot_config.trajectory.voltage = JP_Q16(2);
    begin_balancing();
    survey_from_origin(straight, 1, true);
    TEST_ASSERT_GREATER_THAN_INT32(2 * usual, duration);
    expect_as_asked(straight, 1);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_INFEASIBLE, vehicle.survey(vehicle.context, &round, true));
    robot_config.trajectory.voltage = JP_Q16(0.2);
    begin_balancing();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_INFEASIBLE, survey(&run, true, &off));
}

static void test_a_target_where_it_is(void)
{
    const struct jp_vehicle_run run = {.targets = &origin, .count = 1};

    begin_balancing();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ZERO_LENGTH, vehicle.survey(vehicle.context, &run, true));
}

/* Of a run with corners it says so instead, and what was surveyed before stays; one by one the legs can be driven. */
static void test_short_legs_with_sharp_corners(void)
{
    const struct jp_vehicle_run run = {.start = {0, 1}, .targets = zigzag, .count = sizeof zigzag / sizeof zigzag[0]};
    jp_q16 energy;
    jp_q16 off;

    robot_config.trajectory.voltage = JP_Q16(40);
    begin_balancing();
    survey_from_origin(straight, 1, true);
    energy = forecast.energy;
    TEST_ASSERT_EQUAL_INT32(JP_OK, vehicle.survey(vehicle.context, &run, false));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_INFEASIBLE, survey(&run, false, &off));
    vehicle.forecast(vehicle.context, &duration, &forecast);
    TEST_ASSERT_EQUAL_INT32(energy, forecast.energy);
    for (unsigned i = 1; i < run.count; i++) {
        const struct jp_vehicle_run leg = {.start = zigzag[i - 1U], .targets = &zigzag[i], .count = 1};

        TEST_ASSERT_EQUAL_INT32(JP_OK, survey(&leg, i == 1U, &off));
    }
}

static void test_a_slower_run_takes_longer_and_goes_less_far_beyond_its_end(void)
{
    struct jp_leg_extent extents[2];
    jp_q16 durations[2];

    begin_balancing();
    for (uint8_t i = 0; i < 2U; i++) {
        const struct jp_vehicle_run run = {.targets = straight, .count = 1, .slower = (uint8_t)(4U * i)};

        TEST_ASSERT_EQUAL_INT32(JP_OK, vehicle.survey(vehicle.context, &run, true));
        TEST_ASSERT_EQUAL_INT32(JP_OK, vehicle.survey_leg(vehicle.context, &extents[i]));
        vehicle.forecast(vehicle.context, &durations[i], &forecast);
    }
    TEST_ASSERT_GREATER_THAN_INT32(JP_Q16(0.005), extents[0].beyond);
    TEST_ASSERT_LESS_THAN_INT32(extents[0].beyond / 2, extents[1].beyond);
    TEST_ASSERT_GREATER_THAN_INT32(durations[0] * 2, durations[1]);
}
