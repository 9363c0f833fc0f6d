/* Speed and turn-rate control: configuration, rates by the encoders, each term of the voltage, limits, the integral. */
#include <joulepath/skid_robot.h>

#include "tests/support/config_check.h"
#include "unity.h"

static struct jp_skid_control_config config;
static struct jp_skid_control control;
static struct jp_sensors sensors;
static struct jp_skid_set_point set_point;
static struct jp_voltages voltages;

#define BUS JP_Q16(46)

static void start(jp_q24 steering)
{
    jp_skid_control_start(&control, &config, steering);
    jp_skid_control_count_from(&control, sensors.encoder_left, sensors.encoder_right);
}

void setUp(void)
{
    config = jp_skid_robot_zhang2018.control;
    sensors = (struct jp_sensors){.encoder_left = 0xFFFFFFF0U, .encoder_right = 7};
    set_point = (struct jp_skid_set_point){0, 0, 0, 0, 0};
    start(JP_Q24_ONE);
}

void tearDown(void)
{
}

static void update(void)
{
    jp_skid_control_update(&control, &config, &set_point, BUS, &voltages);
}

DEFINE_EXPECT_CONFIG_OF(jp_skid_control_check, jp_skid_robot_zhang2018.control)

#define PATH "control."

static void test_checks_every_field_at_its_limits(void)
{
    config = jp_skid_robot_zhang2018.control;
    expect_config(NULL);
    config.tracking_rate_gain = JP_Q16(50);
    FIELD(tick_rate, 99, PATH "tick_rate");
    config.tracking_rate_gain = JP_Q16(50);
    FIELD(tick_rate, 100, NULL);
    AT_MOST(PATH, tick_rate, 10000);
    FIELD(wheel_per_count, 0, PATH "wheel_per_count");
    FIELD(wheel_per_count, 1, NULL);
    FIELD(wheel_per_count, JP_PHASE_TURN, NULL);
    FIELD(wheel_per_count, JP_PHASE_TURN + 1, PATH "wheel_per_count");
    RANGE(PATH, tracking_gain, 1, JP_Q16_ONE);
    RANGE(PATH, tracking_rate_gain, 1, JP_Q16(500));
    RANGE(PATH, turns_per_metre, JP_Q24(0.03), JP_Q24(32));
    RANGE(PATH, turns_per_radian, JP_Q24(0.001), JP_Q24(4));
    RANGE(PATH, back_emf, 1, JP_Q16(256) - 1);
    AT_LEAST(PATH, resistance, JP_Q16(0.001));
    config.current_limit = JP_Q16(1);
    FIELD(resistance, JP_Q16(100), NULL);
    FIELD(resistance, JP_Q16(100) + 1, PATH "resistance");
    AT_LEAST(PATH, current_limit, 1);
    config.resistance = JP_Q16(2);
    FIELD(current_limit, JP_Q16(500), NULL);
    config.resistance = JP_Q16(2);
    FIELD(current_limit, JP_Q16(500) + 1, PATH "current_limit");
    RANGE(PATH, rolling, 0, JP_Q16(2047));
    AT_LEAST(PATH, creep, 1);
    RANGE(PATH, climbing, 0, JP_Q16(2047));
    RANGE(PATH, acceleration, 0, JP_Q16(2047));
    RANGE(PATH, turn_acceleration, 0, JP_Q16(2047));
    RANGE(PATH, turning, 0, JP_Q16(2047));
    RANGE(PATH, turning_decrease, 0, JP_Q24(8));
    RANGE(PATH, turning_creep, JP_Q24(0.0001), JP_Q24(1));
    RANGE(PATH, braking, 0, JP_Q24_ONE);
    RANGE(PATH, proportional, 0, JP_Q16(2047));
    AT_LEAST(PATH, integral, 1);
}

/* Rates */

/** Both sides at so many counts a tick. */
static void roll(uint32_t ticks, uint32_t left, uint32_t right)
{
    for (uint32_t i = 0; i < ticks; i++) {
        sensors.encoder_left += left;
        sensors.encoder_right += right;
        jp_skid_control_measure(&control, &config, sensors.encoder_left, sensors.encoder_right);
    }
}

