/* Slip of the treads by the formulas of skid_odometry.h, each part by itself: what a step goes forward and sideways,
 * what its turn is held for, and what the currents of a turn tell of the ground. */
#include "src/skid_steer/skid_arithmetic.h"
#include "src/skid_steer/skid_slip.h"
#include "src/skid_steer/skid_tilt.h"
#include "tests/support/random.h"
#include "unity.h"

#define ETA_ONE  32768 /* Q15 */
#define TWO_PI   6.283185307179586
#define CASES    60
#define IN_Q24   16777216.0
#define IN_Q32   4294967296.0
#define PER_TURN 20.0 /* of the grip: 1/e after 1/3 rad is 1/20 turn */

static struct jp_skid_odometry_config config;
static struct jp_skid_slip slip;
static struct jp_skid_step step;
static struct jp_skid_tilt tilt;

void setUp(void)
{
    config = (struct jp_skid_odometry_config){
        .creep = JP_Q24(0.2),
        .turn_creep_along = JP_Q24(0.4),
        .turn_creep_across = JP_Q24(0.7),
        .turn_shift_along = JP_Q24(0.3),
        .turn_shift_across = JP_Q24(0.5),
        .turn_slide_most = JP_Q24(0.25),
        .caster_drag = JP_Q24(0.03),
        .turn_force = JP_Q24(0.4),
        .force_per_ampere = JP_Q24(0.1),
        .efficiency = JP_Q24(0.5),
        .rolling = JP_Q24(0.04),
        .ratio_growth = JP_Q24(1.5),
    };
    step = (struct jp_skid_step){0};
    tilt = (struct jp_skid_tilt){0};
    begin_random(11, 0);
    jp_skid_slip_start(&slip, &config, (int32_t)(63.7 * 256));
}

void tearDown(void)
{
}

static double of_q24(int32_t x)
{
    return x / IN_Q24;
}

static double of_q32(int32_t x)
{
    return x / IN_Q32;
}

static double size(double x)
{
    return x < 0 ? -x : x;
}

static double lesser(double a, double b)
{
    return a < b ? a : b;
}

/** Within a share of 2⁻¹⁶ and a few of the last bits of Q32. */
static void expect_q32(double expected, int32_t actual)
{
    const int32_t near = (int32_t)(expected * IN_Q32);

    TEST_ASSERT_INT32_WITHIN(64 + (near < 0 ? -(near >> 16) : near >> 16), near, actual);
}

/* ---- Start ---- */

static void test_lengths_of_a_radian_become_those_of_a_turn(void)
{
    TEST_ASSERT_INT32_WITHIN(8, JP_Q24(0.4 * TWO_PI), slip.creep_along);
    TEST_ASSERT_INT32_WITHIN(8, JP_Q24(0.7 * TWO_PI), slip.creep_across);
    TEST_ASSERT_INT32_WITHIN(8, JP_Q24(0.3 * TWO_PI), slip.shift_along);
    TEST_ASSERT_INT32_WITHIN(8, JP_Q24(0.5 * TWO_PI), slip.shift_across);
    TEST_ASSERT_INT32_WITHIN(8, JP_Q24(0.25 * TWO_PI), slip.most);
    TEST_ASSERT_INT32_WITHIN(8, JP_Q24(0.1 * TWO_PI), slip.held);
    TEST_ASSERT_INT32_WITHIN(1, JP_Q16(1 / (0.25 * TWO_PI)), slip.per_most);
    TEST_ASSERT_INT32_WITHIN(3, (int32_t)(63.7 * 256 * TWO_PI), slip.centripetal);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(2), slip.braking);
    TEST_ASSERT_EQUAL_INT32(config.turn_force, slip.turn_force);
    TEST_ASSERT_EQUAL_INT32(4096, slip.looseness);
}

static void test_what_may_not_slide_has_the_greatest_reciprocal(void)
{
    config.turn_slide_most = 0;
    jp_skid_slip_start(&slip, &config, 256);
    TEST_ASSERT_EQUAL_INT32(0, slip.most);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, slip.per_most);
    config.turn_slide_most = 1; /* 2⁻²⁴ m */
    jp_skid_slip_start(&slip, &config, 256);
    TEST_ASSERT_EQUAL_INT32(6, slip.most);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, slip.per_most);
    slip.per_most = 0;
    config.turn_slide_most = JP_Q24(4);
    jp_skid_slip_start(&slip, &config, 256);
    TEST_ASSERT_INT32_WITHIN(1, JP_Q16(1 / (4 * TWO_PI)), slip.per_most);
}

