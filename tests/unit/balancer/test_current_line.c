/* The current check's line: when samples tell a gain, how sure it is, and when they cannot be of one line. Without
 * noise all of it is arithmetic, and its limits are met to the last digit. */
#include <joulepath/current_check.h>

#include "unity.h"

#define MEMORY   256
#define SETTLING (MEMORY / 4)

static const struct jp_monitor_config motors = {
    .motor_resistance = JP_Q16(4), .back_emf = JP_Q16(2), .half_track = JP_Q16(1.5)};

static struct jp_current_check_config config;
static struct jp_current_check check;

void setUp(void)
{
    config = (struct jp_current_check_config){
        .offset = JP_Q16(0.05),
        .gain = JP_Q16(0.06),
        .resistance = JP_Q16(0.25),
        .excitation = JP_Q16(0.1),
        .memory = MEMORY,
    };
    jp_current_check_start(&check, &config, &motors);
}

void tearDown(void)
{
}

/** The left motor: what it should draw, and what is measured. */
static uint8_t update(jp_q16 expected, jp_q16 measured)
{
    const struct jp_motor_sample sample = {.voltages = {.left = 4 * expected}, .current_left = measured};

    return jp_current_check_update(&check, &sample);
}

static uint8_t update_times(int count, jp_q16 expected, jp_q16 measured)
{
    uint8_t findings = 0;

    for (int i = 0; i < count; i++) {
        findings = update(expected, measured);
    }
    return findings;
}

/* ---- How sure ---- */

/* Without noise a milliampere is away from the line, which no averaging makes less than half. */
static void test_no_sensor_is_believed_to_be_better_than_a_milliampere(void)
{
    (void)update_times(MEMORY, 0, 0);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.001 * 0.5039), check.left.estimate.offset_deviation); /* √(1/256 + 1/4) */
}

static void test_large_currents_tell_a_gain_as_well_as_can_be(void)
{
    for (int i = 0; i < MEMORY; i++) {
        const jp_q16 current = i % 2 == 0 ? JP_Q16(59) : -JP_Q16(59);
        const jp_q16 noise = i % 4 < 2 ? 60 : -60;

        (void)update(current, current + noise);
    }
    TEST_ASSERT_INT32_WITHIN(1, JP_Q16_ONE, check.left.estimate.gain);
    TEST_ASSERT_EQUAL_INT32(0, check.left.estimate.gain_deviation);
}

/* By a share of a memory of what is missing. */
static void test_a_gain_that_is_not_seen_is_forgotten_slowly(void)
{
    jp_q16 before;

    for (int i = 0; i < MEMORY; i++) {
        (void)update(i % 2 == 0 ? JP_Q16(0.5) : 0, i % 2 == 0 ? JP_Q16(0.5) : 0);
    }
    for (int i = 0; i < 8 * MEMORY; i++) {
        before = check.left.estimate.gain_deviation;
        (void)update(JP_Q16(0.25), JP_Q16(0.25));
        TEST_ASSERT_LESS_OR_EQUAL_INT32(JP_CURRENT_DEVIATION_MAX / MEMORY + 1,
                                        check.left.estimate.gain_deviation - before);
    }
    TEST_ASSERT_GREATER_THAN_INT32(JP_CURRENT_DEVIATION_MAX / 2, check.left.estimate.gain_deviation);
}

/* ---- Moments ---- */

/** What a moment must be before a sample at the mean, for it to be the square afterwards, A² in Q32. */
static int64_t before_sample(int64_t square)
{
    return ((square * 65536 + 32768) * MEMORY + MEMORY - 2) / (MEMORY - 1);
}

/** Settled at 0, with moments as if there had been such a variance. */
static uint8_t update_with(int64_t expected, int64_t measured)
{
    jp_current_check_start(&check, &config, &motors);
    (void)update_times(2 * MEMORY, 0, 0);
    check.left.moments.expected = before_sample(expected);
    check.left.moments.product = before_sample(expected);
    check.left.moments.measured = before_sample(measured);

    const uint8_t findings = update(0, 0);

    TEST_ASSERT_EQUAL_INT64(expected, check.left.moments.count == 0U ? expected : check.left.moments.expected >> 16);
    return findings;
}

/* Of a least standard deviation of the expected current. */
static void test_as_much_excitation_as_asked_for_tells_the_gain(void)
{
    const int64_t least = (int64_t)config.excitation * config.excitation;

    (void)update_with(least - 1, least - 1);
    TEST_ASSERT_GREATER_THAN_INT32(JP_CURRENT_DEVIATION_MAX / 2, check.left.estimate.gain_deviation);
    (void)update_with(least, least);
    TEST_ASSERT_LESS_THAN_INT32(JP_CURRENT_DEVIATION_MAX / 2, check.left.estimate.gain_deviation);
}

/* An eighth of the offset that is a finding. */
static void test_samples_off_the_line_are_doubted(void)
{
    const int64_t share = config.offset / 8;

    TEST_ASSERT_EQUAL_HEX8(0, update_with(0, share * share));
    TEST_ASSERT_EQUAL_HEX8(JP_CURRENT_CHANGING, update_with(0, share * share + 1));
    TEST_ASSERT_NOT_EQUAL(0, check.left.moments.count);
}