static void test_rates_become_those_of_the_counts(void)
{
    /* 125 099 counts a turn, 500 ticks a second. */
    roll(100, 100, 0U - 50U);
    TEST_ASSERT_INT32_WITHIN(100, JP_Q24(100 * 500 / 125099.0), control.sides[JP_SKID_LEFT].rate);
    TEST_ASSERT_INT32_WITHIN(100, -JP_Q24(50 * 500 / 125099.0), control.sides[JP_SKID_RIGHT].rate);
    roll(100, 0, 0);
    TEST_ASSERT_INT32_WITHIN(100, 0, control.sides[JP_SKID_LEFT].rate);
    TEST_ASSERT_INT32_WITHIN(100, 0, control.sides[JP_SKID_RIGHT].rate);
}

static void test_any_jump_of_the_counts_is_survived(void)
{
    config.wheel_per_count = JP_PHASE_TURN;
    config.tracking_gain = JP_Q16_ONE;
    config.tracking_rate_gain = JP_Q16(500);
    start(JP_Q24_ONE);
    roll(3, 0x7FFFFFFFU, 0x80000000U);
    roll(3, 0x80000001U, 12345);
    update();
    roll(300, 0, 0);
    TEST_ASSERT_INT32_WITHIN(1000, 0, control.sides[JP_SKID_LEFT].rate);
}

static void test_rates_go_along_with_the_reference(void)
{
    set_point.speed = JP_Q24(0.4);
    update();
    TEST_ASSERT_EQUAL_INT32(control.sides[JP_SKID_LEFT].reference, control.sides[JP_SKID_LEFT].rate);
    jp_skid_control_forget(&control);
    TEST_ASSERT_TRUE(control.sides[JP_SKID_LEFT].rate > 0);
    set_point.speed = 0;
    update();
    TEST_ASSERT_TRUE(control.sides[JP_SKID_LEFT].rate > 0);
}

/* References and steering */

static void test_reference_of_the_sides(void)
{
    set_point.speed = JP_Q24(0.5);
    set_point.turn_rate = JP_Q24(0.3);
    update();
    const jp_q24 across = jp_q24_multiply(JP_Q24(0.3), config.turns_per_radian);
    const jp_q24 ahead = jp_q24_multiply(JP_Q24(0.5), config.turns_per_metre);

    TEST_ASSERT_INT32_WITHIN(2, ahead - across, control.sides[JP_SKID_LEFT].reference);
    TEST_ASSERT_INT32_WITHIN(2, ahead + across, control.sides[JP_SKID_RIGHT].reference);
}

static void test_a_steering_ratio_spreads_the_sides(void)
{
    start(JP_Q24(0.5));
    set_point.turn_rate = JP_Q24(0.3);
    update();
    TEST_ASSERT_INT32_WITHIN(4, jp_q24_multiply(JP_Q24(0.6), config.turns_per_radian),
                             control.sides[JP_SKID_RIGHT].reference);
}

static void expect_spread(jp_q24 steering)
{
    TEST_ASSERT_INT32_WITHIN(8, jp_q24_divide(config.turns_per_radian, steering), control.spread);
}

static void test_follows_a_steering_ratio_that_changes(void)
{
    start(JP_Q24(0.6));
    for (int i = 0; i < 4; i++) {
        jp_skid_control_steer(&control, &config, JP_Q24(0.8));
    }
    expect_spread(JP_Q24(0.8));
    for (int i = 0; i < 4; i++) {
        jp_skid_control_steer(&control, &config, JP_Q24(0.6));
    }
    expect_spread(JP_Q24(0.6));
}

static void test_follows_any_steering_ratio_within_its_limits(void)
{
    static const jp_q24 ratios[] = {0, JP_Q24(100), JP_Q24(0.3), JP_Q24(1.4), INT32_MIN};

    start(JP_SKID_STEERING_MIN);
    for (unsigned i = 0; i < sizeof ratios / sizeof ratios[0]; i++) {
        for (int call = 0; call < 20; call++) {
            jp_skid_control_steer(&control, &config, ratios[i]);
            TEST_ASSERT_TRUE(control.spread > 0);
        }
        expect_spread(jp_clamp32(ratios[i], JP_SKID_STEERING_MIN, JP_SKID_STEERING_MAX));
    }
}

/* Terms of the voltage */

/** V of a load at a speed. */
static jp_q16 volts(jp_q16 load, jp_turns_per_s rate)
{
    return jp_q16_multiply(load, config.resistance) + jp_multiply_shift(config.back_emf, rate, 24);
}

