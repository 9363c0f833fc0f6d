/* The current check: configuration, offsets and gains of either sensor, what it must not say, sudden changes. */
#include <joulepath/current_check.h>

#include <string.h>

#include "tests/support/config_check.h"
#include "unity.h"

#define MEMORY   256
#define SETTLING (MEMORY / 4)
#define NAMED    (MEMORY) /* samples from a sudden change until it has a name */

static const struct jp_current_check_config usual = {
    .offset = JP_Q16(0.05),
    .gain = JP_Q16(0.06),
    .resistance = JP_Q16(0.25),
    .excitation = JP_Q16(0.1),
    .memory = MEMORY,
};

/* 4 Ω and 2 V per turn/s. */
static const struct jp_monitor_config motors = {
    .motor_resistance = JP_Q16(4),
    .back_emf = JP_Q16(2),
    .half_track = JP_Q16(1.5),
};

/** A sensor, and how the motor is driven. */
struct sensor {
    jp_q16 offset;
    jp_q16 gain;
};

static struct jp_current_check_config config;
static struct jp_current_check check;
static struct sensor left;
static struct sensor right;
static jp_q16 least;    /* expected current, which goes up and down between them */
static jp_q16 greatest; /* A */
static uint32_t time;

static void start(void)
{
    jp_current_check_start(&check, &config, &motors);
    left = right = (struct sensor){0, JP_Q16_ONE};
    time = 0;
}

void setUp(void)
{
    config = usual;
    least = JP_Q16(-0.5);
    greatest = JP_Q16(0.8);
    start();
}

void tearDown(void)
{
}

static jp_q16 measured(const struct sensor *sensor, jp_q16 current)
{
    const jp_q16 noise = (jp_q16)(time * 7919U % 13U) * 100 - 600; /* ±0.009 A */

    return jp_add(jp_add(sensor->offset, jp_q16_multiply(sensor->gain, current)), noise);
}

/** From `least` to `greatest` in 32 samples, and back. */
static jp_q16 expected(void)
{
    const int32_t phase = (int32_t)(time % 64U);
    const int32_t up = phase < 32 ? phase : 64 - phase;

    return least + (greatest - least) / 32 * up;
}

static uint8_t update(jp_q16 current)
{
    const jp_q16 voltage = jp_q16_multiply(current, motors.motor_resistance);
    const struct jp_motor_sample sample = {
        .voltages = {.left = voltage, .right = voltage},
        .current_left = measured(&left, current),
        .current_right = measured(&right, current),
    };

    time++;
    return jp_current_check_update(&check, &sample);
}

/** The findings of the last of `count` samples. */
static uint8_t drive(uint32_t count)
{
    uint8_t findings = 0;

    for (uint32_t i = 0; i < count; i++) {
        findings = update(expected());
    }
    return findings;
}

/** Drives on; fails when anything else is found. */
static void expect_always(uint8_t findings, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        TEST_ASSERT_EQUAL_HEX8(findings, update(expected()));
    }
}

static void stand(void)
{
    least = JP_Q16(-0.01);
    greatest = JP_Q16(0.01);
}

/* Configuration */

DEFINE_EXPECT_CONFIG_OF(jp_current_check_check, usual)

static void test_checks_every_field_at_its_limits(void)
{
    expect_config(NULL);
    RANGE("current_check.", offset, JP_Q16(0.005), JP_Q16(10));
    AT_LEAST("current_check.", gain, JP_Q16(0.01));
    FIELD(gain, JP_Q16(0.25), NULL);
    FIELD(gain, JP_Q16(0.25) + 1, "current_check.resistance");
    FIELD(gain, JP_Q16(0.5) + 1, "current_check.gain");
    FIELD(resistance, JP_Q16(0.06), NULL);
    FIELD(resistance, JP_Q16(0.06) - 1, "current_check.resistance");
    AT_MOST("current_check.", resistance, JP_Q16(0.5));
    RANGE("current_check.", excitation, JP_Q16(0.02), JP_Q16(10));
    RANGE("current_check.", memory, 128, 4096);
}

