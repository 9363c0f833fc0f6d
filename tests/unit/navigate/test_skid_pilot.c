/* The pilot of skid steer: arguments, slices of planning, legs as planned and driven, what it learns, questions. */
#include <joulepath/battery.h>

#include "tests/support/skid_pilot_rig.h"

/* ---- Configuration ---- */

static void test_bad_arguments(void)
{
    const struct jp_skid_pilot_route route = route_of(square, 1);
    const char *field = "";

    set_up_pilot();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_init(NULL, &pilot_config, &robot, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_init(&pilot, NULL, &robot, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_init(&pilot, &pilot_config, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_init(&pilot, &pilot_config, &robot, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_follow(NULL, &route));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_follow(&pilot, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_ask(NULL, &route));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_turn(NULL, 0, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_work(NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_answer(NULL, &forecast));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_answer(&pilot, NULL));
}

static void expect_bad_field(const char *expected)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_skid_pilot_init(&pilot, &pilot_config, &robot, &field));
    TEST_ASSERT_EQUAL_STRING(expected, field);
    set_up_rig();
    set_up_pilot();
}

static void test_fields_out_of_range(void)
{
    set_up_pilot();
    pilot_config.model = NULL;
    expect_bad_field("model");
    pilot_config.learning = NULL;
    expect_bad_field("learning");
    pilot_config.pieces = NULL;
    expect_bad_field("pieces");
    pilot_config.places = 1;
    expect_bad_field("places");
    pilot_config.time = -1;
    expect_bad_field("time");
    pilot_config.corner = JP_Q24(8) + 1;
    expect_bad_field("corner");
    pilot_config.limits.width = 0;
    expect_bad_field("width");
    model.weight = 0;
    expect_bad_field("skid_energy.weight");
    learning.factors.identity = 0;
    expect_bad_field("learning.identity");
}

/* ---- Requests ---- */

static void test_requests_that_are_refused(void)
{
    struct jp_skid_pilot_route route = route_of(square, 0);

    set_up_pilot();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_follow(&pilot, &route));
    route = route_of(NULL, 1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_ask(&pilot, &route));
    route = route_of(square, 1);
    route.slower = JP_SKID_PILOT_SLOWER_MAX + 1U;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_ask(&pilot, &route));
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_skid_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_EQUAL_INT32(-1, forecast.energy);
}

/* As many targets as the memory is for can be driven, one more cannot. */
static void test_memory_tells_the_most_targets(void)
{
    static const struct jp_point zigzag[] = {
        {JP_Q16(1), JP_Q16(1)}, {JP_Q16(2), 0}, {JP_Q16(3), JP_Q16(1)}, {JP_Q16(4), 0}, {JP_Q16(5), JP_Q16(1)}};

    set_up_pilot();
    TEST_ASSERT_EQUAL_INT(JP_OK, follow(zigzag, TARGETS_MAX));
    (void)plan();
    expect_phase(JP_SKID_PILOT_DRIVING, JP_OK);
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, follow(zigzag, TARGETS_MAX + 1U));
    expect_phase(JP_SKID_PILOT_DRIVING, JP_OK); /* the earlier route goes on */
    drive_to_rest();
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    expect_near(&zigzag[TARGETS_MAX - 1U]);
}

static void test_motors_that_are_off(void)
{
    const struct jp_skid_pilot_route route = route_of(square, 1);

    set_up_pilot();
    jp_skid_robot_disable(&robot);
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_pilot_follow(&pilot, &route));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_pilot_ask(&pilot, &route));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_pilot_turn(&pilot, 0, NULL));
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
}

/* ---- Planning ---- */

static void test_nothing_is_seen_within_a_tick(void)
{
    set_up_pilot();
    follow_square();
    jp_skid_robot_control(&robot, JP_OK, &sensors, &actuation);
    for (int i = 0; i < 10; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_work(&pilot));
    }
    TEST_ASSERT_FALSE(pilot.internal.is_laid);
    jp_skid_robot_account(&robot);
}

/* The lines; their speeds from stand to stand; three legs; and the hand-over. With corners: five pieces as corners, and
 * two arcs in halves. */