/** At the speed that is asked for: neither error nor integral. */
static void be_there(void)
{
    update();
    control.sides[JP_SKID_LEFT].rate = control.sides[JP_SKID_LEFT].reference;
    control.sides[JP_SKID_RIGHT].rate = control.sides[JP_SKID_RIGHT].reference;
    config.integral = 1;
    update();
}

static void test_rest_takes_nothing(void)
{
    update();
    TEST_ASSERT_EQUAL_INT32(0, voltages.left);
    TEST_ASSERT_EQUAL_INT32(0, voltages.right);
    TEST_ASSERT_FALSE(voltages.saturated);
}

static void test_rolling_takes_its_current_both_ways(void)
{
    set_point.speed = JP_Q24(0.4);
    be_there();
    TEST_ASSERT_EQUAL_INT32(config.rolling, control.sides[JP_SKID_LEFT].load);
    TEST_ASSERT_INT32_WITHIN(4, volts(config.rolling, control.sides[JP_SKID_LEFT].reference), voltages.left);
    TEST_ASSERT_EQUAL_INT32(voltages.left, voltages.right);
    set_point.speed = -JP_Q24(0.4);
    be_there();
    TEST_ASSERT_EQUAL_INT32(-config.rolling, control.sides[JP_SKID_RIGHT].load);
}

static void test_rolling_grows_with_a_speed_that_creeps(void)
{
    set_point.speed = jp_q24_divide(config.creep / 2, config.turns_per_metre);
    be_there();
    TEST_ASSERT_INT32_WITHIN(4, config.rolling / 2, control.sides[JP_SKID_LEFT].load);
}

static void test_climbing_and_speeding_up_take_theirs(void)
{
    set_point.speed = JP_Q24(0.4);
    set_point.rise = JP_Q24(0.2);
    set_point.acceleration = JP_Q24(0.5);
    be_there();
    const jp_q16 expected = config.rolling + config.climbing / 5 + config.acceleration / 2;

    TEST_ASSERT_INT32_WITHIN(2, expected, control.sides[JP_SKID_LEFT].load);
    TEST_ASSERT_INT32_WITHIN(2, expected, control.sides[JP_SKID_RIGHT].load);
}

/** A side that brakes takes the losses of the gear twice off what it would drive with. */
static void test_braking_takes_less(void)
{
    set_point.speed = JP_Q24(0.4);
    set_point.rise = -JP_Q24(0.2);
    be_there();
    const jp_q16 expected = jp_multiply_shift(config.rolling - config.climbing / 5, config.braking, 24);

    TEST_ASSERT_INT32_WITHIN(2, expected, control.sides[JP_SKID_LEFT].load);
    set_point.speed = -JP_Q24(0.4);
    set_point.rise = JP_Q24(0.2);
    be_there();
    TEST_ASSERT_INT32_WITHIN(2, -expected, control.sides[JP_SKID_LEFT].load);
}

static void test_turning_on_the_spot_takes_its_moment(void)
{
    config.turning_decrease = 0;
    set_point.turn_rate = JP_Q24(0.4);
    be_there();
    const jp_q16 turning = (jp_q16)((int64_t)config.turning * JP_Q24(0.4) / (JP_Q24(0.4) + config.turning_creep));

    TEST_ASSERT_INT32_WITHIN(turning / 200, turning + config.rolling, control.sides[JP_SKID_RIGHT].load);
    TEST_ASSERT_EQUAL_INT32(-control.sides[JP_SKID_RIGHT].load, control.sides[JP_SKID_LEFT].load);
    set_point.turn_rate = -JP_Q24(0.4);
    be_there();
    TEST_ASSERT_INT32_WITHIN(turning / 200, turning + config.rolling, control.sides[JP_SKID_LEFT].load);
}

static void test_turning_takes_less_the_wider_it_is(void)
{
    jp_q16 last = INT32_MAX;

    set_point.turn_rate = JP_Q24(0.3);
    for (int i = 0; i < 5; i++) {
        set_point.speed = i * JP_Q24(0.15);
        be_there();
        const jp_q16 difference = control.sides[JP_SKID_RIGHT].load - control.sides[JP_SKID_LEFT].load;
        TEST_ASSERT_TRUE(difference < last);
        TEST_ASSERT_TRUE(difference > 0);
        last = difference;
        set_point.speed = -set_point.speed;
        be_there();
        TEST_ASSERT_INT32_WITHIN(2, difference, control.sides[JP_SKID_RIGHT].load - control.sides[JP_SKID_LEFT].load);
    }
}

