/* Forecasts of the learner and the reserves that they ask for. */
#include "src/learn/normal_quantile.h"
#include "tests/support/learner_rig.h"

static void test_a_forecast_is_the_sum_of_its_segments(void)
{
    struct jp_forecast_sum sum = {0, {0}, 0};
    struct jp_forecast forecast;
    struct jp_energy_start chained = start;
    int64_t expected = 0;

    for (unsigned i = 0; i < 20; i++) {
        const struct jp_segment_command segment = random_segment();
        jp_q16 energy;

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_add(&learner, &sum, &chained, &segment));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_energy_forecast(&BUILT_IN, &HORIZON, &start, &segment, &energy, &start));
        TEST_ASSERT_EQUAL_INT(0, memcmp(&start, &chained, sizeof start));
        expected += energy;
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_total(&learner, &sum, &forecast));
    TEST_ASSERT_INT32_WITHIN(20 * JP_Q16(0.01), (jp_q16)expected, forecast.energy);
    TEST_ASSERT_TRUE(forecast.deviation > forecast.energy / 100 && forecast.deviation < forecast.energy / 4);
}

/* What varies from segment to segment averages out, what is not known does not. */
static void test_the_deviation_shrinks_with_what_is_learned(void)
{
    static const jp_q24 none[N] = {0};
    const struct jp_segment_command segment = {{JP_Q24(0.5), 0}, 0, JP_Q16(10)};
    struct jp_forecast one, sixteen;

    for (unsigned pass = 0; pass < 2; pass++) {
        struct jp_forecast_sum sum = {0, {0}, 0};
        struct jp_energy_start from = {.motion = segment.motion};

        for (unsigned i = 1; i <= 16; i++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_add(&learner, &sum, &from, &segment));
            if (i == 1U) {
                TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_total(&learner, &sum, &one));
            }
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_total(&learner, &sum, &sixteen));
        if (pass == 0U) {
            TEST_ASSERT_TRUE(sixteen.deviation > 15 * one.deviation);
            (void)drive_as(none, 60);
        }
    }
    TEST_ASSERT_TRUE(sixteen.deviation < 8 * one.deviation);
}

/* A leg's energy changes with b1 and b2 as the model does. */
static void test_a_leg_is_forecast_by_the_learned_model(void)
{
    const struct jp_leg_energy leg = {JP_Q16(90), JP_Q16(10), JP_Q16(2.5), JP_Q16(1.2), {0}};
    struct jp_energy_model model;
    struct jp_forecast forecast;

    for (unsigned pass = 0; pass < 2U; pass++) {
        struct jp_forecast_sum sum = {0, {0}, 0};

        jp_learner_model(&learner, &model);
        for (unsigned i = 0; i < 3U; i++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_add_leg(&learner, &sum, &leg));
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_total(&learner, &sum, &forecast));
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01),
                                 3 * (leg.energy + jp_q16_multiply(model.b[0] - BUILT_IN.b[0], leg.travel) +
                                      jp_q16_multiply(model.b[1] - BUILT_IN.b[1], leg.turning)),
                                 forecast.energy);
        TEST_ASSERT_TRUE(forecast.deviation > 0 && forecast.deviation < forecast.energy / 4);
        learner.state.x[0] = JP_Q24(1.5);
        learner.state.x[1] = -JP_Q24(1);
    }
    TEST_ASSERT_NOT_EQUAL_INT32(BUILT_IN.b[0], model.b[0]);
}

static void test_a_leg_that_cannot_be_forecast(void)
{
    const struct jp_forecast_sum nothing = {0, {0}, 0};
    const struct jp_leg_energy leg = {INT32_MAX, INT32_MAX, INT32_MAX, 0, {0}};
    struct jp_forecast_sum sum = nothing;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_add_leg(NULL, &sum, &leg));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_add_leg(&learner, NULL, &leg));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_add_leg(&learner, &sum, NULL));
    learner.state.x[0] = JP_Q24(2);
    learner.state.x[1] = JP_Q24(2);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_forecast_add_leg(&learner, &sum, &leg));
    TEST_ASSERT_EQUAL_INT(0, memcmp(&nothing, &sum, sizeof sum));
}

