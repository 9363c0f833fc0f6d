/* Small arithmetic of integers: ends of ranges, the least numbers, ties. */
#include "src/base/integer.h"
#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_ranges_hold_their_ends(void)
{
    TEST_ASSERT_FALSE(jp_is_between(-6, -5, 7));
    TEST_ASSERT_TRUE(jp_is_between(-5, -5, 7));
    TEST_ASSERT_TRUE(jp_is_between(7, -5, 7));
    TEST_ASSERT_FALSE(jp_is_between(8, -5, 7));
    TEST_ASSERT_TRUE(jp_is_between(INT32_MIN, INT32_MIN, INT32_MAX));
}

static void test_beyond_a_limit_of_either_sign(void)
{
    TEST_ASSERT_FALSE(jp_is_beyond(7, 7));
    TEST_ASSERT_FALSE(jp_is_beyond(-7, 7));
    TEST_ASSERT_TRUE(jp_is_beyond(8, 7));
    TEST_ASSERT_TRUE(jp_is_beyond(-8, 7));
    TEST_ASSERT_FALSE(jp_is_beyond(0, 0));
    TEST_ASSERT_TRUE(jp_is_beyond(INT32_MIN, 0));
    TEST_ASSERT_FALSE(jp_is_beyond(-INT32_MAX, INT32_MAX));
    TEST_ASSERT_TRUE(jp_is_beyond(INT32_MIN, INT32_MAX));
}

static void test_magnitudes(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, jp_magnitude32(0));
    TEST_ASSERT_EQUAL_UINT32(INT32_MAX, jp_magnitude32(-INT32_MAX));
    TEST_ASSERT_EQUAL_UINT32((uint32_t)1 << 31, jp_magnitude32(INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_absolute32(-INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_absolute32(INT32_MAX));
    TEST_ASSERT_EQUAL_INT64(INT64_MAX, jp_absolute64(-INT64_MAX));
    TEST_ASSERT_EQUAL_INT64(INT64_MAX, jp_absolute64(INT64_MAX));
}

static void test_powers_of_two_of_either_sign(void)
{
    TEST_ASSERT_EQUAL_INT64(-40, jp_times_power(-5, 3));
    TEST_ASSERT_EQUAL_INT64(-5, jp_times_power(-5, 0));
    TEST_ASSERT_EQUAL_INT64(-2, jp_times_power(-5, -2));
    TEST_ASSERT_EQUAL_INT64(INT64_MIN, jp_times_power(-1, 62) * 2);
    TEST_ASSERT_EQUAL_INT64(1, jp_times_power((int64_t)1 << 62, -62));
}

static void test_ties_round_up(void)
{
    TEST_ASSERT_EQUAL_INT64(1, jp_round_shift64(1, 1));
    TEST_ASSERT_EQUAL_INT64(0, jp_round_shift64(-1, 1));
    TEST_ASSERT_EQUAL_INT64(-1, jp_round_shift64(-2, 1));
    TEST_ASSERT_EQUAL_INT64(1, jp_round_shift64(((int64_t)3 << 30) - 1, 31));
    TEST_ASSERT_EQUAL_INT64(2, jp_round_shift64((int64_t)3 << 30, 31));
    TEST_ASSERT_EQUAL_INT64(-1, jp_round_shift64(-((int64_t)3 << 30), 31));
}