static void test_a_differential_drive_turns_freely(void)
{
    config.turning = 0;
    config.rolling = 0;
    start(JP_Q24_ONE);
    set_point.turn_rate = JP_Q24(0.4);
    be_there();
    TEST_ASSERT_EQUAL_INT32(0, control.sides[JP_SKID_RIGHT].load);
    set_point.turn_acceleration = JP_Q24(0.5);
    be_there();
    TEST_ASSERT_INT32_WITHIN(2, config.turn_acceleration / 2, control.sides[JP_SKID_RIGHT].load);
}

static void test_the_greatest_motion_does_not_overflow(void)
{
    set_point = (struct jp_skid_set_point){JP_Q24(8), -JP_Q24(8), INT32_MAX, INT32_MIN, JP_Q24_ONE};
    config.turning = JP_Q16(2047);
    config.turning_decrease = JP_Q24(8);
    config.turning_creep = JP_Q24(0.0001);
    config.turns_per_radian = JP_Q24(4);
    config.turns_per_metre = JP_Q24(32);
    config.integral = INT32_MAX;
    config.resistance = JP_Q16(100);
    config.current_limit = JP_Q16(10);
    start(JP_SKID_STEERING_MIN);
    update();
    TEST_ASSERT_TRUE(voltages.left <= BUS && voltages.left >= -BUS);
    TEST_ASSERT_TRUE(voltages.right <= BUS && voltages.right >= -BUS);
}

/* Errors and limits */

static void test_an_error_of_the_rate_is_made_up_for(void)
{
    set_point.speed = JP_Q24(0.4);
    be_there();
    const jp_q16 before = voltages.left;

    control.sides[JP_SKID_LEFT].rate -= JP_Q24(0.01);
    update();
    TEST_ASSERT_INT32_WITHIN(8, config.proportional / 100, voltages.left - before);
}

/** A side that stays behind by the reference's way. */
static void test_the_integral_is_the_way_that_is_missing(void)
{
    config.proportional = 0;
    set_point.speed = JP_Q24(0.1);
    update();
    update();
    const jp_q24 missing = 2 * (control.sides[JP_SKID_LEFT].reference / 500);

    TEST_ASSERT_INT32_WITHIN(4, missing, jp_phase_difference(control.sides[JP_SKID_LEFT].behind, 0));
    TEST_ASSERT_INT32_WITHIN(64,
                             volts(config.rolling, control.sides[JP_SKID_LEFT].reference) +
                                 jp_multiply_shift(config.integral, missing, 24),
                             voltages.left);
    set_point.speed = 0;
    jp_skid_control_forget(&control);
    update();
    TEST_ASSERT_EQUAL_INT32(0, voltages.left);
}

/** V that the current limit leaves a wheel that stands. */
static jp_q16 current_voltage(void)
{
    return jp_q16_multiply(config.current_limit, config.resistance);
}

/** Ticks of wheels that are held. */
static void hold(uint32_t ticks)
{
    for (uint32_t i = 0; i < ticks; i++) {
        roll(1, 0, 0);
        update();
    }
}

static void expect_limited(jp_q24 speed)
{
    const jp_q16 expected = speed < 0 ? -current_voltage() : current_voltage();

    set_point.speed = speed;
    hold(200);
    const jp_phase behind = control.sides[JP_SKID_LEFT].behind;

    TEST_ASSERT_INT32_WITHIN(600, expected, voltages.left);
    TEST_ASSERT_INT32_WITHIN(600, expected, voltages.right);
    TEST_ASSERT_TRUE(voltages.saturated);
    hold(2000);
    TEST_ASSERT_TRUE(control.sides[JP_SKID_LEFT].behind == behind);
}

static void test_the_current_is_limited_and_the_integral_waits(void)
{
    expect_limited(JP_Q24(0.9));
    expect_limited(-JP_Q24(0.9));
}

