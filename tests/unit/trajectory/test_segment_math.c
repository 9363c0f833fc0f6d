/* Fast arithmetic of the segment optimiser against exact integers of 64 bits. */
#include "src/trajectory/segment_math.h"

#include "tests/target/random.h"
#include "unity.h"

static uint32_t state;

void setUp(void)
{
    state = 23;
}

void tearDown(void)
{
}

/* Of any size, not 0. */
static uint32_t number(void)
{
    return (target_random(&state) | ((uint32_t)1 << 31)) >> (target_random(&state) % 32U);
}

static int32_t signed_number(void)
{
    const int32_t size = (int32_t)(number() >> 1);

    return target_random(&state) % 2U == 0U ? size : -size;
}

/* Rounded down: the product is from so many times the unit to less than one more. */
static void expect_product(int32_t a, int32_t b, int bits, int32_t found)
{
    const int64_t unit = (int64_t)1 << bits;
    const int64_t rest = (int64_t)a * b - (int64_t)found * unit;

    TEST_ASSERT_TRUE(rest >= 0 && rest < unit);
}

static void test_products_are_rounded_down(void)
{
    for (int i = 0; i < 2000; i++) {
        const int32_t a = signed_number() / 2;
        const int32_t b = signed_number() / 2;

        expect_product(a, b, 30, multiply30(a, b));
        expect_product(a, b, 31, multiply31(a, b));
        expect_product(a, b, 32, multiply32(a, b));
    }
}

/* By counting. */
static unsigned zeros_before(uint32_t a)
{
    unsigned zeros = 0;

    for (uint32_t bit = (uint32_t)1 << 31; (a & bit) == 0U; bit >>= 1) {
        zeros++;
    }
    return zeros;
}

/* a << zeros is 1…2 in Q31; its product with the result is 1 in Q61, to 2⁻²⁸. */
static void expect_reciprocal(uint32_t a)
{
    unsigned zeros;
    const uint32_t inverse = jp_reciprocal(a, &zeros);
    const uint64_t product = ((uint64_t)a << zeros) * inverse;
    const uint64_t one = (uint64_t)1 << 62;
    const uint64_t off = product < one ? one - product : product - one;

    TEST_ASSERT_EQUAL_UINT(zeros_before(a), zeros);
    TEST_ASSERT_EQUAL_UINT(zeros_before(a), jp_leading_zeros(a));
    TEST_ASSERT_TRUE(off <= one >> 28);
}

static void test_reciprocals(void)
{
    for (unsigned bit = 0; bit < 32U; bit++) {
        expect_reciprocal((uint32_t)1 << bit);
        expect_reciprocal(UINT32_MAX >> bit);
    }
    for (int i = 0; i < 3000; i++) {
        expect_reciprocal(number());
    }
}

/* a/b in Q30, to 2⁻²⁸. */
static void test_fractions(void)
{
    for (int i = 0; i < 3000; i++) {
        const uint32_t b = number();
        const uint32_t a = i % 8 == 0 ? b : i % 8 == 1 ? 0U : (uint32_t)(((uint64_t)b * target_random(&state)) >> 32);
        const int64_t exact = (int64_t)(((uint64_t)a << 30) / b);
        const int64_t off = jp_fraction30(a, b) - exact;

        TEST_ASSERT_TRUE(off >= -5 && off <= 5);
    }
}

/* a/b in Q31, no more than fits. */
static void test_quotients_saturate(void)
{
    for (int i = 0; i < 3000; i++) {
        const int32_t b = (int32_t)((number() >> 1) | 1U);
        const int32_t a = (int32_t)(number() >> 1);
        const uint64_t exact = ((uint64_t)(uint32_t)a << 31) / (uint32_t)b;
        const int64_t limited = exact > (uint64_t)INT32_MAX ? INT32_MAX : (int64_t)exact;
        const int64_t off = jp_quotient31(a, b) - limited;

        TEST_ASSERT_TRUE(off >= -10 && off <= 10);
    }
    TEST_ASSERT_EQUAL_INT32(0, jp_quotient31(0, 7));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_quotient31(7, 7));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_quotient31(8, 7));
}

/* At most 1 too large: the square of one less is no more. */
static void expect_root(uint32_t a)
{
    const uint64_t root = jp_square_root32(a);

    TEST_ASSERT_TRUE((root + 1U) * (root + 1U) > a);
    TEST_ASSERT_TRUE((root - 1U) * (root - 1U) <= a);
}

static void test_square_roots(void)
{
    for (unsigned bit = 0; bit < 32U; bit++) {
        expect_root((uint32_t)1 << bit);
        expect_root(UINT32_MAX >> bit);
    }
    for (uint32_t a = 1; a < 300U; a++) {
        expect_root(a);
        expect_root(a * a);
    }
    for (int i = 0; i < 3000; i++) {
        expect_root(number());
    }
}