/* Sound sensors */

static void test_says_nothing_against_sound_sensors(void)
{
    expect_always(0, 20U * MEMORY);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.002), 0, check.left.estimate.offset);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.005), JP_Q16_ONE, check.left.estimate.gain);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.005), JP_Q16_ONE, check.right.estimate.gain);
    TEST_ASSERT_TRUE(check.left.estimate.gain_deviation < JP_Q16(0.005));
    TEST_ASSERT_TRUE(check.left.estimate.offset_deviation < JP_Q16(0.002));
}

static void test_estimates_nothing_before_it_has_settled(void)
{
    TEST_ASSERT_EQUAL_HEX8(0, drive(SETTLING - 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, check.left.estimate.offset_deviation);
    TEST_ASSERT_EQUAL_INT32(JP_Q16_ONE, check.left.estimate.gain);
    TEST_ASSERT_EQUAL_INT32(JP_CURRENT_DEVIATION_MAX, check.left.estimate.gain_deviation);
    (void)drive(1);
    TEST_ASSERT_TRUE(check.left.estimate.offset_deviation < JP_Q16(0.01));
    TEST_ASSERT_TRUE(check.left.estimate.gain_deviation < JP_Q16(0.01));
}

static void test_nothing_drifts_while_the_robot_stands(void)
{
    (void)drive(4U * MEMORY);
    stand();
    expect_always(0, 8U * MEMORY);

    const struct jp_current_estimate before = check.left.estimate;

    expect_always(0, 40U * MEMORY);
    TEST_ASSERT_EQUAL_INT32(before.gain, check.left.estimate.gain);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), JP_CURRENT_DEVIATION_MAX, check.left.estimate.gain_deviation);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.03), JP_Q16_ONE, before.gain);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.002), before.offset, check.left.estimate.offset);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.002), 0, check.left.estimate.offset);
}

static void test_speed_and_turning_cause_no_current_of_their_own(void)
{
    /* Wheels at 2 and 5 turn/s: 4 V and 10 V of back-EMF. */
    const struct jp_motor_sample sample = {
        .voltages = {.left = JP_Q16(4) + JP_Q16(4) / 10, .right = JP_Q16(10)},
        .wheel_rate = JP_Q24(3.5),
        .yaw_rate = JP_Q24(1),
        .current_left = JP_Q16(0.1),
        .current_right = 0,
    };

    for (uint32_t i = 0; i < MEMORY; i++) {
        TEST_ASSERT_EQUAL_HEX8(0, jp_current_check_update(&check, &sample));
    }
    TEST_ASSERT_INT32_WITHIN(2, 0, check.left.estimate.offset);
    TEST_ASSERT_INT32_WITHIN(2, 0, check.right.estimate.offset);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0001), JP_Q24(0.1), check.left.moments.mean_expected);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0001), 0, check.right.moments.mean_expected);
}

/* Offsets */

static void expect_offset(struct sensor *sensor, const struct jp_current_estimate *estimate, jp_q16 offset,
                          uint8_t finding)
{
    (void)drive(4U * MEMORY);
    sensor->offset = offset;
    TEST_ASSERT_EQUAL_HEX8(finding, drive(NAMED));
    expect_always(finding, 4U * MEMORY);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.003), offset, estimate->offset);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.005), JP_Q16_ONE, estimate->gain);
    sensor->offset = 0;
    TEST_ASSERT_EQUAL_HEX8(0, drive(NAMED));
    expect_always(0, 4U * MEMORY);
}

static void test_finds_the_offset_of_either_sensor(void)
{
    expect_offset(&left, &check.left.estimate, JP_Q16(0.1), JP_CURRENT_OFFSET_LEFT);
    expect_offset(&left, &check.left.estimate, JP_Q16(-1), JP_CURRENT_OFFSET_LEFT);
    expect_offset(&right, &check.right.estimate, JP_Q16(0.5), JP_CURRENT_OFFSET_RIGHT);
    expect_offset(&right, &check.right.estimate, JP_Q16(-0.1), JP_CURRENT_OFFSET_RIGHT);
}

