/* The controller: configuration, each gain, limits in their order, integrators and their anti-windup. */
#include <joulepath/lqr.h>
#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "tests/support/config_check.h"
#include "unity.h"

#define TURN ((int64_t)JP_PHASE_TURN)

static struct jp_lqr_config config;
static struct jp_lqr lqr;
static struct jp_reference reference;
static struct jp_motion_state state;
static struct jp_voltages voltages;

void setUp(void)
{
    config = (struct jp_lqr_config){.tick_rate = 1000};
    lqr = (struct jp_lqr){0};
    reference = (struct jp_reference){.phase_per_rate = 4294967};
    state = (struct jp_motion_state){0};
}

void tearDown(void)
{
}

static void start(void)
{
    jp_lqr_start(&lqr, &config);
}

static void update(jp_q16 limit)
{
    jp_lqr_update(&lqr, &config, &reference, &state, limit, &voltages);
}

static void expect(jp_q16 left, jp_q16 right, bool saturated)
{
    TEST_ASSERT_EQUAL_INT32(left, voltages.left);
    TEST_ASSERT_EQUAL_INT32(right, voltages.right);
    TEST_ASSERT_TRUE(voltages.saturated == saturated);
}

DEFINE_EXPECT_CONFIG(lqr)

#define COMMON_ROW     "lqr.wheel"
#define DIFFERENCE_ROW "lqr.yaw"

static void test_checks_every_field_at_its_limits(void)
{
    config = jp_robot_courier24.lqr;
    expect_config(NULL);
    RANGE("lqr.", tick_rate, 100, 10000);
    FIELD(wheel, INT32_MIN, COMMON_ROW);
    FIELD(pitch, INT32_MIN, COMMON_ROW);
    FIELD(wheel_rate, INT32_MAX, COMMON_ROW);
    FIELD(pitch_rate, INT32_MAX, COMMON_ROW);
    FIELD(wheel_integral, INT32_MIN, COMMON_ROW);
    FIELD(yaw, INT32_MIN, DIFFERENCE_ROW);
    FIELD(yaw_rate, INT32_MAX, DIFFERENCE_ROW);
    FIELD(yaw_integral, INT32_MAX, DIFFERENCE_ROW);
    AT_LEAST("lqr.", pitch_reserve, 0);
    FIELD(pitch_reserve, INT32_MAX, NULL);
}

static void test_rows_add_up_to_their_limit(void)
{
    config = (struct jp_lqr_config){.tick_rate = 1000, .pitch = INT32_MIN + 1, .yaw = INT32_MAX};
    expect_config(NULL);
    config = (struct jp_lqr_config){.tick_rate = 1000, .pitch = INT32_MIN + 1, .wheel_rate = 1, .yaw = 1};
    expect_config(COMMON_ROW);
    config =
        (struct jp_lqr_config){.tick_rate = 1000, .wheel = INT32_MIN, .pitch = INT32_MIN, .wheel_rate = 1, .yaw = 1};
    expect_config(COMMON_ROW); /* 2³² and 1 */
    config = (struct jp_lqr_config){.tick_rate = 1000, .pitch = 1, .yaw = INT32_MAX, .yaw_rate = -1};
    expect_config(DIFFERENCE_ROW);
    config = (struct jp_lqr_config){.tick_rate = 1000, .yaw = 1};
    expect_config(COMMON_ROW);
    config = (struct jp_lqr_config){.tick_rate = 1000, .pitch = 1};
    expect_config(DIFFERENCE_ROW);
}

static void test_gain_of_a_tick_fits(void)
{
    const jp_q16 limit = (jp_q16)(((int64_t)INT32_MAX * 100) >> 10); /* 3 200 V/(turn·s) at 100 Hz */

    config = (struct jp_lqr_config){.tick_rate = 100, .wheel_integral = limit, .yaw_integral = -limit};
    expect_config(NULL);
    config = (struct jp_lqr_config){.tick_rate = 100, .wheel_integral = limit + 1, .yaw_integral = 1};
    expect_config("lqr.wheel_integral");
    config = (struct jp_lqr_config){.tick_rate = 100, .wheel_integral = 1, .yaw_integral = -limit - 1};
    expect_config("lqr.yaw_integral");
}

