/* Ground and wheels: configuration, slope and tilt, stalled sides, sides in the air, spinning wheels. */
#include <joulepath/skid_robot.h>

#include "tests/support/config_check.h"
#include "unity.h"

static struct jp_skid_monitor_config config;
static struct jp_skid_monitor monitor;
static struct jp_skid_control control;
static struct jp_sensors sensors;
static struct jp_skid_motion motion;
static jp_q24 tilt_limit;

static void start(void)
{
    jp_skid_monitor_start(&monitor, tilt_limit);
}

void setUp(void)
{
    config = jp_skid_robot_zhang2018.wheels;
    config.friction = JP_Q16(0.2);
    tilt_limit = JP_Q24(18 / 360.0);
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE};
    control = (struct jp_skid_control){0};
    motion = (struct jp_skid_motion){.control = &control, .steering = JP_Q24(0.6), .straight = true};
    start();
}

void tearDown(void)
{
}

DEFINE_EXPECT_CONFIG_OF(jp_skid_monitor_check, jp_skid_robot_zhang2018.wheels)

#define PATH "wheels."

static void test_checks_every_field_at_its_limits(void)
{
    config = jp_skid_robot_zhang2018.wheels;
    expect_config(NULL);
    RANGE(PATH, upright, 0, JP_Q24_ONE);
    AT_LEAST(PATH, smoothing, 1);
    AT_LEAST(PATH, stall_current, 1);
    AT_LEAST(PATH, stall_rate, 1);
    RANGE(PATH, friction, 0, JP_Q16(2047));
    RANGE(PATH, carried, 1, JP_Q16(2047));
    RANGE(PATH, turn_per_wheel, 1, JP_Q24(8));
    AT_LEAST(PATH, spin_rate, 1);
    AT_LEAST(PATH, slope_calls, 1);
    AT_LEAST(PATH, stall_calls, 1);
    AT_LEAST(PATH, contradicted_calls, 1);
}

/* The ground */

static uint16_t look(unsigned calls, jp_q24 acceleration)
{
    uint16_t faults = 0;

    for (unsigned i = 0; i < calls; i++) {
        faults = jp_skid_monitor_ground(&monitor, &config, &sensors, acceleration);
    }
    return faults;
}

static void test_starts_on_the_slope_of_its_frame(void)
{
    TEST_ASSERT_TRUE(jp_skid_monitor_is_steep(&monitor, &config));
    sensors.accel_x = JP_Q24(0.25);
    look(1, 0);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.25), monitor.rise);
    TEST_ASSERT_FALSE(jp_skid_monitor_is_steep(&monitor, &config));
    TEST_ASSERT_INT32_WITHIN(16, JP_Q24(0.30901699), monitor.steepest);
}

static void test_slope_is_low_passed(void)
{
    look(1, 0);
    sensors.accel_x = JP_Q24(0.2);
    look(1, 0);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0002), JP_Q24(0.2 * 0.0198), monitor.rise);
    look(500, 0);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(0.2), monitor.rise);
}

static void test_acceleration_is_no_slope(void)
{
    sensors.accel_x = JP_Q24(0.5);
    look(500, JP_Q24(0.5 * 9.80665));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), 0, monitor.rise);
}

static void expect_steep(void)
{
    start();
    TEST_ASSERT_EQUAL_HEX16(0, look(config.slope_calls - 1U, 0));
    TEST_ASSERT_TRUE(jp_skid_monitor_is_steep(&monitor, &config));
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_SLOPE, look(1, 0));
}

static void test_too_steep_lasts_until_it_is_a_fault(void)
{
    sensors.accel_x = JP_Q24(0.312);
    expect_steep();
    sensors.accel_x = -JP_Q24(0.312);
    expect_steep();
    sensors.accel_x = JP_Q24(0.306);
    start();
    TEST_ASSERT_EQUAL_HEX16(0, look(2U * config.slope_calls, 0));
}

static void test_tilt_to_the_side_shows_upright(void)
{
    sensors.accel_z = config.upright - 1;
    expect_steep();
    sensors.accel_z = config.upright;
    start();
    TEST_ASSERT_EQUAL_HEX16(0, look(2U * config.slope_calls, 0));
    TEST_ASSERT_FALSE(jp_skid_monitor_is_steep(&monitor, &config));
}

