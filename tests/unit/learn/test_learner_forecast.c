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

/* Of sixteen segments that turn to and fro. */
static struct jp_forecast mission_forecast(const struct jp_learner *robot)
{
    struct jp_forecast_sum sum = {0, {0}, 0};
    struct jp_energy_start from = {.motion = {0, 0}};
    struct jp_forecast forecast;

    for (unsigned i = 0; i < 16U; i++) {
        const struct jp_segment_command segment = {
            {JP_Q24(0.5), 0}, i % 2U == 0U ? JP_Q24(0.3) : -JP_Q24(0.3), JP_Q16(6)};

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_add(robot, &sum, &from, &segment));
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_total(robot, &sum, &forecast));
    return forecast;
}

/* What a new robot believes is as wide as robots of its kind differ: the ground under gao2018 is 0.6 to 1.6 times as
 * rough as in its file. One segment of six seconds tells most of it, and no more than that before it has driven. */
static void test_the_first_segment_tells_most_of_what_a_new_robot_does_not_know(void)
{
    const struct jp_segment_command segment = {{JP_Q24(0.5), 0}, JP_Q24(0.3), JP_Q16(6)};
    const struct jp_energy_start from = {.motion = {0, 0}};
    struct jp_energy_start end;
    struct jp_learner robot;
    enum jp_learned learned;
    jp_q16 energy;

    jp_learner_start(&robot, &jp_learning_gao2018, &jp_energy_model_gao2018, &jp_horizon_gao2018);
    const struct jp_forecast first = mission_forecast(&robot);

    TEST_ASSERT_EQUAL_INT(
        JP_OK, jp_energy_forecast(&jp_energy_model_gao2018, &jp_horizon_gao2018, &from, &segment, &energy, &end));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learner_update(&robot, &from, &segment, energy, &learned));
    const struct jp_forecast second = mission_forecast(&robot);

    TEST_ASSERT_TRUE(first.deviation > first.energy / 7 && first.deviation < first.energy / 4);
    TEST_ASSERT_TRUE(second.deviation < first.deviation / 3);
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

/* A margin is rounded up: of a bit and of two. */
static void test_a_margin_is_no_less_than_it_is(void)
{
    const jp_q31 confidence = JP_PROBABILITY_MIN / 2 * 3; /* 0.674 of a deviation */
    const struct jp_forecast bit = {JP_Q16(1), 1};
    const struct jp_forecast two = {JP_Q16(1), 2};
    jp_q16 spare = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_reserve(&bit, JP_Q16(3), confidence, &spare));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(2) - 1, spare);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_reserve(&two, JP_Q16(3), confidence, &spare));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(2) - 2, spare);
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

/* P(left − way >= 0) by published quantiles, on either side of ½. */
static void test_what_is_left_suffices_with_a_probability(void)
{
    static const struct {
        jp_q16 quantile;
        jp_q31 probability;
    } known[] = {{0, 1 << 30},         {44204, 1610612736}, /* 0.75 */
                 {83987, 1932735283},                       /* 0.9 */
                 {107797, 2040109466},                      /* 0.95 */
                 {152461, 2126008812},                      /* 0.99 */
                 {202521, 2145336164}};                     /* 0.999 */

    for (unsigned i = 0; i < sizeof known / sizeof known[0]; i++) {
        /* 3 and 4 J make 5 J. */
        const struct jp_forecast left = {JP_Q16(500), JP_Q16(3)};
        const struct jp_forecast near = {JP_Q16(500) - 5 * known[i].quantile, JP_Q16(4)};
        const struct jp_forecast far = {JP_Q16(500) + 5 * known[i].quantile, JP_Q16(4)};
        jp_q31 probability = 0;

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_suffices(&left, &near, &probability));
        TEST_ASSERT_INT32_WITHIN(900000, known[i].probability, probability);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_suffices(&left, &far, &probability));
        TEST_ASSERT_INT32_WITHIN(900000, INT32_MAX - known[i].probability, probability);
    }
}

static jp_q31 probability_of(jp_q16 left, jp_q16 left_deviation, jp_q16 way, jp_q16 way_deviation)
{
    jp_q31 probability = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_suffices(&(struct jp_forecast){left, left_deviation},
                                                      &(struct jp_forecast){way, way_deviation}, &probability));
    return probability;
}

static void test_no_probability_is_beyond_what_a_forecast_can_say(void)
{
    const jp_q31 least = (jp_q31)(((uint32_t)1 << 31) - (uint32_t)JP_PROBABILITY_MAX);

    TEST_ASSERT_EQUAL_INT32(JP_PROBABILITY_MAX, probability_of(JP_Q16(9), 0, JP_Q16(9), 0));
    TEST_ASSERT_EQUAL_INT32(least, probability_of(JP_Q16(9) - 1, 0, JP_Q16(9), 0));
    TEST_ASSERT_EQUAL_INT32(JP_PROBABILITY_MAX, probability_of(INT32_MAX, 1, INT32_MIN, 0));
    TEST_ASSERT_EQUAL_INT32(least, probability_of(INT32_MIN, 0, INT32_MAX, 1));
    TEST_ASSERT_INT32_WITHIN(20000000, 1 << 30, probability_of(JP_Q16(1), INT32_MAX, 0, INT32_MAX));
}

/* The larger of two probabilities is that of more energy, whatever the deviations. */
static void test_more_energy_suffices_no_less(void)
{
    jp_q31 before = 0;

    for (jp_q16 left = 0; left < JP_Q16(200); left += 7919) {
        const jp_q31 now = probability_of(left, JP_Q16(7), JP_Q16(100), JP_Q16(20));

        TEST_ASSERT_TRUE(now >= before);
        before = now;
    }
}

/* What is spare at a confidence is so because the probability is at least that. */
static void test_a_probability_agrees_with_the_reserve(void)
{
    for (jp_q16 available = JP_Q16(60); available < JP_Q16(180); available += 4001) {
        const struct jp_forecast way = {JP_Q16(100), JP_Q16(17)};
        const jp_q31 probability = probability_of(available, 0, way.energy, way.deviation);

        for (int64_t confidence = JP_PROBABILITY_MIN; confidence <= JP_PROBABILITY_MAX; confidence += 40000003) {
            jp_q16 spare = 0;

            TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_reserve(&way, available, (jp_q31)confidence, &spare));
            TEST_ASSERT_EQUAL_INT(spare >= 0, probability >= confidence);
        }
    }
}

static void test_refuses_a_probability_of_nothing(void)
{
    const struct jp_forecast good = {JP_Q16(1), 0};
    const struct jp_forecast bad = {JP_Q16(1), -1};
    jp_q31 probability = 7;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_suffices(NULL, &good, &probability));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_suffices(&good, NULL, &probability));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_suffices(&good, &good, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_suffices(&bad, &good, &probability));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_suffices(&good, &bad, &probability));
    TEST_ASSERT_EQUAL_INT32(7, probability);
}