static void test_a_failed_forecast_leaves_everything(void)
{
    struct jp_segment_command segment = {{JP_Q24(0.5), 0}, 0, JP_Q16(0.4)};
    const struct jp_forecast_sum nothing = {0, {0}, 0};
    const struct jp_energy_start rest = start;
    struct jp_forecast_sum sum = nothing;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_add(&learner, &sum, &start, &segment));
    segment = (struct jp_segment_command){{JP_Q24(8), JP_Q24(8)}, 0, JP_Q16(16384)};
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_forecast_add(&learner, &sum, &start, &segment));
    TEST_ASSERT_EQUAL_INT(0, memcmp(&nothing, &sum, sizeof sum));
    TEST_ASSERT_EQUAL_INT(0, memcmp(&rest, &start, sizeof start));
}

static void expect_total(struct jp_forecast_sum sum, enum jp_status status, jp_q16 energy, jp_q16 deviation)
{
    struct jp_forecast forecast;

    TEST_ASSERT_EQUAL_INT(status, jp_forecast_total(&learner, &sum, &forecast));
    TEST_ASSERT_EQUAL_INT32(energy, forecast.energy);
    TEST_ASSERT_INT32_WITHIN(1, deviation, forecast.deviation);
}

static void test_totals_saturate(void)
{
    const int64_t most = (int64_t)JP_Q16(8192);

    expect_total((struct jp_forecast_sum){INT32_MAX, {0}, ((uint64_t)1 << 46) - 65536U}, JP_OK, INT32_MAX, INT32_MAX);
    expect_total((struct jp_forecast_sum){0, {0}, (uint64_t)1 << 46}, JP_ERR_OVERFLOW, 0, INT32_MAX);
    expect_total((struct jp_forecast_sum){(int64_t)INT32_MAX + 1, {0}, 0}, JP_ERR_OVERFLOW, INT32_MAX, 0);
    expect_total((struct jp_forecast_sum){(int64_t)INT32_MIN - 1, {0}, 0}, JP_ERR_OVERFLOW, INT32_MIN, 0);
    expect_total((struct jp_forecast_sum){0, {0}, ((uint64_t)1 << 46) + 1}, JP_ERR_OVERFLOW, 0, INT32_MAX);
    expect_total((struct jp_forecast_sum){0, {0, most, 0, 0}, 0}, JP_OK, 0, JP_Q16(8192));
    expect_total((struct jp_forecast_sum){0, {most, most, -most, most}, 0}, JP_OK, 0, JP_Q16(16384));
    expect_total((struct jp_forecast_sum){0, {most + 1, 0, 0, 0}, 0}, JP_ERR_OVERFLOW, 0, INT32_MAX);
    expect_total((struct jp_forecast_sum){0, {0, 0, 0, -most - 1}, 0}, JP_ERR_OVERFLOW, 0, INT32_MAX);
}

static void test_a_reserve_is_the_forecast_and_its_margin(void)
{
    static const struct {
        double confidence, quantile;
    } known[] = {{0.5, 0},         {0.75, 0.674490},  {0.9, 1.281552},   {0.95, 1.644854},   {0.975, 1.959964},
                 {0.99, 2.326348}, {0.995, 2.575829}, {0.999, 3.090232}, {0.9998, 3.540084}, {0.9999, 3.719016}};
    const struct jp_forecast forecast = {JP_Q16(100), JP_Q16(10)};

    for (unsigned i = 0; i < sizeof known / sizeof known[0]; i++) {
        const jp_q31 confidence = (jp_q31)(known[i].confidence * 2147483648.0);
        jp_q16 spare = 0;

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_reserve(&forecast, JP_Q16(130), confidence, &spare));
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), (jp_q16)((30 - 10 * known[i].quantile) * JP_Q16_ONE), spare);
    }
}

static void test_a_reserve_saturates_and_refuses(void)
{
    const struct jp_forecast most = {INT32_MAX, INT32_MAX};
    const struct jp_forecast least = {INT32_MIN, 0};
    jp_q16 spare = 7;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_reserve(&most, 0, JP_PROBABILITY_MIN - 1, &spare));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_reserve(&most, 0, JP_PROBABILITY_MAX + 1, &spare));
    TEST_ASSERT_EQUAL_INT32(7, spare);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_reserve(&most, INT32_MIN, JP_PROBABILITY_MAX, &spare));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, spare);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_reserve(&least, INT32_MAX, JP_PROBABILITY_MAX, &spare));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, spare);
}

static void test_quantiles_rise(void)
{
    jp_q16 before = -1;

    for (int64_t p = JP_PROBABILITY_MIN; p <= JP_PROBABILITY_MAX; p += 65521) {
        const jp_q16 quantile = jp_normal_quantile((jp_q31)p);

        TEST_ASSERT_TRUE(quantile >= before);
        before = quantile;
    }
}