static void test_each_gain_moves_its_row(void)
{
    config = (struct jp_lqr_config){.tick_rate = 1000,
                                    .wheel = JP_Q16(1),
                                    .pitch = JP_Q16(-2),
                                    .wheel_rate = JP_Q16(3),
                                    .pitch_rate = JP_Q16(4),
                                    .yaw = JP_Q16(5),
                                    .yaw_rate = JP_Q16(-6)};
    start();
    reference.wheel.angle = JP_PHASE_TURN;
    update(JP_Q16(100));
    expect(JP_Q16(1), JP_Q16(1), false);

    state.wheel = JP_PHASE_TURN;
    state.pitch = JP_Q24(0.25);
    update(JP_Q16(100));
    expect(JP_Q16(0.5), JP_Q16(0.5), false);

    state.pitch = 0;
    reference.wheel.rate = JP_Q24(1.5);
    state.wheel_rate = JP_Q24(-0.5);
    update(JP_Q16(100));
    expect(JP_Q16(6), JP_Q16(6), false);

    state.wheel_rate = JP_Q24(1.5);
    state.pitch_rate = JP_Q24(-1);
    update(JP_Q16(100));
    expect(JP_Q16(4), JP_Q16(4), false);

    state.pitch_rate = 0;
    reference.yaw.angle = JP_PHASE_TURN / 2;
    update(JP_Q16(100));
    expect(JP_Q16(-2.5), JP_Q16(2.5), false);

    state.yaw = JP_PHASE_TURN / 2;
    reference.yaw.rate = JP_Q24(1);
    update(JP_Q16(100));
    expect(JP_Q16(6), JP_Q16(-6), false);
}

static void test_errors_cross_the_wrap_of_the_phases(void)
{
    config.wheel = JP_Q16(10);
    config.yaw = JP_Q16(10);
    start();
    reference.wheel.angle = JP_PHASE_TURN / 10;
    state.wheel = (jp_phase)0 - JP_PHASE_TURN / 10;
    reference.yaw.angle = ((jp_phase)1 << 63) - JP_PHASE_TURN / 4;
    state.yaw = ((jp_phase)1 << 63) + JP_PHASE_TURN / 4;
    update(JP_Q16(100));
    TEST_ASSERT_INT32_WITHIN(2, JP_Q16(2) + JP_Q16(5), voltages.left);
    TEST_ASSERT_INT32_WITHIN(2, JP_Q16(2) - JP_Q16(5), voltages.right);
}

static void test_errors_are_limited_to_64_turns(void)
{
    config.wheel = JP_Q16(1);
    start();
    reference.wheel.angle = JP_PHASE_TURN * 100;
    update(JP_Q16(1000));
    expect(JP_Q16(64), JP_Q16(64), false);
    reference.wheel.angle = (jp_phase)0 - JP_PHASE_TURN * 100;
    update(JP_Q16(1000));
    expect(JP_Q16(-64), JP_Q16(-64), false);
}

static void test_greatest_gains_and_errors_saturate(void)
{
    config.wheel = INT32_MAX / 2;
    config.wheel_integral = INT32_MAX / 2;
    config.yaw = INT32_MIN + 1;
    start();
    lqr.wheel_integral = (int64_t)INT32_MAX << 10;
    reference.wheel.angle = JP_PHASE_TURN * 100;
    reference.yaw.angle = JP_PHASE_TURN * 100;
    update(INT32_MAX);
    expect(INT32_MAX, INT32_MAX, true);

    config.pitch = config.wheel;
    config.wheel = 0;
    config.wheel_integral = 0;
    start();
    state.pitch = INT32_MIN; /* its negation saturates */
    reference.yaw.angle = 0;
    update(INT32_MAX);
    expect(INT32_MAX, INT32_MAX, false);
}

static void test_limit_holds_on_both_wheels(void)
{
    config.pitch = JP_Q16(-100);
    config.yaw = JP_Q16(100);
    start();
    state.pitch = JP_Q24(0.1);
    reference.yaw.angle = JP_PHASE_TURN / 10;
    update(JP_Q16(15)); /* 10 V for balance leave 5 V for yaw */
    TEST_ASSERT_INT32_WITHIN(1, JP_Q16(5), voltages.left);
    TEST_ASSERT_INT32_WITHIN(1, JP_Q16(15), voltages.right);
    TEST_ASSERT_TRUE(voltages.saturated);
    update(JP_Q16(8)); /* balance takes all */
    expect(JP_Q16(8), JP_Q16(8), true);
    state.pitch = JP_Q24(-0.1);
    update(JP_Q16(8));
    expect(JP_Q16(-8), JP_Q16(-8), true);
    update(0);
    expect(0, 0, true);
}

static void test_not_saturated_exactly_on_the_limit(void)
{
    config.wheel = JP_Q16(10);
    config.pitch_reserve = JP_Q16(4);
    start();
    reference.wheel.angle = JP_PHASE_TURN;
    update(JP_Q16(14));
    expect(JP_Q16(10), JP_Q16(10), false);
    update(JP_Q16(14) - 1);
    expect(JP_Q16(10) - 1, JP_Q16(10) - 1, true);
}