/* The wheels */

static uint16_t watch(unsigned calls)
{
    uint16_t faults = 0;

    for (unsigned i = 0; i < calls; i++) {
        faults = jp_skid_monitor_wheels(&monitor, &config, &motion);
    }
    return faults;
}

/** The left wheel, in each tick, at a rate. */
static void roll(jp_turns_per_s rate)
{
    control.phase_per_rate = jp_phase_per_rate(500);
    control.sides[JP_SKID_LEFT].rolled = jp_phase_step(rate, control.phase_per_rate);
}

static void test_wheels_at_rest_are_no_fault(void)
{
    TEST_ASSERT_EQUAL_HEX16(0, watch(1000));
}

static void test_a_stalled_side_is_named(void)
{
    roll(0);
    motion.current[JP_SKID_LEFT] = config.stall_current;
    TEST_ASSERT_EQUAL_HEX16(0, watch(config.stall_calls - 1U));
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_STALLED_LEFT, watch(1));
    motion.current[JP_SKID_LEFT] = 0;
    motion.current[JP_SKID_RIGHT] = -config.stall_current;
    TEST_ASSERT_EQUAL_HEX16(0, watch(config.stall_calls - 1U));
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_STALLED_RIGHT, watch(1));
}

static void test_a_side_that_turns_or_takes_less_is_not_stalled(void)
{
    motion.current[JP_SKID_LEFT] = config.stall_current - 1;
    TEST_ASSERT_EQUAL_HEX16(0, watch(2U * config.stall_calls));
    motion.current[JP_SKID_LEFT] = config.stall_current;
    roll(config.stall_rate);
    TEST_ASSERT_EQUAL_HEX16(0, watch(2U * config.stall_calls));
    roll(-config.stall_rate);
    TEST_ASSERT_EQUAL_HEX16(0, watch(2U * config.stall_calls));
    roll(config.stall_rate - 1);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_STALLED_LEFT, watch(config.stall_calls));
}

/* The tracked rate goes along with a reference that a path has just changed. */
static void test_a_changed_reference_turns_no_stalled_wheel(void)
{
    roll(0);
    motion.current[JP_SKID_LEFT] = config.stall_current;
    TEST_ASSERT_EQUAL_HEX16(0, watch(config.stall_calls - 1U));
    control.sides[JP_SKID_LEFT].rate = 2 * config.stall_rate;
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_STALLED_LEFT, watch(1));
}

/** Both sides drive, and should take 0.8 A beside the friction. */
static void carry(jp_q16 left, jp_q16 right, bool backwards)
{
    const int sign = backwards ? -1 : 1;

    for (int side = 0; side < JP_SKID_SIDES; side++) {
        control.sides[side].reference = sign * JP_Q24(0.5);
        control.sides[side].rate = sign * JP_Q24(0.5);
        control.sides[side].load = sign * JP_Q16(1);
    }
    motion.current[JP_SKID_LEFT] = sign * left;
    motion.current[JP_SKID_RIGHT] = sign * right;
}

static void test_a_side_in_the_air_is_named(void)
{
    for (int backwards = 0; backwards < 2; backwards++) {
        start();
        carry(JP_Q16(0.25), JP_Q16(1.2), backwards != 0);
        TEST_ASSERT_EQUAL_HEX16(JP_FAULT_WHEEL_IN_AIR, watch(500));
        start();
        carry(JP_Q16(0.8), JP_Q16(0.2), backwards != 0);
        TEST_ASSERT_EQUAL_HEX16(JP_FAULT_WHEEL_IN_AIR, watch(500));
        motion.straight = false;
        TEST_ASSERT_EQUAL_HEX16(0, watch(500));
        motion.straight = true;
    }
}

static void test_what_both_sides_take_is_no_air(void)
{
    carry(JP_Q16(0.25), JP_Q16(0.25), false); /* downhill more than was seen */
    TEST_ASSERT_EQUAL_HEX16(0, watch(500));
    carry(JP_Q16(0.7), JP_Q16(1.5), false);
    TEST_ASSERT_EQUAL_HEX16(0, watch(500));
    carry(JP_Q16(0.5), JP_Q16(0.5), false); /* neither free nor carrying */
    TEST_ASSERT_EQUAL_HEX16(0, watch(500));
}