static void test_finds_an_offset_while_the_robot_stands(void)
{
    stand();
    expect_offset(&left, &check.left.estimate, JP_Q16(0.1), JP_CURRENT_OFFSET_LEFT);
    start();
    expect_offset(&right, &check.right.estimate, JP_Q16(-0.5), JP_CURRENT_OFFSET_RIGHT);
    start();
    expect_offset(&right, &check.right.estimate, JP_Q16(-5), JP_CURRENT_OFFSET_RIGHT);
}

static void test_an_offset_from_the_start_has_a_name_soon(void)
{
    stand();
    right.offset = JP_Q16(0.2);
    TEST_ASSERT_EQUAL_HEX8(0, drive(SETTLING - 1));
    TEST_ASSERT_EQUAL_HEX8(JP_CURRENT_CHANGING, drive(1));
    expect_always(JP_CURRENT_CHANGING, SETTLING - 2);
    expect_always(JP_CURRENT_OFFSET_RIGHT, 4U * MEMORY);
}

/* Held by a slope it draws a steady current: a gain could look like an offset. */
static void test_says_nothing_of_an_offset_that_a_gain_may_be(void)
{
    least = JP_Q16(0.75);
    greatest = JP_Q16(0.77);
    left.gain = right.gain = JP_Q16(0.88);
    expect_always(0, 8U * MEMORY);
    TEST_ASSERT_TRUE(check.left.estimate.offset_deviation >= JP_Q16(0.07));
}

static void test_says_nothing_at_the_limit(void)
{
    left.offset = JP_Q16(0.05);
    expect_always(0, 20U * MEMORY);
    start();
    left.gain = right.gain = JP_Q16(1.06);
    expect_always(0, 20U * MEMORY);
}

/* Gains */

static void expect_gain(struct sensor *sensor, const struct jp_current_estimate *estimate, jp_q16 gain, uint8_t finding)
{
    (void)drive(4U * MEMORY);
    sensor->gain = gain;
    TEST_ASSERT_EQUAL_HEX8(finding, drive(2U * NAMED));
    expect_always(finding, 8U * MEMORY);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.005), gain, estimate->gain);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.003), 0, estimate->offset);
    sensor->gain = JP_Q16_ONE;
    TEST_ASSERT_EQUAL_HEX8(0, drive(4U * NAMED));
    expect_always(0, 4U * MEMORY);
}

static void test_finds_the_gain_of_either_sensor(void)
{
    expect_gain(&left, &check.left.estimate, JP_Q16(0.9), JP_CURRENT_GAIN_LEFT);
    expect_gain(&left, &check.left.estimate, JP_Q16(1.2), JP_CURRENT_GAIN_LEFT);
    expect_gain(&right, &check.right.estimate, JP_Q16(0.5), JP_CURRENT_GAIN_RIGHT);
    expect_gain(&right, &check.right.estimate, JP_Q16(1.1), JP_CURRENT_GAIN_RIGHT);
    expect_gain(&right, &check.right.estimate, JP_Q16(-1), JP_CURRENT_GAIN_RIGHT);
}

static void test_says_nothing_of_a_gain_while_the_robot_stands(void)
{
    stand();
    left.gain = JP_Q16(0.8);
    expect_always(0, 20U * MEMORY);
    TEST_ASSERT_EQUAL_INT32(JP_CURRENT_DEVIATION_MAX, check.left.estimate.gain_deviation);
}

static void test_keeps_a_finding_while_the_robot_stands(void)
{
    left.gain = JP_Q16(0.8);
    TEST_ASSERT_EQUAL_HEX8(JP_CURRENT_GAIN_LEFT, drive(4U * MEMORY));
    stand();
    left.gain = JP_Q16_ONE;
    expect_always(JP_CURRENT_GAIN_LEFT, 20U * MEMORY);
}