static void test_travel_leaves_the_reserve_to_balance(void)
{
    config.wheel = JP_Q16(10);
    config.pitch = JP_Q16(-100);
    config.pitch_reserve = JP_Q16(6);
    start();
    reference.wheel.angle = (jp_phase)0 - 10 * JP_PHASE_TURN;
    update(JP_Q16(20)); /* asks for −100 V */
    expect(JP_Q16(-14), JP_Q16(-14), true);
    state.pitch = JP_Q24(0.2); /* falls forward: +20 V */
    update(JP_Q16(20));
    TEST_ASSERT_INT32_WITHIN(2, JP_Q16(6), voltages.left);
    state.pitch = JP_Q24(-0.2);
    update(JP_Q16(20));
    expect(JP_Q16(-20), JP_Q16(-20), true);

    config.pitch_reserve = JP_Q16(30); /* a reserve above the supply leaves nothing to travel */
    state.pitch = JP_Q24(0.1);
    update(JP_Q16(20));
    TEST_ASSERT_INT32_WITHIN(2, JP_Q16(10), voltages.left);
    TEST_ASSERT_TRUE(voltages.saturated);
}

static void test_integral_acts_from_the_next_tick(void)
{
    config.wheel_integral = JP_Q16(2);
    config.yaw_integral = JP_Q16(-4);
    start();
    reference.wheel.angle = JP_PHASE_TURN;
    reference.yaw.angle = JP_PHASE_TURN;
    update(JP_Q16(100));
    expect(0, 0, false);
    for (int i = 0; i < 500; i++) {
        update(JP_Q16(100));
    }
    /* 500 ticks of one turn: half a turn·s. */
    TEST_ASSERT_INT32_WITHIN(3, JP_Q16(1) + JP_Q16(2), voltages.left);
    TEST_ASSERT_INT32_WITHIN(3, JP_Q16(1) - JP_Q16(2), voltages.right);
    start();
    update(JP_Q16(100));
    expect(0, 0, false);
}

static void test_integral_is_limited(void)
{
    const int64_t limit = (int64_t)INT32_MAX << 10;

    config.wheel_integral = JP_Q16(1);
    config.yaw_integral = JP_Q16(1);
    start();
    lqr.wheel_integral = limit - 5;
    lqr.yaw_integral = 5 - limit;
    reference.wheel.angle = JP_PHASE_TURN;
    reference.yaw.angle = (jp_phase)0 - JP_PHASE_TURN;
    update(INT32_MAX);
    TEST_ASSERT_EQUAL_INT64(limit, lqr.wheel_integral);
    TEST_ASSERT_EQUAL_INT64(-limit, lqr.yaw_integral);
    /* 2³¹ · 2¹⁰ of 2⁻²⁴ turn·tick, 131.07 turn·s. */
    update(INT32_MAX);
    TEST_ASSERT_INT32_WITHIN(80, JP_Q16(131.072) + JP_Q16(131.072), voltages.left);
}

/** Integrates with the given gain and error (turns) under a limit that the pitch exceeds in the given direction. */
static bool integrates(int32_t gain, int32_t error, int32_t push)
{
    config = (struct jp_lqr_config){.tick_rate = 1000, .pitch = JP_Q16(-100), .wheel_integral = JP_Q16(1) * gain};
    start();
    state = (struct jp_motion_state){.pitch = JP_Q24(0.2) * push};
    reference.wheel.angle = (jp_phase)(error * TURN);
    update(JP_Q16(10));
    TEST_ASSERT_TRUE(voltages.saturated);
    return lqr.wheel_integral != 0;
}

static void test_wheel_integral_stops_where_it_would_push_further(void)
{
    TEST_ASSERT_FALSE(integrates(1, 1, 1));
    TEST_ASSERT_TRUE(integrates(1, -1, 1));
    TEST_ASSERT_TRUE(integrates(1, 1, -1));
    TEST_ASSERT_FALSE(integrates(1, -1, -1));
    /* A negative gain, which a balancing robot has, turns the direction. */
    TEST_ASSERT_TRUE(integrates(-1, 1, 1));
    TEST_ASSERT_FALSE(integrates(-1, -1, 1));
    TEST_ASSERT_FALSE(integrates(-1, 1, -1));
    TEST_ASSERT_TRUE(integrates(-1, -1, -1));
}

