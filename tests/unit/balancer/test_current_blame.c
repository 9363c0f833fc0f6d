/* The current check's blame: what it says of two gains, and how long that takes. Samples beyond its range leave the
 * estimates as they are, so that the test says what they are. */
#include <joulepath/current_check.h>

#include "unity.h"

#define MEMORY   256U
#define SETTLING (MEMORY / 4U)
#define AGES     (10U * MEMORY)

static const struct jp_current_check_config config = {
    .offset = JP_Q16(0.05),
    .gain = JP_Q16(0.06),
    .resistance = JP_Q16(0.25),
    .excitation = JP_Q16(0.1),
    .memory = MEMORY,
};
static const struct jp_monitor_config motors = {
    .motor_resistance = JP_Q16(4), .back_emf = JP_Q16(2), .half_track = JP_Q16(1.5)};

static struct jp_current_check check;

static void believe(jp_q16 left, jp_q16 right, jp_q16 deviation)
{
    check.left.estimate.gain = left;
    check.right.estimate.gain = right;
    check.left.estimate.gain_deviation = deviation;
    check.right.estimate.gain_deviation = deviation;
    check.left.gain.holds = true;
}

void setUp(void)
{
    jp_current_check_start(&check, &config, &motors);
    believe(JP_Q16_ONE, JP_Q16_ONE, 0);
}

void tearDown(void)
{
}

static uint8_t update(void)
{
    const struct jp_motor_sample beyond = {.current_left = JP_CURRENT_CHECK_MAX + 1,
                                           .current_right = JP_CURRENT_CHECK_MAX + 1};

    return jp_current_check_update(&check, &beyond);
}

/** Samples until it says so; AGES: it does not. */
static unsigned samples_until(uint8_t findings)
{
    unsigned samples = 1;

    while (update() != findings && samples < AGES) {
        samples++;
    }
    return samples;
}

/* Two gains of a standard deviation s each differ by 1.5 s with certainty, of which it wants four. */
static void test_gains_differ_by_more_than_their_deviations_explain(void)
{
    const jp_q16 deviation = JP_Q16(0.01);
    const jp_q16 certain = config.gain + 4 * (deviation + deviation / 2);

    believe(JP_Q16(0.9) + certain - 8, JP_Q16(0.9), deviation);
    TEST_ASSERT_EQUAL_UINT32(AGES, samples_until(JP_CURRENT_GAIN_LEFT));
    believe(JP_Q16(0.9) + certain + 8, JP_Q16(0.9), deviation);
    TEST_ASSERT_EQUAL_UINT32(SETTLING, samples_until(JP_CURRENT_GAIN_LEFT));
}

static void blame_the_motors(void)
{
    believe(JP_Q16(0.9), JP_Q16(0.9), 0);
}

static void blame_a_sensor(void)
{
    believe(JP_Q16(0.7), JP_Q16_ONE, 0);
}

/* Between either: as far off as windings can be, and no further. */
static void blame_nobody(void)
{
    believe(JP_Q16(0.75), JP_Q16(0.75), JP_Q16(0.001));
}

static void test_who_is_blamed_first_takes_a_settling(void)
{
    blame_the_motors();
    TEST_ASSERT_EQUAL_UINT32(SETTLING, samples_until(JP_CURRENT_RESISTANCE));
    blame_a_sensor();
    TEST_ASSERT_EQUAL_UINT32(SETTLING, samples_until(JP_CURRENT_GAIN_LEFT));
}

static void test_a_sensor_stays_blamed_for_two_memories(void)
{
    blame_a_sensor();
    TEST_ASSERT_EQUAL_UINT32(SETTLING, samples_until(JP_CURRENT_GAIN_LEFT));
    blame_the_motors();
    TEST_ASSERT_EQUAL_UINT32(2U * MEMORY, samples_until(JP_CURRENT_RESISTANCE));
}

static void update_times(unsigned samples)
{
    for (unsigned i = 0; i < samples; i++) {
        (void)update();
    }
}

/* In a row. */
static void test_a_doubt_begins_the_settling_anew(void)
{
    blame_the_motors();
    update_times(SETTLING - 1U);
    blame_nobody();
    update_times(1);
    blame_the_motors();
    TEST_ASSERT_EQUAL_UINT32(SETTLING, samples_until(JP_CURRENT_RESISTANCE));
}

static void test_gains_that_are_right_again_begin_the_settling_anew(void)
{
    blame_the_motors();
    update_times(SETTLING - 1U);
    check.left.gain.holds = false;
    update_times(1);
    blame_the_motors();
    TEST_ASSERT_EQUAL_UINT32(SETTLING, samples_until(JP_CURRENT_RESISTANCE));
}