static void test_takes_equal_gains_for_resistance(void)
{
    left.gain = right.gain = JP_Q16(0.9);
    TEST_ASSERT_EQUAL_HEX8(JP_CURRENT_RESISTANCE, drive(2U * NAMED));
    expect_always(JP_CURRENT_RESISTANCE, 8U * MEMORY);
    TEST_ASSERT_EQUAL_HEX8(0x3F & ~JP_CURRENT_RESISTANCE, JP_CURRENT_DOUBT);
    left.gain = right.gain = JP_Q16_ONE;
    TEST_ASSERT_EQUAL_HEX8(0, drive(4U * NAMED));
    expect_always(0, 4U * MEMORY);
}

static void test_one_warm_motor_is_resistance(void)
{
    right.gain = JP_Q16(0.955);
    left.gain = JP_Q16(0.92);
    (void)drive(2U * NAMED);
    expect_always(JP_CURRENT_RESISTANCE, 8U * MEMORY);
}

static void test_takes_no_gain_for_resistance_that_windings_cannot_have(void)
{
    left.gain = right.gain = JP_Q16(0.6);
    (void)drive(2U * NAMED);
    expect_always(JP_CURRENT_GAIN_LEFT | JP_CURRENT_GAIN_RIGHT, 8U * MEMORY);
}

/* As far off as windings can just be: neither is said, and no current believed. */
static void test_blames_nobody_at_the_limit(void)
{
    left.gain = right.gain = JP_Q16(0.75);
    (void)drive(2U * NAMED);
    expect_always(JP_CURRENT_CHANGING, 8U * MEMORY);
}

/* A motor that is warm besides a sensor that was repaired. */
static void test_a_sensor_is_blamed_no_longer_than_it_is_at_fault(void)
{
    left.gain = JP_Q16(0.7);
    right.gain = JP_Q16(0.9);
    TEST_ASSERT_EQUAL_HEX8(JP_CURRENT_GAIN_LEFT | JP_CURRENT_GAIN_RIGHT, drive(4U * NAMED));
    left.gain = JP_Q16(0.9);
    TEST_ASSERT_EQUAL_HEX8(JP_CURRENT_RESISTANCE, drive(8U * NAMED));
}

static void test_never_names_resistance_on_the_way_to_a_gain_and_back(void)
{
    (void)drive(4U * MEMORY);
    right.gain = JP_Q16(0.8);
    for (uint32_t i = 0; i < 4U * MEMORY; i++) {
        TEST_ASSERT_BITS_LOW(JP_CURRENT_RESISTANCE, update(expected()));
    }
    right.gain = JP_Q16_ONE;
    for (uint32_t i = 0; i < 8U * MEMORY; i++) {
        TEST_ASSERT_BITS_LOW(JP_CURRENT_RESISTANCE, update(expected()));
    }
}

static void test_limits_a_large_gain(void)
{
    left.gain = JP_Q16(4.04);
    right.gain = JP_Q16(-4.04);
    TEST_ASSERT_EQUAL_HEX8(JP_CURRENT_GAIN_LEFT | JP_CURRENT_GAIN_RIGHT, drive(2U * MEMORY));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(4), check.left.estimate.gain);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(-4), check.right.estimate.gain);
}

static void test_doubts_an_absurd_gain_for_ever(void)
{
    left.gain = JP_Q16(30);
    (void)drive(MEMORY);
    expect_always(JP_CURRENT_CHANGING, 20U * MEMORY);
    TEST_ASSERT_EQUAL_INT32(JP_Q16_ONE, check.left.estimate.gain);
}

/* Sudden changes */

static void test_doubts_at_once_when_a_sensor_changes(void)
{
    uint32_t samples = 0;

    (void)drive(4U * MEMORY);
    left.offset = JP_Q16(-0.3);
    while (update(expected()) == 0U) {
        samples++;
    }
    TEST_ASSERT_TRUE(samples <= MEMORY / 16);
    expect_always(JP_CURRENT_CHANGING, SETTLING);
}