static void test_slices(void)
{
    set_up_pilot();
    follow_square();
    TEST_ASSERT_EQUAL_UINT(1 + 5 + 3 + 1, plan());
    set_up_corners(JP_Q24(0.5));
    follow_square();
    TEST_ASSERT_EQUAL_UINT(1 + 5 + 1 + 2 + 3 + 1, plan());
    TEST_ASSERT_EQUAL_UINT16(3, pilot.legs_surveyed);
}

/* From one stand to the next the speeds are those of the whole path. */
static void test_speeds_are_those_of_the_whole_path(void)
{
    struct jp_path_piece whole[JP_SKID_PILOT_PIECES(SQUARE)];
    struct jp_lattice_path path = {.pieces = whole, .places = JP_SKID_PILOT_PIECES(SQUARE), .count = 5};
    struct jp_path_cost cost;

    set_up_pilot();
    const struct jp_motion_price price = jp_skid_motion_price(&pilot.learner.model, 0);

    follow_square();
    (void)plan();
    for (unsigned i = 0; i < 5; i++) {
        whole[i] = pieces[i];
        whole[i].speed = (struct jp_piece_speed){0};
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_plan_speeds(&path, &pilot_config.limits, &price, &cost));
    TEST_ASSERT_EQUAL_MEMORY(whole, pieces, 5 * sizeof whole[0]);
}

static void test_slower_routes_take_longer(void)
{
    struct jp_skid_pilot_route route = route_of(square, SQUARE);
    jp_q16 usual;

    set_up_pilot();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_ask(&pilot, &route));
    (void)plan();
    usual = pilot.duration;
    route.slower = 4;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_ask(&pilot, &route));
    (void)plan();
    TEST_ASSERT_GREATER_THAN_INT32(2 * usual, pilot.duration);
}

/* ---- Legs ---- */

/* The whole path takes what its legs take; a turn on the spot is the next leg's, an arc half of each. */
static void test_legs_add_up_to_the_path(void)
{
    static const jp_q24 turns[2][SQUARE] = {{0, JP_Q24(1.5708), JP_Q24(1.5708)},
                                            {JP_Q24(0.7854), JP_Q24(1.5708), JP_Q24(0.7854)}};

    set_up_pilot();
    for (int rounded = 0; rounded < 2; rounded++) {
        struct jp_skid_drive whole = {.energy = 0};
        jp_q16 duration = 0;
        int64_t energy = 0;

        set_up_rig();
        make_standing();
        set_up_corners(rounded * JP_Q24(0.5));
        pilot.battery_flags = JP_BATTERY_EMPTY; /* nothing is learned, which would change what is expected */
        follow_square();
        (void)plan();
        jp_skid_path_energy(&model, &pilot.internal.run.path, &whole, &duration);
        TEST_ASSERT_EQUAL_INT32(duration, pilot.duration);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_answer(&pilot, &forecast));
        TEST_ASSERT_EQUAL_INT32(whole.energy, forecast.energy);
        TEST_ASSERT_GREATER_THAN_INT32(0, forecast.deviation);
        for (uint16_t leg = 0; leg < SQUARE; leg++) {
            drive_legs(leg, 1);
            TEST_ASSERT_EQUAL_UINT16(leg + 1U, pilot.legs_begun);
            energy += pilot.internal.watch.drive.on[0].energy;
            TEST_ASSERT_TRUE(pilot.leg.speed > 0 && pilot.leg.duration > 0 && pilot.leg.energy > 0);
            TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), turns[rounded][leg], pilot.leg.turn);
        }
        TEST_ASSERT_TRUE(energy == whole.energy);
        drive_to_rest();
    }
}

static void test_legs_are_told_as_they_end(void)
{
    jp_energy before;
    uint32_t tick;

    set_up_pilot();
    follow_square();
    (void)plan();
    before = telemetry().energy;
    tick = telemetry().tick;
    for (uint16_t leg = 1; leg <= SQUARE; leg++) {
        drive_legs(leg, 1);
        TEST_ASSERT_EQUAL_UINT16(leg, pilot.result.leg);
        expect_near(&square[leg - 1U]);
        TEST_ASSERT_TRUE(pilot.result.energy > 0);
        before += pilot.result.energy;
        tick += pilot.result.ticks;
        TEST_ASSERT_EQUAL_UINT32(leg, pilot.legs_learned_from);
        TEST_ASSERT_EQUAL_INT(JP_EVIDENCE_GOOD, pilot.evidence);
    }
    /* The last tick came after the call; it takes less than a joule. */
    TEST_ASSERT_EQUAL_UINT32(telemetry().tick - 1U, tick);
    TEST_ASSERT_TRUE(before <= telemetry().energy && telemetry().energy - before < (jp_energy)1 << 32);
    drive_to_rest();
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    TEST_ASSERT_EQUAL_UINT32(0, pilot.legs_left_out);
    TEST_ASSERT_EQUAL_UINT32(SQUARE, pilot.learner.state.version);
}

