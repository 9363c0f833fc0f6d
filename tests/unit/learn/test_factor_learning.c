/* Learners of factors: their check, and what they share, with a robot whose factors are of four parts of its energy. */
#include <joulepath/factor_learning.h>
#include <joulepath/tables.h>
#include <string.h>

#include "src/learn/factor_state.h"
#include "src/learn/forecast_sum.h"
#include "tests/support/config_check.h"
#include "tests/target/random.h"
#include "unity.h"

enum { N = JP_LEARNING_DIRECTIONS };

static const struct jp_factor_learning usual = {
    .deviation = {JP_Q16(0.25), JP_Q16(0.2), JP_Q16(0.15), JP_Q16(0.1)},
    .noise_relative = JP_Q16(0.005),
    .noise = JP_Q16(0.1),
    .spread = JP_Q16(1.5),
    .memory = 64,
    .identity = 12,
};

static const jp_q16 ones[N] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE};

static struct jp_factor_learning config;
static struct jp_learned_state state;
static struct jp_learned_watch watch;
static jp_q16 part[N]; /* of the energy of the next leg, J, of a robot whose factors are 1 */
static uint32_t random_state;
static const char *refused;

void setUp(void)
{
    config = usual;
    jp_learned_state_start(&state, config.identity);
    watch = (struct jp_learned_watch){.alarm = 0};
    random_state = 1;
    refused = NULL;
}

void tearDown(void)
{
}

/* ---- Check ---- */

DEFINE_EXPECT_CONFIG_OF(jp_factor_learning_check, usual)

static void test_check_names_each_field_at_both_limits(void)
{
    expect_config(NULL);
    FIELD(deviation[0], 0, "learning.deviation");
    FIELD(deviation[3], JP_Q16_ONE + 1, "learning.deviation");
    FIELD(deviation[1], 1, NULL);
    FIELD(deviation[2], JP_Q16_ONE, NULL);
    RANGE("learning.", noise_relative, 0, JP_Q16_ONE);
    RANGE("learning.", noise, 1, JP_Q16(1024));
    RANGE("learning.", spread, JP_Q16_ONE, JP_Q16(16));
    RANGE("learning.", memory, 8, 1024);
    FIELD(identity, 0, "learning.identity");
}

/* ---- Legs ---- */

static void draw_leg(void)
{
    for (int j = 0; j < (int)N; j++) {
        part[j] = (jp_q16)(((uint64_t)target_random(&random_state) * (uint32_t)JP_Q16(40)) >> 32);
    }
}

static int64_t energy_with(const jp_q16 factor[N])
{
    int64_t sum = 0;

    for (int j = 0; j < (int)N; j++) {
        sum += jp_q16_multiply(factor[j], part[j]);
    }
    return sum;
}

static bool expect_leg(uint64_t variance, struct jp_expectation *expected)
{
    jp_q16 factor[N];
    int64_t change[N];

    jp_factors(&config, &state, factor);
    for (int j = 0; j < (int)N; j++) {
        change[j] = jp_q16_multiply(factor[j], part[j]);
    }
    return jp_factor_expect(&config, &state, energy_with(factor), change, variance, expected);
}

static enum jp_learned learn(jp_q16 measured)
{
    struct jp_expectation expected;

    TEST_ASSERT_TRUE(expect_leg(0, &expected));
    const enum jp_learned learned = jp_learned_state_update(&state, &watch, config.memory, &expected, measured);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learned_state_check(&state, &refused));
    return learned;
}

static unsigned drive_as(const jp_q16 factor[N], unsigned legs)
{
    unsigned changes = 0;

    for (unsigned i = 0; i < legs; i++) {
        draw_leg();
        changes += learn((jp_q16)energy_with(factor)) == JP_LEARNED_CHANGE ? 1U : 0U;
    }
    return changes;
}

static void expect_factors(const jp_q16 expected[N], jp_q16 tolerance)
{
    jp_q16 factor[N];

    jp_factors(&config, &state, factor);
    for (int j = 0; j < (int)N; j++) {
        TEST_ASSERT_INT32_WITHIN(tolerance, expected[j], factor[j]);
    }
}

/* ---- Learning ---- */

static void test_nothing_is_learned_at_first(void)
{
    jp_q16 deviation[N];

    expect_factors(ones, 0);
    jp_factor_deviations(&config, &state, deviation);
    for (int j = 0; j < (int)N; j++) {
        TEST_ASSERT_INT32_WITHIN(1, usual.deviation[j], deviation[j]);
    }
}