/* ---- The share that treads yield ---- */

/** Of what would slip across by x of the most, x in Q12. */
static int32_t yielding_of(int32_t x)
{
    slip.per_most = JP_Q16_ONE; /* the most is 1 m a turn */
    slip.creep_across = JP_Q24_ONE;
    slip.shift_across = 0;
    tilt.state[JP_SKID_TILT_LEFT] = -x * 4096;
    jp_skid_slip_move(&slip, &config, &tilt, &step);
    return slip.yielding;
}

/** (y/2¹⁵)⁴ (1 + x⁴) of x in Q12. */
static double fourth_power(double y, int32_t x)
{
    const double share = y / ETA_ONE;
    const double of_most = x / 4096.0;

    return share * share * share * share * (1 + of_most * of_most * of_most * of_most);
}

/* Each knot is the nearest number to (1 + x⁴)^(-1/4): half a bit less is too little, half a bit more too much. */
static void test_knots_of_what_treads_yield_are_exact(void)
{
    for (int32_t knot = 0; knot < 16; knot++) {
        const int32_t x = knot * 1024;
        const int32_t y = yielding_of(x);

        TEST_ASSERT_TRUE(fourth_power(y - 0.5, x) <= 1);
        TEST_ASSERT_TRUE(fourth_power(y + 0.5, x) >= 1);
    }
}

static void test_between_the_knots_it_is_a_line(void)
{
    for (int32_t knot = 0; knot < 15; knot++) {
        const int32_t low = yielding_of(knot * 1024);
        const int32_t high = yielding_of((knot + 1) * 1024);

        for (int32_t part = 0; part < 1024; part += 31) {
            const int32_t x = knot * 1024 + part;

            TEST_ASSERT_INT32_WITHIN(1, low - (low - high) * part / 1024, yielding_of(x));
            TEST_ASSERT_INT32_WITHIN(1, yielding_of(x), yielding_of(-x));
        }
    }
}

static void test_beyond_the_last_knot_it_stays(void)
{
    const int32_t last = yielding_of(15 * 1024);

    TEST_ASSERT_TRUE(yielding_of(15 * 1024 - 512) > last);
    TEST_ASSERT_EQUAL_INT32(last, yielding_of(15 * 1024 + 1));
    TEST_ASSERT_EQUAL_INT32(last, yielding_of(1 << 18));
}

/* ---- The step ---- */

struct movement {
    double forward;
    double sideways;
    double along;  /* m/turn */
    double across; /* m/turn */
    double wanted; /* m/turn */
};

/** The formulas of skid_odometry.h, with the share η that was found. */
static struct movement formulas(void)
{
    const double eta = slip.yielding / (double)ETA_ONE;
    const double way = of_q32(step.way);
    const double turn = of_q32(step.turn);
    const double sign_of_way = way < 0 ? -1 : 1;
    const double sign_of_turn = turn < 0 ? -1 : 1;
    const double creep = of_q24(config.creep);
    const double ahead =
        of_q24(step.force) - of_q24(tilt.state[JP_SKID_TILT_OFFSET]) + sign_of_way * of_q24(config.caster_drag);
    const double left = of_q24(tilt.state[JP_SKID_TILT_LEFT]) + way * turn * (slip.centripetal / 256.0);
    const double most = of_q24(slip.most);
    struct movement m;

    m.wanted = sign_of_turn * of_q24(slip.shift_across) * ahead - of_q24(slip.creep_across) * left;
    m.along = of_q24(slip.creep_along) * ahead * eta;
    m.across = m.wanted * eta > most ? most : m.wanted * eta < -most ? -most : m.wanted * eta;

    const double rolled_aside = creep * size(way) - size(turn) * of_q24(slip.held);

    m.forward = way + turn * of_q24(slip.shift_along) * left * eta - creep * size(way) * ahead - size(turn) * m.along -
                sign_of_way * of_q24(slip.turn_force) * creep * lesser(size(way), of_q32(step.side_way));
    m.sideways = size(turn) * m.across - (rolled_aside > 0 ? rolled_aside : 0) * left;
    return m;
}