/* The third leg, of 2 cm, is over between two calls: with those beside it, it cannot be told what it took. */
static void test_legs_that_end_between_two_calls(void)
{
    static const struct jp_point near[] = {{JP_Q16(2), 0}, {JP_Q16(4), 0}, {JP_Q16(4.02), 0}, {JP_Q16(6), 0}};

    set_up_pilot();
    TEST_ASSERT_EQUAL_INT(JP_OK, follow(near, 4));
    (void)plan();
    drive_legs(1, RATE);
    TEST_ASSERT_EQUAL_INT(JP_EVIDENCE_GOOD, pilot.evidence);
    drive_legs(2, RATE);
    TEST_ASSERT_EQUAL_INT(JP_EVIDENCE_INCOMPLETE, pilot.evidence);
    drive_legs(3, RATE);
    TEST_ASSERT_EQUAL_INT(JP_EVIDENCE_INCOMPLETE, pilot.evidence);
    drive_legs(4, RATE);
    TEST_ASSERT_EQUAL_INT(JP_EVIDENCE_GOOD, pilot.evidence);
    TEST_ASSERT_EQUAL_UINT32(2, pilot.legs_learned_from);
    TEST_ASSERT_EQUAL_UINT32(2, pilot.legs_left_out);
}

/* All of it driven before the next call: a leg a call is told, and then the pilot rests. */
static void test_a_route_that_is_driven_between_two_calls(void)
{
    set_up_pilot();
    follow_square();
    (void)plan();
    run(60 * RATE);
    for (uint16_t leg = 1; leg <= SQUARE; leg++) {
        expect_phase(JP_SKID_PILOT_DRIVING, JP_OK);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_work(&pilot));
        TEST_ASSERT_EQUAL_UINT16(leg, pilot.legs_ended);
        TEST_ASSERT_EQUAL_INT(JP_EVIDENCE_INCOMPLETE, pilot.evidence);
    }
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    expect_near(&square[SQUARE - 1U]);
    TEST_ASSERT_EQUAL_UINT32(0, pilot.learner.state.version);
}

/* ---- Turns ---- */

static void test_it_turns_on_the_spot(void)
{
    set_up_pilot();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_turn(&pilot, JP_ANGLE_DEGREES(-120), NULL));
    (void)plan();
    TEST_ASSERT_EQUAL_INT32(0, pilot.leg.speed);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(-2.0944), pilot.leg.turn);
    drive_to_rest();
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    TEST_ASSERT_INT32_WITHIN((int32_t)JP_ANGLE_DEGREES(1), 0,
                             (int32_t)(jp_phase_angle(telemetry().heading) - JP_ANGLE_DEGREES(-120)));
    TEST_ASSERT_EQUAL_UINT16(1, pilot.legs_ended);
    TEST_ASSERT_EQUAL_UINT32(1, pilot.legs_learned_from);
}

static void test_a_heading_that_it_has(void)
{
    set_up_pilot();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_turn(&pilot, jp_phase_angle(telemetry().heading), NULL));
    (void)plan();
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    TEST_ASSERT_EQUAL_UINT16(0, pilot.legs_begun);
}

/* ---- Grounds ---- */

static uint8_t class_of_all = 0;

static jp_q16 level_at(const void *context, const struct jp_point *point)
{
    (void)context;
    (void)point;
    return 0;
}

static uint8_t class_at(const void *context, const struct jp_point *point)
{
    (void)context;
    (void)point;
    return class_of_all;
}

static const struct jp_ground classed = {level_at, class_at, NULL, JP_Q16(0.5), 0};
static struct jp_skid_grounds known_grounds;

static void set_up_grounds(void)
{
    set_up_pilot();
    pilot_config.grounds = &known_grounds;
    pilot_config.ground_learning = &jp_ground_learning;
    init_pilot();
}