/* A quarter of it. */
static void test_samples_far_off_the_line_are_forgotten(void)
{
    const int64_t share = config.offset / 4;

    (void)update_with(0, share * share);
    TEST_ASSERT_EQUAL_UINT32(MEMORY, check.left.moments.count);
    TEST_ASSERT_EQUAL_HEX8(JP_CURRENT_CHANGING, update_with(0, share * share + 1));
    TEST_ASSERT_EQUAL_UINT32(0, check.left.moments.count);
}

/* ---- Sudden changes ---- */

/** A short mean, of a sixteenth of the memory, takes in this sample. Half the offset, and four deviations: of the gain,
 *  by the current, and of the short mean, three times the offset's. */
static jp_q16 jump_at_limit(jp_q16 current)
{
    const struct jp_current_estimate *estimate = &check.left.estimate;
    const jp_q16 of_gain = jp_multiply_shift(current, estimate->gain_deviation, 16);

    return 16 * (config.offset / 2 + 4 * (of_gain + 3 * estimate->offset_deviation));
}

static void expect_jump(jp_q16 more, int side, bool is_forgotten)
{
    const jp_q16 current = JP_Q16(0.2);

    jp_current_check_start(&check, &config, &motors);
    (void)update_times(2 * MEMORY, current, current);
    (void)update(current, current + side * (jump_at_limit(current) + more));
    TEST_ASSERT_EQUAL_UINT32(is_forgotten ? 0 : MEMORY, check.left.moments.count);
}

static void test_a_jump_beyond_what_chance_explains_is_noticed_at_once(void)
{
    for (int side = -1; side <= 1; side += 2) {
        expect_jump(0, side, false);
        expect_jump(1, side, true);
    }
}

/** Samples until an offset holds. */
static int samples_until_offset(jp_q16 offset)
{
    int samples = 0;

    do {
        (void)update(0, offset);
        samples++;
    } while (!check.left.offset.holds && samples < 4 * MEMORY);
    return samples;
}

static void test_a_change_begins_the_count_of_an_offset_anew(void)
{
    const int from_start = samples_until_offset(JP_Q16(0.3));

    jp_current_check_start(&check, &config, &motors);
    (void)update_times(from_start - 1, 0, JP_Q16(0.3));
    (void)update(0, JP_Q16(20));
    TEST_ASSERT_EQUAL_UINT32(0, check.left.moments.count);
    TEST_ASSERT_EQUAL_INT(from_start, samples_until_offset(JP_Q16(0.3)));
}

/** Samples until a gain holds. */
static int samples_until_gain(jp_q16 gain)
{
    int samples = 0;

    do {
        const jp_q16 current = samples % 2 == 0 ? JP_Q16(1) : -JP_Q16(1);

        (void)update(current, jp_q16_multiply(current, gain));
        samples++;
    } while (!check.left.gain.holds && samples < 4 * MEMORY);
    return samples;
}

static void test_a_change_begins_the_count_of_a_gain_anew(void)
{
    const int from_start = samples_until_gain(JP_Q16(0.5));

    jp_current_check_start(&check, &config, &motors);
    for (int i = 0; i < from_start - 1; i++) {
        (void)update(i % 2 == 0 ? JP_Q16(1) : -JP_Q16(1), i % 2 == 0 ? JP_Q16(0.5) : -JP_Q16(0.5));
    }
    (void)update(0, JP_Q16(40));
    TEST_ASSERT_EQUAL_UINT32(0, check.left.moments.count);
    TEST_ASSERT_EQUAL_INT(2 * SETTLING - 1,
                          samples_until_gain(JP_Q16(0.5))); /* until there is one, and until it holds */
}

/* ---- Statements ---- */

/** After a large offset, if there was one; in the memory of which noise still explains a milliampere. */
static uint8_t findings_after(int large, jp_q16 offset)
{
    jp_current_check_start(&check, &config, &motors);
    (void)update_times(large, 0, JP_Q16(1));

    const uint8_t findings = update_times((large == 0 ? 5 : 10) * MEMORY / 2, 0, offset);

    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.001 / 16), check.left.estimate.offset_deviation);
    return findings & JP_CURRENT_OFFSET_LEFT;
}

#define FOUR_DEVIATIONS (4 * JP_Q16(0.001 / 16))

static void test_an_offset_is_found_when_all_of_its_estimate_is_beyond(void)
{
    TEST_ASSERT_EQUAL_HEX8(0, findings_after(0, config.offset + FOUR_DEVIATIONS));
    TEST_ASSERT_EQUAL_HEX8(JP_CURRENT_OFFSET_LEFT, findings_after(0, config.offset + FOUR_DEVIATIONS + 1));
}

static void test_an_offset_is_over_when_all_of_its_estimate_is_within(void)
{
    TEST_ASSERT_EQUAL_HEX8(JP_CURRENT_OFFSET_LEFT, findings_after(4 * MEMORY, config.offset - FOUR_DEVIATIONS));
    TEST_ASSERT_EQUAL_HEX8(0, findings_after(4 * MEMORY, config.offset - FOUR_DEVIATIONS - 1));
}