/** What the integral holds goes down at a limit. */
static void test_the_integral_leaves_a_limit(void)
{
    set_point.speed = JP_Q24(0.1);
    control.sides[JP_SKID_LEFT].behind = JP_PHASE_TURN / 100;
    set_point.speed = -JP_Q24(0.001);
    control.sides[JP_SKID_LEFT].rate = -JP_Q24(0.5);
    config.current_limit = JP_Q16(1);
    control.current_voltage = JP_Q16(1);
    update();
    TEST_ASSERT_TRUE(voltages.saturated);
    TEST_ASSERT_TRUE(control.sides[JP_SKID_LEFT].behind < JP_PHASE_TURN / 100);
}

static void test_the_integral_never_takes_more_than_the_current_limit(void)
{
    const jp_q24 most = jp_q24_divide(current_voltage(), config.integral);

    control.sides[JP_SKID_LEFT].behind = 100 * JP_PHASE_TURN;
    control.sides[JP_SKID_RIGHT].behind = 0 - 100 * JP_PHASE_TURN;
    update();
    TEST_ASSERT_INT32_WITHIN(64, current_voltage(), voltages.left);
    TEST_ASSERT_INT32_WITHIN(64, -current_voltage(), voltages.right);
    TEST_ASSERT_INT32_WITHIN(1, most, jp_phase_difference(control.sides[JP_SKID_LEFT].behind, 0));
    TEST_ASSERT_INT32_WITHIN(1, -most, jp_phase_difference(control.sides[JP_SKID_RIGHT].behind, 0));
}

static void test_the_bus_limits_too(void)
{
    set_point.speed = JP_Q24(0.5);
    be_there();
    jp_skid_control_update(&control, &config, &set_point, JP_Q16(12), &voltages);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(12), voltages.left);
    TEST_ASSERT_TRUE(voltages.saturated);
    /* Wheels faster than the bus can drive. */
    control.sides[JP_SKID_LEFT].rate = JP_Q24(3);
    jp_skid_control_update(&control, &config, &set_point, JP_Q16(12), &voltages);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(12), voltages.left);
}

static void test_one_limited_side_is_told(void)
{
    set_point.speed = JP_Q24(0.4);
    be_there();
    TEST_ASSERT_FALSE(voltages.saturated);
    control.sides[JP_SKID_RIGHT].rate = 0;
    update();
    TEST_ASSERT_TRUE(voltages.saturated);
}

static void test_blindly_takes_what_the_motion_takes(void)
{
    set_point.speed = JP_Q24(0.4);
    set_point.rise = JP_Q24(0.1);
    be_there();
    const struct jp_voltages known = voltages;

    control.sides[JP_SKID_LEFT].rate = JP_Q24(100);
    control.sides[JP_SKID_LEFT].behind = JP_PHASE_TURN;
    jp_skid_control_blindly(&control, &config, &set_point, BUS, &voltages);
    TEST_ASSERT_INT32_WITHIN(4, known.left, voltages.left);
    TEST_ASSERT_INT32_WITHIN(4, known.right, voltages.right);
    TEST_ASSERT_FALSE(voltages.saturated);
    jp_skid_control_blindly(&control, &config, &set_point, JP_Q16(5), &voltages);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(5), voltages.left);
}

/* ---- To the last bit ---- */

static void test_counts_before_it_counts_are_no_motion(void)
{
    jp_skid_control_count_from(&control, 5000000, 0U - 7000000U);
    jp_skid_control_measure(&control, &config, 5000000, 0U - 7000000U);
    for (int side = 0; side < JP_SKID_SIDES; side++) {
        TEST_ASSERT_EQUAL_INT32(0, control.sides[side].rate);
        TEST_ASSERT_TRUE(control.sides[side].rolled == 0);
    }
}

static void test_both_sides_forget_all_of_it(void)
{
    for (int side = 0; side < JP_SKID_SIDES; side++) {
        control.sides[side].behind = JP_PHASE_TURN;
        control.sides[side].reference = JP_Q24(1);
    }
    jp_skid_control_forget(&control);
    for (int side = 0; side < JP_SKID_SIDES; side++) {
        TEST_ASSERT_TRUE(control.sides[side].behind == 0);
        TEST_ASSERT_EQUAL_INT32(0, control.sides[side].reference);
    }
}

/* Of the angle that the rate did not explain, a share is taken in the tick, and so much of it a second into the rate.
 */