static void test_a_small_burden_is_not_judged(void)
{
    carry(JP_Q16(0.2), JP_Q16(1), false);
    control.sides[JP_SKID_RIGHT].load = JP_Q16(0.2) + config.carried - JP_Q16(0.01);
    TEST_ASSERT_EQUAL_HEX16(0, watch(500));
    carry(JP_Q16(0.2), JP_Q16(1), false);
    control.sides[JP_SKID_LEFT].load = JP_Q16(0.2) + config.carried - JP_Q16(0.01);
    TEST_ASSERT_EQUAL_HEX16(0, watch(500));
    carry(JP_Q16(0.2), JP_Q16(1), false);
    control.sides[JP_SKID_LEFT].reference = 0;
    TEST_ASSERT_EQUAL_HEX16(0, watch(500));
}

/** The wheels turn the robot by 0.05 · 0.6 of what they roll. */
static void turn(jp_turns_per_s ahead, jp_turns_per_s turn_rate)
{
    motion.straight = false;
    config.turn_per_wheel = JP_Q24(0.1);
    control.sides[JP_SKID_LEFT].rate = -ahead / 2;
    control.sides[JP_SKID_RIGHT].rate = ahead / 2;
    motion.turn_rate = turn_rate;
}

static void test_wheels_that_spin_contradict_the_gyro(void)
{
    const jp_turns_per_s turning = JP_Q24(0.06); /* at 1 turn/s ahead */

    turn(JP_Q24(1), turning / 4 - config.spin_rate - 200);
    TEST_ASSERT_EQUAL_HEX16(0, watch(config.contradicted_calls - 1U));
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_WHEELS_SPIN, watch(1));
    turn(-JP_Q24(1), -turning / 4 + config.spin_rate + 200);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_WHEELS_SPIN, watch(config.contradicted_calls));
    turn(JP_Q24(1), turning / 4 - config.spin_rate + 200);
    TEST_ASSERT_EQUAL_HEX16(0, watch(500));
    turn(0, config.spin_rate + 1);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_WHEELS_SPIN, watch(config.contradicted_calls));
    turn(0, -config.spin_rate);
    TEST_ASSERT_EQUAL_HEX16(0, watch(500));
}

/** Without a low-pass: each side should take so much of the ground, and takes so much. */
static uint16_t take_so(jp_q16 expected, jp_q16 left, jp_q16 right, bool backwards)
{
    const jp_q16 load = config.friction + expected;

    config.smoothing = INT32_MAX;
    start();
    carry(config.friction + left, config.friction + right, backwards);
    for (int side = 0; side < JP_SKID_SIDES; side++) {
        control.sides[side].load = backwards ? -load : load;
    }
    return watch(config.contradicted_calls);
}

/** The same whichever way it drives. */
static uint16_t take(jp_q16 expected, jp_q16 left, jp_q16 right)
{
    const uint16_t fault = take_so(expected, left, right, false);

    TEST_ASSERT_EQUAL_HEX16(fault, take_so(expected, left, right, true));
    return fault;
}

/* Less than a quarter of it is free, more than a half carries. */
static void test_what_a_side_carries_has_limits(void)
{
    const jp_q16 expected = 4 * config.carried;

    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_WHEEL_IN_AIR, take(expected, expected / 4 - 1, expected / 2 + 1));
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_WHEEL_IN_AIR, take(expected, expected / 2 + 1, expected / 4 - 1));
    TEST_ASSERT_EQUAL_HEX16(0, take(expected, expected / 4, expected / 2 + 1));
    TEST_ASSERT_EQUAL_HEX16(0, take(expected, expected / 4 - 1, expected / 2));
}

static void test_the_least_burden_is_judged(void)
{
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_WHEEL_IN_AIR, take(config.carried, 0, config.carried));
    TEST_ASSERT_EQUAL_HEX16(0, take(config.carried - 1, 0, config.carried));
}