static bool yaw_integrates(int32_t gain, int32_t error, jp_q16 direct)
{
    config = (struct jp_lqr_config){.tick_rate = 1000, .yaw = direct, .yaw_integral = JP_Q16(1) * gain};
    start();
    reference = (struct jp_reference){.yaw.angle = (jp_phase)(error * TURN)};
    update(JP_Q16(10));
    TEST_ASSERT_TRUE(voltages.saturated);
    return lqr.yaw_integral != 0;
}

static void test_yaw_integral_stops_where_it_would_push_further(void)
{
    TEST_ASSERT_FALSE(yaw_integrates(1, 1, JP_Q16(20)));
    TEST_ASSERT_FALSE(yaw_integrates(1, -1, JP_Q16(20)));
    TEST_ASSERT_TRUE(yaw_integrates(-1, 1, JP_Q16(20)));
    TEST_ASSERT_TRUE(yaw_integrates(1, 1, JP_Q16(-20)));
    TEST_ASSERT_FALSE(yaw_integrates(-1, 1, JP_Q16(-20)));
}

static void test_long_saturation_does_not_wind_up(void)
{
    config = jp_robot_courier24.lqr;
    start();
    reference.wheel.angle = 4 * JP_PHASE_TURN; /* −47 V wanted, 12 V are there */
    for (int i = 0; i < 20000; i++) {
        update(JP_Q16(24));
    }
    TEST_ASSERT_EQUAL_INT64(0, lqr.wheel_integral);
    reference.wheel.angle = 0;
    update(JP_Q16(24));
    expect(0, 0, false);
}

/* Along a trajectory */

static void test_voltages_of_the_motion_are_added(void)
{
    config.wheel = JP_Q16(1);
    config.yaw = JP_Q16(5);
    start();
    reference.common = JP_Q16(3);
    reference.difference = JP_Q16(-0.5);
    update(JP_Q16(100));
    expect(JP_Q16(3.5), JP_Q16(2.5), false);
    reference.wheel.angle = JP_PHASE_TURN;
    reference.yaw.angle = JP_PHASE_TURN / 10;
    update(JP_Q16(100));
    TEST_ASSERT_INT32_WITHIN(1, JP_Q16(4), voltages.left);
    TEST_ASSERT_INT32_WITHIN(1, JP_Q16(4), voltages.right);
}

static void test_pitch_follows_the_reference(void)
{
    config.pitch = JP_Q16(-2);
    config.pitch_rate = JP_Q16(4);
    start();
    reference.pitch = JP_Q24(0.25);
    reference.pitch_rate = JP_Q24(0.5);
    state.pitch = JP_Q24(0.25);
    state.pitch_rate = JP_Q24(0.5);
    update(JP_Q16(100));
    expect(0, 0, false);
    state.pitch = 0;
    update(JP_Q16(100));
    expect(JP_Q16(-0.5), JP_Q16(-0.5), false);
    state.pitch_rate = 0;
    update(JP_Q16(100));
    expect(JP_Q16(1.5), JP_Q16(1.5), false);
}

static void test_the_motion_leaves_the_reserve_to_pitch(void)
{
    config.pitch = JP_Q16(-8);
    config.pitch_reserve = JP_Q16(4);
    start();
    reference.common = JP_Q16(9);
    update(JP_Q16(10));
    expect(JP_Q16(6), JP_Q16(6), true);
    state.pitch = JP_Q24(0.5);
    update(JP_Q16(10));
    expect(JP_Q16(10), JP_Q16(10), true);
    reference.difference = JP_Q16(2);
    state.pitch = 0;
    reference.common = JP_Q16(5);
    update(JP_Q16(6));
    expect(JP_Q16(0), JP_Q16(4), true);
}

/* Nothing is left for the way; what keeps it upright is left for balance. */
static void test_a_limit_within_the_reserve_leaves_no_voltage_for_the_way(void)
{
    config.pitch_reserve = JP_Q16(2);
    config.wheel = JP_Q16(10);
    start();
    for (int side = -1; side <= 1; side += 2) {
        reference.wheel.angle = (jp_phase)(side * TURN);
        update(JP_Q16(2));
        expect(0, 0, true);
    }
}

/* The least error, too. */
static void test_no_error_is_integrated_that_the_limit_holds_back(void)
{
    config.wheel_integral = JP_Q16(1);
    config.wheel = JP_Q16(1);
    start();
    for (int side = -1; side <= 1; side += 2) {
        reference.wheel.angle = (jp_phase)(side * ((int64_t)1 << 32));
        reference.common = side * JP_Q16(20);
        update(JP_Q16(10));
        TEST_ASSERT_TRUE(voltages.saturated);
        TEST_ASSERT_EQUAL_INT64(0, lqr.wheel_integral);
    }
}
