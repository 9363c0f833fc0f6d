/* Quantiles of the normal distribution against its integral, which is summed up here. */
#include "src/learn/normal_quantile.h"

#include "unity.h"

#define INVERSE_ROOT_OF_TWO_PI 0.39894228040143268

/* Entries of the table an octave of the tail, and the last of them within range. */
enum { STEPS = 8, OCTAVES = 13 };

void setUp(void)
{
}

void tearDown(void)
{
}

/* e^(-x), x >= 0: all terms of its inverse are positive. */
static double falling(double x)
{
    double sum = 1.0;
    double term = 1.0;

    for (int n = 1; n < 60; n++) {
        term *= x / n;
        sum += term;
    }
    return 1.0 / sum;
}

/* The probability of more than z standard deviations, z >= 0. */
static double tail_of(double z)
{
    double sum = z;
    double term = z;

    for (int n = 1; n < 80; n++) {
        term *= z * z / (2 * n + 1);
        sum += term;
    }
    return 0.5 - INVERSE_ROOT_OF_TWO_PI * falling(z * z / 2) * sum;
}

/* A tail of (8 + j)/16 by 2^-octave, Q31. */
static uint32_t tail_at(int octave, int j)
{
    return ((uint32_t)(STEPS + j) << (31 - 4)) >> octave;
}

static jp_q16 quantile_at(uint32_t tail)
{
    return jp_normal_quantile((jp_q31)((1U << 31) - tail));
}

/* Where tails are a few bits long it is rounded to 2^-14. */
static void test_a_quantile_is_the_nearest_where_it_is_known(void)
{
    for (int octave = 1; octave <= OCTAVES; octave++) {
        for (int j = octave == 1 ? STEPS - 1 : STEPS; j > 0; j--) {
            const uint32_t tail = tail_at(octave, j);

            if (tail < (1U << 31) - (uint32_t)JP_PROBABILITY_MAX) {
                return;
            }
            const jp_q16 quantile = quantile_at(tail);

            TEST_ASSERT_EQUAL_INT32(0, quantile % 4);
            TEST_ASSERT_TRUE(tail_of((quantile - 2.001) / 65536) >= tail * 0x1p-31);
            TEST_ASSERT_TRUE(tail_of((quantile + 2.001) / 65536) <= tail * 0x1p-31);
        }
    }
}

static void test_a_quantile_is_within_a_thousandth_everywhere(void)
{
    for (uint32_t tail = (1U << 31) - (uint32_t)JP_PROBABILITY_MAX; tail <= 1U << 30; tail += 1U + tail / 37U) {
        const jp_q16 quantile = quantile_at(tail);

        TEST_ASSERT_TRUE(tail_of(quantile / 65536.0 - 0.001) >= tail * 0x1p-31);
        TEST_ASSERT_TRUE(tail_of(quantile / 65536.0 + 0.001) <= tail * 0x1p-31);
    }
}

static void test_even_odds_are_no_deviation(void)
{
    TEST_ASSERT_EQUAL_INT32(0, jp_normal_quantile(JP_PROBABILITY_MIN));
    TEST_ASSERT_EQUAL_INT32(JP_PROBABILITY_MIN, jp_normal_probability(0));
}

/* The largest probability whose quantile is not above it; of what is below the mean, the rest. */
static void test_a_probability_is_the_largest_of_its_quantile(void)
{
    for (jp_q16 deviations = 1; deviations < JP_Q16(3.7); deviations += 1 + deviations / 5) {
        const jp_q31 probability = jp_normal_probability(deviations);

        TEST_ASSERT_TRUE(jp_normal_quantile(probability) <= deviations);
        TEST_ASSERT_TRUE(jp_normal_quantile(probability + 1) > deviations);
        TEST_ASSERT_EQUAL_UINT32(1U << 31, (uint32_t)probability + (uint32_t)jp_normal_probability(-deviations));
    }
}

static void test_probabilities_end_at_the_greatest(void)
{
    const jp_q16 most = jp_normal_quantile(JP_PROBABILITY_MAX);

    TEST_ASSERT_EQUAL_INT32(JP_PROBABILITY_MAX, jp_normal_probability(most));
    TEST_ASSERT_TRUE(jp_normal_probability(most - 1) < JP_PROBABILITY_MAX);
    TEST_ASSERT_EQUAL_INT32(JP_PROBABILITY_MAX, jp_normal_probability(INT32_MAX));
    TEST_ASSERT_EQUAL_UINT32((1U << 31) - (uint32_t)JP_PROBABILITY_MAX, (uint32_t)jp_normal_probability(INT32_MIN));
}