static void drive_square_on(uint8_t ground)
{
    struct jp_skid_pilot_route route = route_of(square, SQUARE);

    class_of_all = ground;
    route.ground = &classed;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_follow(&pilot, &route));
    drive_to_rest();
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
}

static void test_legs_teach_the_class_of_their_ground(void)
{
    set_up_grounds();
    drive_square_on(1);
    TEST_ASSERT_EQUAL_UINT32(SQUARE, pilot.legs_learned_from);
    TEST_ASSERT_EQUAL_UINT32(0, pilot.learner.state.version);
    TEST_ASSERT_EQUAL_UINT32(SQUARE, known_grounds.learner.states[1].version);
    TEST_ASSERT_EQUAL_UINT32(0, known_grounds.learner.states[2].version);
    TEST_ASSERT_NOT_EQUAL(known_grounds.models[1].rolling, known_grounds.models[2].rolling);
    class_of_all = 2;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_turn(&pilot, JP_ANGLE_DEGREES(200), &classed));
    drive_to_rest();
    TEST_ASSERT_EQUAL_UINT32(1, known_grounds.learner.states[2].version);
}

/* As without grounds. */
static void test_legs_on_class_0_teach_the_robot(void)
{
    struct jp_learned_state learned;

    set_up_pilot();
    drive_square_on(3);
    learned = pilot.learner.state;
    set_up_rig();
    set_up_grounds();
    drive_square_on(0);
    TEST_ASSERT_EQUAL_UINT32(SQUARE, pilot.learner.state.version);
    TEST_ASSERT_EQUAL_MEMORY(&learned, &pilot.learner.state, sizeof learned);
    TEST_ASSERT_EQUAL_MEMORY(&pilot.learner.model, &known_grounds.models[3], sizeof pilot.learner.model);
}

/* In bands of 1 m across the x axis. */
static uint8_t class_in_bands(const void *context, const struct jp_point *point)
{
    (void)context;
    return point->x > 0 && (point->x / JP_Q16(1)) % 2 == 1 ? 1 : 0;
}

static void drive_over_bands(uint32_t ticks_a_call)
{
    static const struct jp_ground bands = {level_at, class_in_bands, NULL, JP_Q16(0.1), 0};
    struct jp_skid_pilot_route route = route_of(square, 1);

    route.ground = &bands;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_follow(&pilot, &route));
    drive_legs(1, ticks_a_call);
}

/* The leg lies on four bands, the turn before it on none of them. */
static void test_what_is_learned_from_are_the_parts_of_a_leg_on_one_ground(void)
{
    set_up_grounds();
    drive_over_bands(1);
    TEST_ASSERT_EQUAL_UINT16(1, pilot.legs_ended);
    TEST_ASSERT_EQUAL_UINT32(4, pilot.legs_learned_from);
    TEST_ASSERT_EQUAL_UINT32(2, known_grounds.learner.states[1].version);
    TEST_ASSERT_EQUAL_UINT32(2, pilot.learner.state.version);
}

static void test_parts_that_end_between_two_calls_teach_nothing(void)
{
    set_up_grounds();
    drive_over_bands(4 * RATE);
    TEST_ASSERT_EQUAL_UINT16(1, pilot.legs_ended);
    TEST_ASSERT_GREATER_THAN_UINT32(0, pilot.legs_left_out);
    TEST_ASSERT_LESS_THAN_UINT32(4, pilot.legs_learned_from);
}

static void test_forecasts_are_by_the_class_of_the_ground(void)
{
    struct jp_skid_pilot_route route = route_of(square, SQUARE);
    struct jp_forecast on_class[2];

    set_up_grounds();
    route.ground = &classed;
    for (uint8_t k = 0; k < 2U; k++) {
        known_grounds.models[1].rolling = 3 * known_grounds.models[0].rolling;
        class_of_all = k;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_ask(&pilot, &route));
        (void)plan();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_answer(&pilot, &on_class[k]));
    }
    TEST_ASSERT_GREATER_THAN_INT32(on_class[0].energy / 5 * 6, on_class[1].energy);
    TEST_ASSERT_GREATER_THAN_INT32(3 * on_class[0].deviation, on_class[1].deviation);
}

