/* A robot that its sides steer as the navigator's vehicle: phases, turns, runs, surveys and what it learns. */
#include <joulepath/skid_vehicle.h>

#include "tests/support/skid_robot_rig.h"

#define SECONDS_MAX 120

static struct jp_path_piece pieces[JP_SKID_PILOT_PIECES(JP_SKID_RUN_MAX)];
static struct jp_skid_pilot pilot;
static struct jp_skid_vehicle skid;
static struct jp_vehicle vehicle;

/* Two corners to the left. */
static const struct jp_point targets[] = {{JP_Q16(4), 0}, {JP_Q16(4), JP_Q16(4)}, {0, JP_Q16(4)}};

static struct jp_vehicle_run run_of(uint16_t count)
{
    return (struct jp_vehicle_run){.targets = targets, .count = count};
}

static void prepare(jp_q24 corner)
{
    const struct jp_skid_pilot_config pilot_config = {.model = &jp_skid_energy_zhang2018,
                                                      .learning = &jp_skid_learning_zhang2018,
                                                      .limits = jp_path_limits_zhang2018,
                                                      .corner = corner,
                                                      .pieces = pieces,
                                                      .places = JP_SKID_PILOT_PIECES(JP_SKID_RUN_MAX)};
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_init(&pilot, &pilot_config, &robot, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_vehicle_init(&skid, &pilot, &vehicle));
}

static struct jp_vehicle_view view(void)
{
    struct jp_vehicle_view seen;

    vehicle.look(vehicle.context, &seen);
    return seen;
}

static void expect_phase(enum jp_vehicle_phase phase)
{
    TEST_ASSERT_EQUAL_INT(phase, view().phase);
}

static void drive_to_the_end(void)
{
    int ticks = 0;

    while (view().phase == JP_VEHICLE_MOVING && ticks < SECONDS_MAX * RATE) {
        run(1);
        TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.work(vehicle.context));
        ticks++;
    }
    expect_phase(JP_VEHICLE_STANDING);
}

/** What the pilot says when it has planned. */
static enum jp_status planned(void)
{
    while (pilot.phase == JP_SKID_PILOT_PLANNING) {
        (void)vehicle.work(vehicle.context);
    }
    return pilot.status;
}

static void test_init_refuses(void)
{
    prepare(0);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_vehicle_init(NULL, &pilot, &vehicle));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_vehicle_init(&skid, NULL, &vehicle));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_vehicle_init(&skid, &pilot, NULL));
}

static void test_phases(void)
{
    prepare(0);
    wake();
    expect_phase(JP_VEHICLE_OFF);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, vehicle.turn(vehicle.context, 0, NULL));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
    run(1);
    expect_phase(JP_VEHICLE_STANDING);
    TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.turn(vehicle.context, JP_ANGLE_DEGREES(30), NULL));
    expect_phase(JP_VEHICLE_MOVING); /* it is not even planned */
    const struct jp_vehicle_run straight = run_of(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, vehicle.follow(vehicle.context, &straight));
    TEST_ASSERT_EQUAL_INT(JP_OK, planned());
    expect_phase(JP_VEHICLE_MOVING); /* no tick has taken it up */
    run(1);
    expect_phase(JP_VEHICLE_MOVING);
    drive_to_the_end();
}

/* Somebody else's drive. */
static void test_a_robot_that_drives_moves(void)
{
    prepare(0);
    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &one_second));
    expect_phase(JP_VEHICLE_MOVING);
    run(1);
    expect_phase(JP_VEHICLE_MOVING);
}

/* Within a tick nothing can be seen, and nothing is driven. */
static void test_within_a_tick(void)
{
    struct jp_vehicle_view seen = {.phase = JP_VEHICLE_OFF, .position = {1, 2}, .heading = 3};

    prepare(0);
    make_standing();
    jp_skid_robot_control(&robot, JP_OK, &sensors, &actuation);
    vehicle.look(vehicle.context, &seen);
    TEST_ASSERT_EQUAL_INT(JP_VEHICLE_OFF, seen.phase);
    TEST_ASSERT_EQUAL_UINT32(3, seen.heading);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, vehicle.turn(vehicle.context, 0, NULL));
    jp_skid_robot_account(&robot);
    expect_phase(JP_VEHICLE_STANDING);
}

static void test_turns_on_the_spot(void)
{
    prepare(0);
    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.turn(vehicle.context, JP_ANGLE_DEGREES(-120), NULL));
    drive_to_the_end();
    TEST_ASSERT_INT32_WITHIN((int32_t)JP_ANGLE_DEGREES(1), 0, (int32_t)(view().heading - JP_ANGLE_DEGREES(-120)));
    TEST_ASSERT_GREATER_THAN_INT32(0, view().spent);
    TEST_ASSERT_EQUAL_INT32(
        jp_energy_to_wrapping_q16(jp_skid_robot_meter(&robot)->battery, pilot.config.model->unit_exponent),
        view().spent);
    TEST_ASSERT_EQUAL_UINT32(1, pilot.learner.state.version);
    TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.turn(vehicle.context, view().heading, NULL));
    TEST_ASSERT_EQUAL_INT(JP_OK, planned());
    expect_phase(JP_VEHICLE_STANDING); /* it has that heading */
}

static void expect_arrival(const struct jp_point *target)
{
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.03), target->x, view().position.x);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.03), target->y, view().position.y);
}