/* Too little to be forgotten for, or to be named: but no current is believed while the old line passes into the new. */
static void test_doubts_while_a_small_change_is_learned(void)
{
    uint8_t findings = 0;

    (void)drive(4U * MEMORY);
    left.offset = JP_Q16(0.035);
    for (uint32_t i = 0; i < 2U * MEMORY; i++) {
        findings |= update(expected());
    }
    TEST_ASSERT_EQUAL_HEX8(JP_CURRENT_CHANGING, findings);
    (void)drive(4U * MEMORY);
    expect_always(0, 4U * MEMORY);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.003), JP_Q16(0.035), check.left.estimate.offset);
}

/* Were the samples of before kept, the line through both would have another gain. */
static void test_an_offset_that_comes_with_a_current_is_no_gain(void)
{
    stand();
    (void)drive(4U * MEMORY);
    left.offset = JP_Q16(0.5);
    least = JP_Q16(0.6);
    greatest = JP_Q16(1);
    for (uint32_t i = 0; i < 8U * MEMORY; i++) {
        TEST_ASSERT_BITS_LOW(JP_CURRENT_GAIN_LEFT | JP_CURRENT_GAIN_RIGHT | JP_CURRENT_OFFSET_RIGHT,
                             update(expected()));
    }
    TEST_ASSERT_EQUAL_HEX8(JP_CURRENT_OFFSET_LEFT, update(expected()));
}

/* Samples of any value */

static void expect_left_out(jp_q16 current, jp_q16 sensed)
{
    const struct jp_motor_sample sample = {
        .voltages = {.left = jp_q16_multiply(current, JP_Q16(4)), .right = 0},
        .current_left = sensed,
    };
    const struct jp_current_motor before = check.left;

    (void)jp_current_check_update(&check, &sample);
    TEST_ASSERT_EQUAL_MEMORY(&before, &check.left, sizeof before);
}

static void test_leaves_out_what_is_beyond_its_range(void)
{
    (void)drive(MEMORY);
    expect_left_out(JP_CURRENT_CHECK_MAX + 1, 0);
    expect_left_out(-JP_CURRENT_CHECK_MAX - 1, 0);
    expect_left_out(0, JP_CURRENT_CHECK_MAX + 1);
    expect_left_out(0, -JP_CURRENT_CHECK_MAX - 1);
    expect_left_out(INT32_MAX, INT32_MIN);
}

static void test_survives_extreme_samples(void)
{
    static const jp_q16 extremes[] = {JP_CURRENT_CHECK_MAX, -JP_CURRENT_CHECK_MAX, 0, INT32_MAX, INT32_MIN, 1};

    config.excitation = JP_Q16(0.02);
    start();
    for (uint32_t i = 0; i < 12U * MEMORY; i++) {
        const jp_q16 voltage = jp_q16_multiply(extremes[i % 5U], JP_Q16(4));
        const struct jp_motor_sample sample = {
            .voltages = {.left = voltage, .right = extremes[i * 7U % 6U]},
            .wheel_rate = i % 97U == 0U ? INT32_MIN : 0,
            .yaw_rate = i % 89U == 0U ? INT32_MAX : 0,
            .current_left = extremes[i * 5U % 6U],
            .current_right = extremes[i / 256U % 6U],
        };

        (void)jp_current_check_update(&check, &sample);
        TEST_ASSERT_TRUE(check.left.moments.expected >= 0 && check.left.moments.measured >= 0);
        TEST_ASSERT_TRUE(check.right.moments.expected >= 0 && check.right.moments.measured >= 0);
        TEST_ASSERT_TRUE(check.left.estimate.offset_deviation >= 0 && check.left.estimate.gain_deviation >= 0);
    }
    start();
    (void)drive(4U * MEMORY);
    expect_always(0, MEMORY);
}
