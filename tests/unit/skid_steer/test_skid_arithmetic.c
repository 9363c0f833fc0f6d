/* The arithmetic of the odometry's parts at its limits. */
#include "src/skid_steer/skid_arithmetic.h"
#include "unity.h"

#define QUOTIENT_MAX ((int64_t)1 << 24)

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_a_quotient_is_limited_so_that_its_square_fits(void)
{
    TEST_ASSERT_EQUAL_INT64(0, jp_skid_over(0, 16, 3));
    TEST_ASSERT_EQUAL_INT64(21845, jp_skid_over(1, 16, 3));
    TEST_ASSERT_EQUAL_INT64(QUOTIENT_MAX - 1, jp_skid_over((1 << 24) - 1, 0, 1));
    TEST_ASSERT_EQUAL_INT64(QUOTIENT_MAX, jp_skid_over(1 << 24, 0, 1));
    TEST_ASSERT_EQUAL_INT64(QUOTIENT_MAX, jp_skid_over((1 << 24) + 1, 0, 1));
    TEST_ASSERT_EQUAL_INT64(QUOTIENT_MAX, jp_skid_over(INT32_MAX, 16, 1));
}

static void test_a_variance_is_kept_where_its_reciprocal_is_precise(void)
{
    TEST_ASSERT_EQUAL_INT64(JP_SKID_VARIANCE_MIN, jp_skid_variance(0, INT32_MAX));
    TEST_ASSERT_EQUAL_INT64(JP_SKID_VARIANCE_MIN, jp_skid_variance(JP_SKID_VARIANCE_MIN - 1, INT32_MAX));
    TEST_ASSERT_EQUAL_INT64(JP_SKID_VARIANCE_MIN + 1, jp_skid_variance(JP_SKID_VARIANCE_MIN + 1, INT32_MAX));
    TEST_ASSERT_EQUAL_INT64(INT32_MAX, jp_skid_variance(INT32_MAX, INT32_MAX));
    TEST_ASSERT_EQUAL_INT64(INT32_MAX, jp_skid_variance((int64_t)INT32_MAX + 1, INT32_MAX));
    TEST_ASSERT_EQUAL_INT64((int64_t)1 << 16, JP_SKID_VARIANCE_MIN);
    TEST_ASSERT_EQUAL_INT64((int64_t)1 << 45, JP_SKID_VARIANCE_MAX);
}

static void test_sizes_saturate(void)
{
    TEST_ASSERT_EQUAL_INT32(0, jp_skid_size(0));
    TEST_ASSERT_EQUAL_INT32(1, jp_skid_size(1));
    TEST_ASSERT_EQUAL_INT32(1, jp_skid_size(-1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_skid_size(INT32_MIN));
}

static void test_the_lesser_of_two_and_at_least_one(void)
{
    TEST_ASSERT_EQUAL_INT32(-2, jp_skid_lesser(-2, 3));
    TEST_ASSERT_EQUAL_INT32(-2, jp_skid_lesser(3, -2));
    TEST_ASSERT_EQUAL_INT32(1, jp_skid_at_least_one(-5));
    TEST_ASSERT_EQUAL_INT32(1, jp_skid_at_least_one(0));
    TEST_ASSERT_EQUAL_INT32(1, jp_skid_at_least_one(1));
    TEST_ASSERT_EQUAL_INT32(2, jp_skid_at_least_one(2));
}

static void test_shares_and_squares(void)
{
    TEST_ASSERT_EQUAL_INT32(-3, jp_skid_part(-6, JP_Q24(0.5)));
    TEST_ASSERT_EQUAL_INT32(100, jp_skid_part(100, JP_Q24_ONE));
    TEST_ASSERT_EQUAL_INT64((int64_t)1 << 60, jp_skid_square(-((int64_t)1 << 30)));
    TEST_ASSERT_EQUAL_INT32((int32_t)1 << 30, JP_SKID_ONE);
}