static void test_rates_track_the_counts_by_both_gains(void)
{
    const double count = (double)config.wheel_per_count / (double)JP_PHASE_TURN;
    double untracked = 0;
    double rate = 0;

    config.tracking_gain = JP_Q16(0.5);
    config.tracking_rate_gain = JP_Q16(50);
    for (int tick = 0; tick < 30; tick++) {
        const int32_t counts = tick < 15 ? 90 : -40;

        roll(1, (uint32_t)counts, 0);
        const double error = untracked + counts * count - rate / 500;

        untracked = error / 2;
        rate += error * 50;
        TEST_ASSERT_INT32_WITHIN(64 + tick * 8, (int32_t)(rate * 16777216), control.sides[JP_SKID_LEFT].rate);
    }
}

/** Its load by nothing but what a set-point takes, without what it gains by braking. */
static jp_q16 load_of(jp_q24 speed, jp_q24 acceleration)
{
    start(JP_Q24_ONE);
    config.rolling = 0;
    config.acceleration = 1;
    config.braking = 0;
    set_point = (struct jp_skid_set_point){.speed = speed, .acceleration = acceleration};
    start(JP_Q24_ONE);
    update();
    return control.sides[JP_SKID_LEFT].load;
}

/* It drives where load and motion are of one sign; a wheel that stands is held, as one that brakes. */
static void test_the_least_load_and_the_least_rate_drive(void)
{
    TEST_ASSERT_EQUAL_INT32(1, load_of(JP_Q24(0.1), JP_Q24(1)));
    TEST_ASSERT_EQUAL_INT32(-1, load_of(-JP_Q24(0.1), -JP_Q24(1)));
    TEST_ASSERT_EQUAL_INT32(2, load_of(1, JP_Q24(2)));
    TEST_ASSERT_EQUAL_INT32(-2, load_of(-1, -JP_Q24(2)));
    TEST_ASSERT_EQUAL_INT32(0, load_of(0, JP_Q24(2)));
    TEST_ASSERT_EQUAL_INT32(0, load_of(0, -JP_Q24(2)));
    TEST_ASSERT_EQUAL_INT32(0, load_of(1, -JP_Q24(2)));
    TEST_ASSERT_EQUAL_INT32(0, load_of(-1, JP_Q24(2)));
}

static void test_the_least_moment_of_a_turn_is_taken(void)
{
    config.turning = 1;
    config.turning_decrease = 0;
    config.rolling = 0;
    start(JP_Q24_ONE);
    set_point.turn_rate = JP_Q24(4);
    update();
    TEST_ASSERT_EQUAL_INT32(1, control.sides[JP_SKID_RIGHT].load);
}

/* Half a bit and more is one: 0.6 of the last bit of a volt. */
static void test_voltages_are_rounded(void)
{
    config.back_emf = 1;
    config.proportional = 0;
    config.integral = 1;
    config.rolling = 0;
    config.turns_per_metre = JP_Q24_ONE;
    start(JP_Q24_ONE);
    set_point.speed = JP_Q24(0.6);
    update();
    TEST_ASSERT_EQUAL_INT32(1, voltages.left);
    start(JP_Q24_ONE);
    set_point.speed = JP_Q24(0.4);
    update();
    TEST_ASSERT_EQUAL_INT32(0, voltages.left);
}

static void test_the_integral_is_limited_to_the_bit(void)
{
    const jp_phase limit = (jp_phase)(uint32_t)control.behind_limit << 32;

    control.sides[JP_SKID_LEFT].behind = limit + ((jp_phase)1 << 32);
    control.sides[JP_SKID_RIGHT].behind = limit;
    update();
    TEST_ASSERT_TRUE(control.sides[JP_SKID_LEFT].behind == limit);
    TEST_ASSERT_TRUE(control.sides[JP_SKID_RIGHT].behind == limit);
}

static void test_blindly_each_side_takes_its_own(void)
{
    set_point.turn_rate = JP_Q24(0.3);
    voltages = (struct jp_voltages){1, 1, true};
    jp_skid_control_blindly(&control, &config, &set_point, BUS, &voltages);
    for (int side = 0; side < JP_SKID_SIDES; side++) {
        TEST_ASSERT_INT32_WITHIN(4, volts(control.sides[side].load, control.sides[side].reference),
                                 side == JP_SKID_LEFT ? voltages.left : voltages.right);
    }
    TEST_ASSERT_TRUE(voltages.right > voltages.left);
    TEST_ASSERT_FALSE(voltages.saturated);
}