static int32_t any(double low, double high, double one)
{
    return (int32_t)(one * uniform(low, high));
}

static void draw_step(void)
{
    step.way = any(-0.06, 0.06, IN_Q32);
    step.side_way = any(0, 0.06, IN_Q32);
    step.turn = any(-0.02, 0.02, IN_Q32);
    step.force = any(-0.4, 0.4, IN_Q24);
    tilt.state[JP_SKID_TILT_OFFSET] = any(-0.1, 0.1, IN_Q24);
    tilt.state[JP_SKID_TILT_LEFT] = any(-0.3, 0.3, IN_Q24);
}

static void expect_formulas(void)
{
    const int32_t before = step.forward;

    jp_skid_slip_move(&slip, &config, &tilt, &step);
    const struct movement m = formulas();

    expect_q32(m.forward, step.forward);
    expect_q32(m.sideways, step.sideways);
    TEST_ASSERT_INT32_WITHIN(32, (int32_t)(m.wanted * IN_Q24), slip.wanted);
    TEST_ASSERT_INT32_WITHIN(32, (int32_t)(m.along * IN_Q24), slip.along);
    TEST_ASSERT_INT32_WITHIN(32, (int32_t)(m.across * IN_Q24), slip.across);
    TEST_ASSERT_EQUAL_INT32(before, step.forward_before);
}

static void test_a_step_slips_by_the_formulas(void)
{
    for (int i = 0; i < CASES; i++) {
        draw_step();
        expect_formulas();
        step.way = 0; /* on the spot */
        expect_formulas();
        step.turn = 0; /* nowhere */
        expect_formulas();
        draw_step();
        step.turn = 0; /* straight on */
        expect_formulas();
    }
}

/* On level ground, to the last bit. */
static void test_a_turn_to_the_right_mirrors_one_to_the_left(void)
{
    for (int i = 0; i < CASES; i++) {
        draw_step();
        tilt.state[JP_SKID_TILT_LEFT] = 0;
        step.way = 0;
        step.turn = any(0.001, 0.02, IN_Q32);
        jp_skid_slip_move(&slip, &config, &tilt, &step);
        const int32_t wanted = slip.wanted;

        step.turn = -step.turn;
        jp_skid_slip_move(&slip, &config, &tilt, &step);
        TEST_ASSERT_EQUAL_INT32(-wanted, slip.wanted);
    }
    step.force = 0;
    config.caster_drag = 0;
    tilt.state[JP_SKID_TILT_OFFSET] = 0;
    jp_skid_slip_move(&slip, &config, &tilt, &step);
    TEST_ASSERT_EQUAL_INT32(0, slip.wanted);
}

/* Not a bit of what rolls across the steepest slope. */
static void test_a_tight_turn_holds_all_that_rolls_across(void)
{
    slip.creep_across = 0;
    slip.shift_across = 0;
    tilt.state[JP_SKID_TILT_LEFT] = -JP_Q24(0.9);
    step.turn = (int32_t)(0.02 * IN_Q32);
    step.way = (int32_t)(0.01 * IN_Q32);
    jp_skid_slip_move(&slip, &config, &tilt, &step);
    TEST_ASSERT_EQUAL_INT32(0, step.sideways);
}

/* ---- The turn by the wheels ---- */

/** With a slip along and across, m/turn. */
static void push(double along, double across)
{
    slip.along = (int32_t)(along * IN_Q24);
    slip.wanted = (int32_t)(across * IN_Q24);
    step.wheel_turn = 1 << 26;
    jp_skid_slip_push(&slip, &config, &step);
}

static void expect_growth(double expected)
{
    TEST_ASSERT_INT32_WITHIN(64, (int32_t)((1 << 26) * (1 + expected)), step.pushed_turn);
}

