/* Powers of one half: known values, whole powers, monotone, and where they end. */
#include "src/base/power_of_half.h"

#include "unity.h"

#define ONE    ((int32_t)1 << 30)
#define Q32(x) ((uint64_t)((x)*4294967296.0))

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_values(void)
{
    TEST_ASSERT_INT32_WITHIN(2, 759250125, jp_power_of_half(Q32(0.5)));
    TEST_ASSERT_INT32_WITHIN(2, 902905651, jp_power_of_half(Q32(0.25)));
    TEST_ASSERT_INT32_WITHIN(2, 638450708, jp_power_of_half(Q32(0.75)));
    TEST_ASSERT_INT32_WITHIN(2, 1001836547, jp_power_of_half(Q32(0.1)));
    TEST_ASSERT_INT32_WITHIN(2, 121670767, jp_power_of_half(Q32(3.141592653589793)));
}

static void test_whole_powers(void)
{
    for (unsigned i = 0; i <= 30; i++) {
        TEST_ASSERT_EQUAL_INT32(ONE >> i, jp_power_of_half((uint64_t)i << 32));
    }
}

static void test_beyond_thirty_halvings_nothing_is_left(void)
{
    TEST_ASSERT_EQUAL_INT32(0, jp_power_of_half(Q32(30.5)));
    TEST_ASSERT_EQUAL_INT32(0, jp_power_of_half((uint64_t)31 << 32));
    TEST_ASSERT_EQUAL_INT32(0, jp_power_of_half(UINT64_MAX));
}

static void test_falls_all_the_way(void)
{
    int32_t before = ONE;

    for (uint64_t x = 0; x < Q32(4); x += 12345679U) {
        const int32_t now = jp_power_of_half(x);

        TEST_ASSERT_LESS_OR_EQUAL_INT32(before, now);
        before = now;
    }
    TEST_ASSERT_INT32_WITHIN(ONE / 1000, ONE / 16, before);
}

/* 2^-x 2^-x = 2^-2x */
static void test_squares(void)
{
    for (uint64_t x = 0; x < Q32(2); x += 98765431U) {
        const int64_t root = jp_power_of_half(x);

        TEST_ASSERT_INT32_WITHIN(6, (int32_t)((root * root) >> 30), jp_power_of_half(2U * x));
    }
}
