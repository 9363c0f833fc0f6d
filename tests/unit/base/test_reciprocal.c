/* Quotients by one division. */
#include "src/base/reciprocal.h"

#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static jp_q24 share(int64_t x, int64_t of)
{
    const struct jp_reciprocal reciprocal = jp_reciprocal_of(of);

    return jp_share_of(x, &reciprocal);
}

static void test_shares_over_the_whole_range(void)
{
    for (unsigned bits = 16; bits < 48; bits++) {
        const int64_t of = ((int64_t)1 << bits) + ((int64_t)1 << (bits - 2U)); /* 1.25 · 2^bits */

        TEST_ASSERT_INT32_WITHIN(JP_Q24_ONE >> 14, JP_Q24_ONE, share(of, of));
        TEST_ASSERT_INT32_WITHIN(JP_Q24_ONE >> 15, -JP_Q24(0.5), share(-of / 2, of));
        TEST_ASSERT_EQUAL_INT32(0, share(0, of));
    }
}

static void test_powers_of_two_are_exact(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.75), share((int64_t)3 << 20, (int64_t)1 << 22));
    TEST_ASSERT_EQUAL_INT32(JP_Q24_ONE * 4, share((int64_t)1 << 18, 1 << 16));
}

static void test_large_shares_saturate(void)
{
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, share((int64_t)1 << 45, 1 << 16));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, share(-((int64_t)1 << 45), 1 << 16));
}