/* It grows with the square of what pushes it aside, and falls with that of what pushes it along. */
static void test_the_ratio_grows_by_the_difference_of_the_squares(void)
{
    push(0, 0);
    expect_growth(0);
    TEST_ASSERT_EQUAL_INT32(0, step.pushed);
    push(0, 0.2);
    expect_growth(1.5 * 0.04);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q24(1.5 * 0.04 / 8), step.pushed);
    push(0.2, 0);
    expect_growth(-1.5 * 0.04);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q24(1.5 * 0.04), step.pushed);
    push(-0.1, -0.3);
    expect_growth(1.5 * (0.09 - 0.01));
    TEST_ASSERT_INT32_WITHIN(4, JP_Q24(1.5 * (0.09 / 8 + 0.01)), step.pushed);
}

static void test_the_ratio_grows_by_a_quarter_at_most(void)
{
    push(0, 0.408);
    expect_growth(1.5 * 0.408 * 0.408);
    push(0, 0.42);
    expect_growth(0.25);
    push(0.42, 0);
    expect_growth(-0.25);
}

/* ---- Grip ---- */

/** The force of a side, g, from its current in A. */
static double force_of(double ampere, int32_t counts)
{
    const double motor = 0.1 * ampere;
    const double behind_gear = (motor >= 0) == (counts >= 0) ? 0.5 * motor : motor / 0.5;

    return behind_gear - (counts < 0 ? -0.02 : 0.02);
}

/** The step's currents teach, of a force that was `before`. */
static void expect_learned(double left, double right, double before)
{
    slip.turn_force = (int32_t)(before * IN_Q24);
    step.current[JP_SKID_LEFT] = (jp_q16)(left * 65536);
    step.current[JP_SKID_RIGHT] = (jp_q16)(right * 65536);
    const double eta = slip.yielding / (double)ETA_ONE;
    const double turned = size(of_q32(step.turn));
    const double between = force_of(right, step.counts[JP_SKID_RIGHT]) - force_of(left, step.counts[JP_SKID_LEFT]);
    const double shown = step.turn < 0 ? -between : between;
    const double weight = lesser(PER_TURN * turned, 1);
    const double learned = before + (shown - before * eta) * weight;
    const double least = 0.4 / 8;
    const double limited = learned < least ? least : lesser(learned, 0.8);

    jp_skid_slip_learn(&slip, &config, &step);
    TEST_ASSERT_INT32_WITHIN(64, (int32_t)(limited * IN_Q24), slip.turn_force);
    TEST_ASSERT_INT32_WITHIN(slip.looseness / 200, (int32_t)(0.4 / limited * 4096), slip.looseness);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.2), (int32_t)(0.4 / limited * 0.4 * TWO_PI * IN_Q24), slip.creep_along);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.2), (int32_t)(0.4 / limited * 0.7 * TWO_PI * IN_Q24), slip.creep_across);
}

static void turn_on_the_spot(double turn)
{
    step.turn = (int32_t)(turn * IN_Q32);
    step.counts[JP_SKID_LEFT] = turn < 0 ? 100 : -100;
    step.counts[JP_SKID_RIGHT] = turn < 0 ? -100 : 100;
    slip.yielding = ETA_ONE * 3 / 4;
}

static void test_a_turn_teaches_the_force_that_it_takes(void)
{
    turn_on_the_spot(0.01);
    expect_learned(-4, 4, 0.3);
    expect_learned(-3, 6, 0.3);
    expect_learned(-6, 2, 0.3);
    expect_learned(-6, -1, 0.3); /* the right side brakes */
    expect_learned(1, 7, 0.3);   /* the left side does */
    turn_on_the_spot(-0.01);
    expect_learned(4, -4, 0.3);
    expect_learned(6, -3, 0.3);
    expect_learned(5, 1, 0.3);
}

static void test_the_longer_it_turns_the_more_it_teaches(void)
{
    for (int i = 1; i < 8; i++) {
        turn_on_the_spot(0.008 * i); /* all of it from 1/20 turn on */
        expect_learned(-5, 4, 0.2);
        turn_on_the_spot(-0.008 * i);
        expect_learned(5, -4, 0.2);
    }
}

static void test_the_force_of_a_turn_is_limited_by_the_files(void)
{
    turn_on_the_spot(0.2);
    expect_learned(-100, 100, 0.3);
    TEST_ASSERT_EQUAL_INT32(2 * config.turn_force, slip.turn_force);
    expect_learned(100, -100, 0.3);
    TEST_ASSERT_EQUAL_INT32(config.turn_force / 8, slip.turn_force);
}