static void test_learning_of_grounds_that_is_refused(void)
{
    struct jp_factor_learning wrong = jp_ground_learning;
    const char *field = "";

    set_up_grounds();
    wrong.memory = 0;
    pilot_config.ground_learning = &wrong;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_skid_pilot_init(&pilot, &pilot_config, &robot, &field));
    TEST_ASSERT_EQUAL_STRING("learning.memory", field);
    pilot_config.ground_learning = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_skid_pilot_init(&pilot, &pilot_config, &robot, &field));
    TEST_ASSERT_EQUAL_STRING("ground_learning", field);
}

/* ---- Questions ---- */

static void test_a_question_is_answered_without_driving(void)
{
    const struct jp_skid_pilot_route route = route_of(square, SQUARE);

    set_up_pilot();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_ask(&pilot, &route));
    TEST_ASSERT_EQUAL_INT(JP_WORKING, jp_skid_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_pilot_ask(&pilot, &route));
    (void)plan();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_GREATER_THAN_INT32(JP_Q16(100), forecast.energy);
    expect_phase(JP_SKID_PILOT_RESTING, JP_OK);
    TEST_ASSERT_FALSE(jp_skid_robot_has_next(&robot));
    TEST_ASSERT_EQUAL_UINT16(0, pilot.legs_begun);
}

static void test_no_question_while_the_robot_drives(void)
{
    const struct jp_skid_pilot_route route = route_of(square, 1);

    set_up_pilot();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &one_second));
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_pilot_ask(&pilot, &route));
}

static void expect_no_format(jp_q16 electronics_power)
{
    static const struct jp_point far[] = {{JP_Q16(60), 0}, {0, 0}, {JP_Q16(60), 0}, {0, 0}};
    struct jp_skid_pilot_route route = route_of(far, 4);

    model.electronics_power = electronics_power;
    model.unit_exponent = 0;
    init_pilot();
    route.slower = JP_SKID_PILOT_SLOWER_MAX;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_ask(&pilot, &route));
    (void)plan();
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_skid_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_follow(&pilot, &route)); /* it is driven all the same */
    (void)plan();
    expect_phase(JP_SKID_PILOT_DRIVING, JP_OK);
}

/* 240 m in about an hour: their sum, and then each of the legs, is above 32 767 J. */
static void test_a_forecast_that_has_no_format(void)
{
    set_up_pilot();
    expect_no_format(JP_Q16(16));
    set_up_rig();
    set_up_pilot();
    expect_no_format(JP_Q16(512));
}

/* A bus that lacks voltage */

/** V that turn the wheels of a side at so many m/s. */
static jp_q16 volts_of(jp_q24 speed)
{
    const struct jp_skid_control_config *const control = &jp_skid_robot_configuration(&robot)->control;

    return jp_multiply_shift(jp_q24_multiply(speed, control->turns_per_metre), control->back_emf, 24);
}

static void test_lacking_voltage_slows_what_is_planned(void)
{
    struct jp_path_limits designed;
    jp_q16 volts;

    set_up_pilot();
    designed = pilot.config.limits;
    volts = volts_of(JP_Q24(0.2));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_lack_voltage(&pilot, volts));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), designed.speed - JP_Q24(0.2), pilot.config.limits.speed);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), designed.side_speed - JP_Q24(0.2), pilot.config.limits.side_speed);
    follow_square();
    (void)plan();
    drive_legs(1, 1);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(pilot.config.limits.speed, pilot.leg.speed);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_lack_voltage(&pilot, 0));
    TEST_ASSERT_EQUAL_INT32(designed.speed, pilot.config.limits.speed);
    TEST_ASSERT_EQUAL_INT32(designed.side_speed, pilot.config.limits.side_speed);
}

static void test_voltage_that_leaves_no_motion_is_refused(void)
{
    jp_q24 designed;

    set_up_pilot();
    designed = pilot.config.limits.speed;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_lack_voltage(&pilot, volts_of(designed / 8 * 7 - JP_Q24(0.001))));
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE,
                          jp_skid_pilot_lack_voltage(&pilot, volts_of(designed / 8 * 7 + JP_Q24(0.001))));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.002), designed / 8, pilot.config.limits.speed);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_lack_voltage(&pilot, -1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_pilot_lack_voltage(NULL, 0));
}