static void test_another_robot_is_learned(void)
{
    static const jp_q16 factor[N] = {JP_Q16(1.3), JP_Q16(0.8), JP_Q16(1.2), JP_Q16(0.9)};
    jp_q16 deviation[N];

    (void)drive_as(factor, 100);
    expect_factors(factor, JP_Q16(0.01));
    jp_factor_deviations(&config, &state, deviation);
    for (int j = 0; j < (int)N; j++) {
        TEST_ASSERT_TRUE(deviation[j] < usual.deviation[j] / 4);
    }
}

static void test_factors_keep_their_range(void)
{
    static const jp_q16 ends[N] = {JP_FACTOR_MAX, JP_FACTOR_MIN, JP_FACTOR_MAX, JP_FACTOR_MIN};

    for (int j = 0; j < (int)N; j++) {
        config.deviation[j] = JP_Q16_ONE;
        state.x[j] = j % 2 == 0 ? JP_LEARNED_MAX : -JP_LEARNED_MAX;
    }
    expect_factors(ends, 0);
}

static void test_an_outlier_counts_little(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, drive_as(ones, 40));
    draw_leg();
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER, learn(2 * (jp_q16)energy_with(ones)));
    expect_factors(ones, JP_Q16(0.05));
}

static void test_another_ground_is_noticed_and_learned(void)
{
    static const jp_q16 rough[N] = {JP_Q16(1.5), JP_Q16(1.3), JP_Q16_ONE, JP_Q16_ONE};

    (void)drive_as(ones, 40);
    TEST_ASSERT_TRUE(drive_as(rough, 60) >= 1U);
    expect_factors(rough, JP_Q16(0.02));
}

/* ---- Expectations ---- */

/* By the change of each factor, and the deviation of each. */
static void test_sensitivity_is_by_the_deviation(void)
{
    struct jp_expectation expected;

    state.x[0] = JP_Q24(2); /* so that its factor is 1.5 */
    draw_leg();
    TEST_ASSERT_TRUE(expect_leg(0, &expected));
    for (int j = 0; j < (int)N; j++) {
        TEST_ASSERT_INT32_WITHIN(2, jp_q16_multiply(usual.deviation[j], part[j]), expected.sensitivity[j]);
    }
    TEST_ASSERT_EQUAL_INT32(usual.spread, expected.spread);
}

/* 3 and 4 J, and 12 of the kind's own. */
static void test_noise_is_of_its_parts(void)
{
    static const int64_t change[N] = {0, 0, 0, 0};
    struct jp_expectation expected;

    config.noise = JP_Q16(3);
    config.noise_relative = JP_Q16(0.05);
    TEST_ASSERT_TRUE(jp_factor_expect(&config, &state, JP_Q16(80), change, 0, &expected));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), JP_Q16(5), expected.noise);
    TEST_ASSERT_TRUE(jp_factor_expect(&config, &state, JP_Q16(80), change, (uint64_t)144 << 32, &expected));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), JP_Q16(13), expected.noise);
}

static void test_what_does_not_fit_is_told(void)
{
    int64_t change[N] = {0, 0, (int64_t)INT32_MIN - 1, 0};
    struct jp_expectation expected;

    TEST_ASSERT_FALSE(jp_factor_expect(&config, &state, 0, change, 0, &expected));
    change[2] = INT32_MIN;
    TEST_ASSERT_TRUE(jp_factor_expect(&config, &state, 0, change, 0, &expected));
    TEST_ASSERT_FALSE(jp_factor_expect(&config, &state, (int64_t)INT32_MAX + 1, change, 0, &expected));
}

static struct jp_forecast forecast_of(unsigned legs)
{
    struct jp_forecast_sum sum = {0, {0}, 0};
    struct jp_forecast forecast;

    for (unsigned i = 0; i < legs; i++) {
        struct jp_expectation expected;

        draw_leg();
        TEST_ASSERT_TRUE(expect_leg(0, &expected));
        jp_forecast_sum_add(&sum, &expected);
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_sum_total(&state, &sum, &forecast));
    return forecast;
}

static void test_forecasts_get_surer(void)
{
    static const jp_q16 factor[N] = {JP_Q16(1.3), JP_Q16(0.8), JP_Q16(1.2), JP_Q16(0.9)};
    const struct jp_forecast before = forecast_of(10);

    TEST_ASSERT_TRUE(before.deviation > before.energy / 20);
    (void)drive_as(factor, 40);

    const struct jp_forecast after = forecast_of(10);

    TEST_ASSERT_TRUE(after.deviation < after.energy / 50);
    TEST_ASSERT_TRUE(after.deviation > 0);
}