/* Side by side: a side that stands counts as one that goes ahead. */
static void test_a_side_that_stands_rolls_ahead(void)
{
    turn_on_the_spot(0.01);
    step.counts[JP_SKID_LEFT] = 0;
    expect_learned(-4, 4, 0.3);
    expect_learned(4, 4, 0.3);
    step.counts[JP_SKID_LEFT] = -1;
    expect_learned(-4, 4, 0.3);
    expect_learned(0, 4, 0.3);
}

/* Signs alone tell whether a side drives, even where force and counts are one number. */
static void test_a_side_whose_force_is_the_number_of_its_counts_drives(void)
{
    const int32_t number = 4000 * 256;

    config.force_per_ampere = JP_Q24_ONE;
    config.rolling = 0;
    step.turn = (int32_t)1 << 30;
    slip.yielding = ETA_ONE;
    step.counts[JP_SKID_LEFT] = -number;
    step.counts[JP_SKID_RIGHT] = number;
    step.current[JP_SKID_LEFT] = -4000;
    step.current[JP_SKID_RIGHT] = 4000;
    jp_skid_slip_learn(&slip, &config, &step);
    TEST_ASSERT_INT32_WITHIN(16, 0.5 * 2 * number, slip.turn_force);
}

/** Whether a step with these increments teaches anything. */
static bool teaches(double way, double turn)
{
    turn_on_the_spot(turn);
    step.way = (int32_t)(way * IN_Q32);
    step.current[JP_SKID_LEFT] = -JP_Q16(1);
    step.current[JP_SKID_RIGHT] = JP_Q16(1);
    slip.turn_force = JP_Q24(0.3);
    slip.creep_along = JP_Q24(2);
    jp_skid_slip_learn(&slip, &config, &step);
    return slip.turn_force != JP_Q24(0.3);
}

/* A turn of 0.04 creeps 0.08 m along, an eighth of which is what 0.05 m creep by 0.2. */
static void test_turns_so_tight_that_they_creep_eight_times_the_way_teach(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_TRUE(teaches(sign * 0.0499, 0.04));
        TEST_ASSERT_FALSE(teaches(sign * 0.0501, 0.04));
        TEST_ASSERT_TRUE(teaches(sign * 0.0499, -0.04));
        TEST_ASSERT_FALSE(teaches(sign * 0.0501, -0.04));
    }
    TEST_ASSERT_FALSE(teaches(0, 0));
}

static void test_robots_that_turn_freely_tell_nothing_of_the_ground(void)
{
    config.turn_force = JP_Q24(0.05);
    TEST_ASSERT_TRUE(teaches(0, 0.04));
    config.turn_force = JP_Q24(0.05) - 1;
    TEST_ASSERT_FALSE(teaches(0, 0.04));
    config.turn_force = 0;
    TEST_ASSERT_FALSE(teaches(0, 0.04));
}

/* What treads creep in a turn goes with the ground, whether or not a step teaches. */
static void test_creep_of_a_turn_goes_with_the_looseness(void)
{
    slip.looseness = 8192;
    jp_skid_slip_learn(&slip, &config, &step);
    TEST_ASSERT_INT32_WITHIN(8, JP_Q24(2 * 0.4 * TWO_PI), slip.creep_along);
    TEST_ASSERT_INT32_WITHIN(8, JP_Q24(2 * 0.7 * TWO_PI), slip.creep_across);
}

/* Ground that takes half of the force lets the treads creep twice as far. */
static void test_looseness_is_the_inverse_of_the_force(void)
{
    config.turn_force = JP_Q24(0.5);
    slip.turn_force = JP_Q24(0.25);
    turn_on_the_spot(0.01);
    step.current[JP_SKID_LEFT] = -JP_Q16(2.275); /* 2 (0.05 i − 0.02) g, ¾ of 0.25 g */
    step.current[JP_SKID_RIGHT] = JP_Q16(2.275);
    jp_skid_slip_learn(&slip, &config, &step);
    TEST_ASSERT_INT32_WITHIN(512, JP_Q24(0.25), slip.turn_force);
    TEST_ASSERT_INT32_WITHIN(8, 8192, slip.looseness);
}