static void test_follows_a_run_round_its_corners(void)
{
    const struct jp_vehicle_run whole = run_of(3);

    for (int rounded = 0; rounded < 2; rounded++) {
        setUp();
        prepare(rounded == 1 ? JP_Q24(0.5) : 0);
        make_standing();
        TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.follow(vehicle.context, &whole));
        TEST_ASSERT_EQUAL_INT(JP_OK, planned());
        TEST_ASSERT_EQUAL_UINT16(rounded == 1 ? 7 : 5, jp_skid_pilot_path(&pilot)->count);
        TEST_ASSERT_EQUAL(rounded == 1, pieces[1].kind == JP_PIECE_CURVE);
        drive_to_the_end();
        expect_arrival(&targets[2]);
        TEST_ASSERT_EQUAL_UINT32(3, pilot.learner.state.version);
    }
}

static jp_q16 surveyed_seconds(uint16_t legs)
{
    struct jp_leg_extent extent;
    struct jp_forecast energy;
    jp_q16 duration;

    for (uint16_t leg = 0; leg < legs; leg++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.survey_leg(vehicle.context, &extent));
    }
    vehicle.forecast(vehicle.context, &duration, &energy);
    return duration;
}

static void test_slower_runs_take_longer(void)
{
    struct jp_vehicle_run slower = run_of(2);
    jp_q16 usual;

    prepare(0);
    TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.survey(vehicle.context, &slower, true));
    usual = surveyed_seconds(2);
    slower.slower = 4;
    TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.survey(vehicle.context, &slower, true));
    TEST_ASSERT_GREATER_THAN_INT32(usual, surveyed_seconds(2));
}

/* A pilot for longer routes than runs of the navigator: what surveys them has room for those. */
static void test_surveys_keep_to_their_own_room(void)
{
    const struct jp_vehicle_run usual = run_of(2);
    jp_q16 seconds;

    prepare(0);
    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.survey(vehicle.context, &usual, true));
    seconds = surveyed_seconds(2);
    pilot.config.places = JP_SKID_RUN_PIECES_MAX + 1U;
    TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.survey(vehicle.context, &usual, true));
    TEST_ASSERT_EQUAL_INT32(seconds, surveyed_seconds(2));
    TEST_ASSERT_EQUAL_UINT16(JP_SKID_RUN_PIECES_MAX, skid.survey.run.path.places);
}

static void test_a_run_that_is_stopped_teaches_nothing(void)
{
    const struct jp_vehicle_run whole = run_of(3);

    prepare(0);
    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.follow(vehicle.context, &whole));
    TEST_ASSERT_EQUAL_INT(JP_OK, planned());
    run(RATE);
    vehicle.stop(vehicle.context);
    drive_to_the_end();
    TEST_ASSERT_EQUAL_UINT32(0, pilot.learner.state.version);
}

static void test_runs_that_cannot_be_driven(void)
{
    static const struct jp_point same = {0, 0};
    static const struct jp_point far = {JP_Q16(65), 0};
    struct jp_vehicle_run bad = {.targets = &same, .count = 1};

    prepare(0);
    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.follow(vehicle.context, &bad));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, planned());
    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, vehicle.survey(vehicle.context, &bad, true));
    expect_phase(JP_VEHICLE_STANDING);
    bad.targets = &far;
    TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.follow(vehicle.context, &bad));
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, planned());
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, vehicle.survey(vehicle.context, &bad, true));
    expect_phase(JP_VEHICLE_STANDING);
}

/* Arcs lie beside both lines of their corner, and turns on the spot on them. */
static void test_survey_tells_what_room_corners_take(void)
{
    const struct jp_vehicle_run whole = run_of(3);
    struct jp_leg_extent extent;

    prepare(0);
    TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.survey(vehicle.context, &whole, true));
    for (int leg = 0; leg < 3; leg++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.survey_leg(vehicle.context, &extent));
        TEST_ASSERT_EQUAL_INT32(0, extent.aside);
        TEST_ASSERT_EQUAL_INT32(0, extent.beyond);
    }
    prepare(JP_Q24(0.5));
    TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.survey(vehicle.context, &whole, true));
    for (int leg = 0; leg < 3; leg++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.survey_leg(vehicle.context, &extent));
        TEST_ASSERT_TRUE(extent.aside > JP_Q16(0.01) && extent.aside <= JP_Q16(0.5) + 16);
        TEST_ASSERT_EQUAL_INT32(0, extent.beyond);
    }
}

static void survey(uint16_t legs, bool anew)
{
    struct jp_vehicle_run task = run_of(legs);
    struct jp_leg_extent extent;

    task.start.y = anew ? 0 : 1; /* elsewhere */
    TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.survey(vehicle.context, &task, anew));
    for (uint16_t leg = 0; leg < legs; leg++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, vehicle.survey_leg(vehicle.context, &extent));
    }
}

static void test_forecasts_add_up_and_begin_anew(void)
{
    struct jp_forecast one;
    struct jp_forecast two;
    jp_q16 once;
    jp_q16 twice;

    prepare(JP_Q24(0.1));
    survey(3, true);
    vehicle.forecast(vehicle.context, &once, &one);
    TEST_ASSERT_TRUE(one.energy > JP_Q16(100) && one.deviation > 0 && once > JP_Q16(10));
    for (int again = 0; again < 2; again++) {
        survey(3, false);
        vehicle.forecast(vehicle.context, &twice, &two);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.1), 2 * one.energy, two.energy);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), 2 * once, twice);
    }
    survey(3, true);
    vehicle.forecast(vehicle.context, &twice, &two);
    TEST_ASSERT_EQUAL_INT32(one.energy, two.energy);
    TEST_ASSERT_EQUAL_INT32(once, twice);
}
