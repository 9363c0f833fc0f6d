/* Edges of every operation of fixed.h, and one hash over all of them that must be equal on every core. */
#include <joulepath/fixed.h>

#include "unity.h"

#define EIGHTH  ((jp_angle)1 << 29)
#define QUARTER ((jp_angle)1 << 30)
#define HALF    ((jp_angle)1 << 31)

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_constants_round_to_nearest(void)
{
    TEST_ASSERT_EQUAL_INT32(65536, JP_Q16(1.0));
    TEST_ASSERT_EQUAL_INT32(-98304, JP_Q16(-1.5));
    TEST_ASSERT_EQUAL_INT32(6554, JP_Q16(0.1));
    TEST_ASSERT_EQUAL_INT32(-6554, JP_Q16(-0.1));
    TEST_ASSERT_EQUAL_INT32(JP_Q24_ONE, JP_Q24(1.0));
    TEST_ASSERT_EQUAL_UINT32(QUARTER, JP_ANGLE_DEGREES(90));
    TEST_ASSERT_EQUAL_UINT32(0u - QUARTER, JP_ANGLE_DEGREES(-90));
    TEST_ASSERT_EQUAL_UINT32(HALF, JP_ANGLE_DEGREES(180));
}

static void test_saturate_and_clamp(void)
{
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_saturate32((int64_t)INT32_MAX + 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_saturate32(INT64_MAX));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_saturate32(INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_saturate32(INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_saturate32((int64_t)INT32_MIN - 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_saturate32(INT64_MIN));
    TEST_ASSERT_EQUAL_INT32(-1, jp_saturate32(-1));
    TEST_ASSERT_EQUAL_INT32(-3, jp_clamp32(-4, -3, 5));
    TEST_ASSERT_EQUAL_INT32(5, jp_clamp32(6, -3, 5));
    TEST_ASSERT_EQUAL_INT32(0, jp_clamp32(0, -3, 5));
    TEST_ASSERT_EQUAL_INT32(7, jp_clamp32(INT32_MIN, 7, 7));
    TEST_ASSERT_EQUAL_INT32((1 << 30) - 1, jp_saturate_bits(1 << 30, 31));
    TEST_ASSERT_EQUAL_INT32((1 << 30) - 1, jp_saturate_bits(INT32_MAX, 31));
    TEST_ASSERT_EQUAL_INT32(-(1 << 30), jp_saturate_bits(INT32_MIN, 31));
    TEST_ASSERT_EQUAL_INT32(-(1 << 30), jp_saturate_bits(-(1 << 30), 31));
    TEST_ASSERT_EQUAL_INT32(1, jp_saturate_bits(5, 2));
    TEST_ASSERT_EQUAL_INT32(-2, jp_saturate_bits(-5, 2));
    TEST_ASSERT_EQUAL_INT32(-1, jp_saturate_bits(-1, 2));
}

static void test_add_and_sub_saturate(void)
{
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_add(INT32_MAX, 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_add(INT32_MAX, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_add(INT32_MIN, -1));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_add(INT32_MIN, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(-1, jp_add(INT32_MAX, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_add(INT32_MAX - 1, 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_sub(0, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_sub(-1, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_sub(-2, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_sub(-1, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(0, jp_sub(INT32_MIN, INT32_MIN));
}

/** As jp_multiply_shift, over the whole range of both. */
static void test_shares(void)
{
    static const int32_t numbers[] = {INT32_MIN + 1, -JP_Q24_ONE, -3, -1, 0, 1, 2, 5, 0x12345678, INT32_MAX};
    static const int32_t shares[] = {-JP_Q24_ONE, 1 - JP_Q24_ONE, -7, -1, 0, 1, 12345678, JP_Q24_ONE - 1, JP_Q24_ONE};

    for (unsigned i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        for (unsigned j = 0; j < sizeof shares / sizeof shares[0]; j++) {
            TEST_ASSERT_EQUAL_INT32(jp_multiply_shift(numbers[i], shares[j], 24), jp_share(numbers[i], shares[j], 24));
        }
    }
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_share(INT32_MIN, JP_Q24_ONE, 24));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX - 1, jp_share(INT32_MAX, INT32_MAX, 31));
    TEST_ASSERT_EQUAL_INT32(-INT32_MAX, jp_share(INT32_MAX, INT32_MIN, 31));
}

static void test_multiply_rounds_ties_up(void)
{
    TEST_ASSERT_EQUAL_INT32(1, jp_multiply_shift(1, 1, 1));
    TEST_ASSERT_EQUAL_INT32(0, jp_multiply_shift(-1, 1, 1));
    TEST_ASSERT_EQUAL_INT32(2, jp_multiply_shift(3, 1, 1));
    TEST_ASSERT_EQUAL_INT32(-1, jp_multiply_shift(-3, 1, 1));
    TEST_ASSERT_EQUAL_INT32(1, jp_multiply_shift(7, 1, 3));
    TEST_ASSERT_EQUAL_INT32(0, jp_multiply_shift(3, 1, 3));
    TEST_ASSERT_EQUAL_INT32(1, jp_multiply_shift(INT32_MIN, INT32_MIN, 62));
    TEST_ASSERT_EQUAL_INT32(0, jp_multiply_shift(INT32_MIN, 1, 62));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_multiply_shift(INT32_MIN, INT32_MIN, 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_multiply_shift(INT32_MIN, INT32_MAX, 1));
}

static void test_multiply_formats(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_Q16(-3.75), jp_q16_multiply(JP_Q16(1.5), JP_Q16(-2.5)));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_q16_multiply(JP_Q16(300), JP_Q16(300)));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_q16_multiply(JP_Q16(-300), JP_Q16(300)));
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.25), jp_q24_multiply(JP_Q24(0.5), JP_Q24(0.5)));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_q24_multiply(INT32_MIN, JP_Q24_ONE));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_q24_multiply(INT32_MIN, -JP_Q24_ONE));
    TEST_ASSERT_EQUAL_INT32(JP_Q31_MAX, jp_q31_multiply(INT32_MIN, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(-JP_Q31_MAX, jp_q31_multiply(INT32_MIN, JP_Q31_MAX));
    TEST_ASSERT_EQUAL_INT32(JP_Q31_MAX - 1, jp_q31_multiply(JP_Q31_MAX, JP_Q31_MAX));
}

static void test_multiply_accumulate_saturates(void)
{
    const int64_t largest = (int64_t)1 << 62; /* (−2³¹)² */
    TEST_ASSERT_TRUE(jp_multiply_accumulate(5, -3, 7) == -16);
    TEST_ASSERT_TRUE(jp_multiply_accumulate(INT64_MAX, 1, 1) == INT64_MAX);
    TEST_ASSERT_TRUE(jp_multiply_accumulate(INT64_MAX - 1, 1, 1) == INT64_MAX);
    TEST_ASSERT_TRUE(jp_multiply_accumulate(INT64_MIN, -1, 1) == INT64_MIN);
    TEST_ASSERT_TRUE(jp_multiply_accumulate(INT64_MIN + 1, -1, 1) == INT64_MIN);
    TEST_ASSERT_TRUE(jp_multiply_accumulate(INT64_MIN, 0, 1) == INT64_MIN);
    TEST_ASSERT_TRUE(jp_multiply_accumulate(largest, INT32_MIN, INT32_MIN) == INT64_MAX);
    TEST_ASSERT_TRUE(jp_multiply_accumulate(largest - 1, INT32_MIN, INT32_MIN) == INT64_MAX);
    TEST_ASSERT_TRUE(jp_multiply_accumulate(INT64_MIN, INT32_MIN, INT32_MIN) == -largest);
}

static void test_round_shift(void)
{
    TEST_ASSERT_EQUAL_INT32(1, jp_round_shift(1, 1));
    TEST_ASSERT_EQUAL_INT32(0, jp_round_shift(-1, 1));
    TEST_ASSERT_EQUAL_INT32(-1, jp_round_shift(-2, 1));
    TEST_ASSERT_EQUAL_INT32(-1, jp_round_shift(-3, 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_round_shift(INT64_MAX, 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_round_shift(INT64_MIN, 1));
    TEST_ASSERT_EQUAL_INT32(2, jp_round_shift(INT64_MAX, 62));
    TEST_ASSERT_EQUAL_INT32(-2, jp_round_shift(INT64_MIN, 62));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_round_shift(((int64_t)INT32_MAX << 8) + 127, 8));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_round_shift(((int64_t)INT32_MAX << 8) + 128, 8));
}

static void test_divide_rounds_ties_away_from_zero(void)
{
    TEST_ASSERT_EQUAL_INT32(4, jp_divide(7, 2));
    TEST_ASSERT_EQUAL_INT32(-4, jp_divide(-7, 2));
    TEST_ASSERT_EQUAL_INT32(-4, jp_divide(7, -2));
    TEST_ASSERT_EQUAL_INT32(4, jp_divide(-7, -2));
    TEST_ASSERT_EQUAL_INT32(2, jp_divide(7, 3));
    TEST_ASSERT_EQUAL_INT32(3, jp_divide(8, 3));
    TEST_ASSERT_EQUAL_INT32(0, jp_divide(1, 3));
    TEST_ASSERT_EQUAL_INT32(1, jp_divide(1, 1));
    TEST_ASSERT_EQUAL_INT32(-1, jp_divide(INT32_MAX, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(-1, jp_divide(((int64_t)1 << 30), INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(0, jp_divide(((int64_t)1 << 30) - 1, INT32_MIN));
}

static void test_divide_saturates(void)
{
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_divide(1, 0));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_divide(-1, 0));
    TEST_ASSERT_EQUAL_INT32(0, jp_divide(0, 0));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_divide(INT64_MIN, 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_divide(INT64_MIN, -1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_divide(INT64_MIN, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_divide(INT64_MAX, -1));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_divide(INT32_MIN, 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_divide(INT32_MIN, -1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_divide(INT32_MAX, 1));
    TEST_ASSERT_EQUAL_INT32(-INT32_MAX, jp_divide(INT32_MAX, -1));
}

static void test_divide_formats(void)
{
    TEST_ASSERT_EQUAL_INT32(21845, jp_q16_divide(JP_Q16(1), JP_Q16(3)));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_q16_divide(INT32_MIN, JP_Q16(0.5)));
    TEST_ASSERT_EQUAL_INT32(JP_Q24(-2), jp_q24_divide(JP_Q24(1), JP_Q24(-0.5)));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_q24_divide(JP_Q24(1), 0));
    TEST_ASSERT_EQUAL_INT32(JP_Q31_MAX, jp_q31_divide(INT32_MIN, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_q31_divide(5, -5));
    TEST_ASSERT_EQUAL_INT32((int32_t)1 << 30, jp_q31_divide(5, 10));
}

static void test_square_root_is_the_floor(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, jp_square_root(0));
    TEST_ASSERT_EQUAL_UINT32(1, jp_square_root(1));
    TEST_ASSERT_EQUAL_UINT32(1, jp_square_root(3));
    TEST_ASSERT_EQUAL_UINT32(2, jp_square_root(4));
    TEST_ASSERT_EQUAL_UINT32(65535, jp_square_root(UINT32_MAX));
    TEST_ASSERT_EQUAL_UINT32(65536, jp_square_root((uint64_t)UINT32_MAX + 1));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, jp_square_root(UINT64_MAX));
    const uint64_t largest_square = (uint64_t)UINT32_MAX * UINT32_MAX;
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, jp_square_root(largest_square));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX - 1, jp_square_root(largest_square - 1));
}

static void test_q16_square_root(void)
{
    TEST_ASSERT_EQUAL_INT32(0, jp_q16_square_root(0));
    TEST_ASSERT_EQUAL_INT32(0, jp_q16_square_root(-1));
    TEST_ASSERT_EQUAL_INT32(0, jp_q16_square_root(INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(256, jp_q16_square_root(1));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(1.5), jp_q16_square_root(JP_Q16(2.25)));
    TEST_ASSERT_EQUAL_INT32(92682, jp_q16_square_root(JP_Q16(2)));  /* 92681.9 */
    TEST_ASSERT_EQUAL_INT32(113512, jp_q16_square_root(JP_Q16(3))); /* 113511.7 */
    TEST_ASSERT_EQUAL_INT32(65535, jp_q16_square_root(65535));      /* 65535.499998 */
    TEST_ASSERT_EQUAL_INT32(65536, jp_q16_square_root(65537));      /* 65536.499998 */
    TEST_ASSERT_EQUAL_INT32(11863283, jp_q16_square_root(INT32_MAX));
}

static void test_sine_is_exact_at_the_quarter_turns(void)
{
    TEST_ASSERT_EQUAL_INT32(0, jp_sin(0));
    TEST_ASSERT_EQUAL_INT32(JP_Q31_MAX, jp_sin(QUARTER));
    TEST_ASSERT_EQUAL_INT32(0, jp_sin(HALF));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_sin(0u - QUARTER));
    TEST_ASSERT_EQUAL_INT32(JP_Q31_MAX, jp_cos(0));
    TEST_ASSERT_EQUAL_INT32(0, jp_cos(QUARTER));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_cos(HALF));
    TEST_ASSERT_EQUAL_INT32(0, jp_cos(0u - QUARTER));
}

static void test_sine_at_known_angles(void)
{
    TEST_ASSERT_INT32_WITHIN(JP_SIN_ERROR_ULP, 1518500250, jp_sin(EIGHTH));
    TEST_ASSERT_INT32_WITHIN(JP_SIN_ERROR_ULP, -1518500250, jp_sin(HALF + EIGHTH));
    TEST_ASSERT_INT32_WITHIN(JP_SIN_ERROR_ULP, -1518500250, jp_cos(HALF - EIGHTH));
    TEST_ASSERT_INT32_WITHIN(JP_SIN_ERROR_ULP, 3, jp_sin(1));
    TEST_ASSERT_INT32_WITHIN(JP_SIN_ERROR_ULP, -3, jp_sin(UINT32_MAX));
    TEST_ASSERT_INT32_WITHIN(JP_SIN_ERROR_ULP, (int32_t)1 << 30, jp_sin(JP_ANGLE_DEGREES(30)));
}

static void test_sine_saturates_beside_the_peaks(void)
{
    for (uint32_t offset = 0; offset < 64; offset++) {
        TEST_ASSERT_INT32_WITHIN(JP_SIN_ERROR_ULP, JP_Q31_MAX, jp_sin(QUARTER + offset));
        TEST_ASSERT_INT32_WITHIN(JP_SIN_ERROR_ULP, JP_Q31_MAX, jp_sin(QUARTER - offset));
        TEST_ASSERT_INT32_WITHIN(JP_SIN_ERROR_ULP, INT32_MIN + JP_SIN_ERROR_ULP, jp_sin(0u - QUARTER + offset));
        TEST_ASSERT_INT32_WITHIN(JP_SIN_ERROR_ULP, INT32_MIN + JP_SIN_ERROR_ULP, jp_sin(0u - QUARTER - offset));
    }
}

static void test_atan2_is_exact_at_the_eighth_turns(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, jp_atan2(0, 0));
    TEST_ASSERT_EQUAL_UINT32(0, jp_atan2(0, 1));
    TEST_ASSERT_EQUAL_UINT32(EIGHTH, jp_atan2(7, 7));
    TEST_ASSERT_EQUAL_UINT32(QUARTER, jp_atan2(INT32_MAX, 0));
    TEST_ASSERT_EQUAL_UINT32(3 * EIGHTH, jp_atan2(1, -1));
    TEST_ASSERT_EQUAL_UINT32(HALF, jp_atan2(0, INT32_MIN));
    TEST_ASSERT_EQUAL_UINT32(5 * EIGHTH, jp_atan2(INT32_MIN, INT32_MIN));
    TEST_ASSERT_EQUAL_UINT32(6 * EIGHTH, jp_atan2(INT32_MIN, 0));
    TEST_ASSERT_EQUAL_UINT32(7 * EIGHTH, jp_atan2(-INT32_MAX, INT32_MAX));
}

static void test_atan2_at_known_directions(void)
{
    const jp_angle half_slope = 316933406; /* atan(1/2) */
    TEST_ASSERT_UINT32_WITHIN(JP_ATAN2_ERROR, half_slope, jp_atan2(1, 2));
    TEST_ASSERT_UINT32_WITHIN(JP_ATAN2_ERROR, half_slope, jp_atan2(1000000000, 2000000000));
    TEST_ASSERT_UINT32_WITHIN(JP_ATAN2_ERROR, QUARTER - half_slope, jp_atan2(2, 1));
    TEST_ASSERT_UINT32_WITHIN(JP_ATAN2_ERROR, HALF - half_slope, jp_atan2(1, -2));
    TEST_ASSERT_UINT32_WITHIN(JP_ATAN2_ERROR, HALF + half_slope, jp_atan2(-1, -2));
    TEST_ASSERT_UINT32_WITHIN(JP_ATAN2_ERROR, 0u - half_slope, jp_atan2(-1, 2));
    TEST_ASSERT_UINT32_WITHIN(JP_ATAN2_ERROR, EIGHTH, jp_atan2(INT32_MAX - 1, INT32_MAX));
}

static void test_radians(void)
{
    const jp_q24 pi = 52707179; /* 52707178.5 */
    TEST_ASSERT_EQUAL_INT32(0, jp_angle_to_radians(0));
    TEST_ASSERT_EQUAL_INT32(pi, jp_angle_to_radians(HALF));
    TEST_ASSERT_EQUAL_INT32(-pi, jp_angle_to_radians(HALF + 1));
    TEST_ASSERT_EQUAL_INT32(26353589, jp_angle_to_radians(QUARTER));
    TEST_ASSERT_EQUAL_INT32(-26353589, jp_angle_to_radians(0u - QUARTER));
    TEST_ASSERT_EQUAL_UINT32(0, jp_angle_from_radians(0));
    TEST_ASSERT_UINT32_WITHIN(1, 683565276u, jp_angle_from_radians(JP_Q24_ONE));
    TEST_ASSERT_UINT32_WITHIN(1, 0u - 683565276u, jp_angle_from_radians(-JP_Q24_ONE));
    TEST_ASSERT_UINT32_WITHIN(1, 2697957942u, jp_angle_from_radians(INT32_MIN));
}

static void test_long_product_is_exact(void)
{
    static const int32_t edges[] = {INT32_MIN, INT32_MIN + 1, -65537, -65536, -65535, -1,        0,
                                    1,         65535,         65536,  65537,  98765,  INT32_MAX, 0x7FFF0000};
    const size_t count = sizeof edges / sizeof edges[0];

    for (size_t i = 0; i < count; i++) {
        for (size_t j = 0; j < count; j++) {
            TEST_ASSERT_EQUAL_INT64((int64_t)edges[i] * edges[j], jp_multiply(edges[i], edges[j]));
        }
    }
    for (uint32_t i = 0; i < 2000; i++) {
        const int32_t a = (int32_t)(i * 2654435761U);
        const int32_t b = (int32_t)(i * 2246822519U ^ (i << 16));

        TEST_ASSERT_EQUAL_INT64((int64_t)a * b, jp_multiply(a, b));
    }
}

static void test_phase_per_rate_is_rounded(void)
{
    for (uint32_t rate = 2; rate <= 10000; rate++) {
        TEST_ASSERT_EQUAL_INT32((((uint64_t)1 << 32) + rate / 2U) / rate, jp_phase_per_rate(rate));
    }
    TEST_ASSERT_EQUAL_INT32(2, jp_phase_per_rate((uint32_t)1 << 31));
}

static void test_phase_steps_both_ways(void)
{
    TEST_ASSERT_EQUAL_UINT64(JP_PHASE_TURN, jp_phase_step(JP_Q24_ONE, 1 << 16) << 16);
    TEST_ASSERT_EQUAL_UINT64((jp_phase)0 - 3 * (jp_phase)JP_Q24_ONE, jp_phase_step(-JP_Q24_ONE, 3));
    TEST_ASSERT_EQUAL_UINT64((jp_phase)0 - ((jp_phase)1 << 62),
                             jp_phase_step(INT32_MIN, INT32_MAX) - ((jp_phase)1 << 31));
}

static void test_angles_and_phases_wrap(void)
{
    const jp_angle before = UINT32_MAX - 9;
    const jp_angle after = before + 25;
    TEST_ASSERT_EQUAL_INT32(25, (int32_t)(after - before));
    TEST_ASSERT_EQUAL_INT32(-25, (int32_t)(before - after));
    const jp_phase start = UINT64_MAX - 4;
    const jp_phase end = start + 3 * JP_PHASE_TURN;
    TEST_ASSERT_EQUAL_INT32(3 * JP_Q24_ONE, jp_phase_difference(end, start));
    TEST_ASSERT_EQUAL_INT32(-3 * JP_Q24_ONE, jp_phase_difference(start, end));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_phase_difference(start + INT64_MAX, start));
    TEST_ASSERT_EQUAL_INT32(0, jp_phase_difference(((jp_phase)1 << 32) - 1, 0));
    TEST_ASSERT_EQUAL_INT32(-1, jp_phase_difference(0, 1));
    TEST_ASSERT_EQUAL_UINT32(QUARTER, jp_phase_angle(5 * JP_PHASE_TURN + JP_PHASE_TURN / 4));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, jp_phase_angle(start));
}

static uint32_t random32(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state ^ (*state >> 16);
}

/** Random bits with a random magnitude, so that small numbers and saturation both occur. */
static int32_t random_int32(uint32_t *state)
{
    unsigned shift = random32(state) >> 27;
    return (int32_t)random32(state) >> shift;
}

static uint32_t mix(uint32_t hash, uint32_t value)
{
    return (hash ^ value) * 16777619u;
}

static uint32_t hash_arithmetic(uint32_t hash, int32_t a, int32_t b, int64_t wide, unsigned shift)
{
    hash = mix(hash, (uint32_t)jp_saturate32(wide));
    hash = mix(hash, (uint32_t)jp_add(a, b));
    hash = mix(hash, (uint32_t)jp_sub(a, b));
    hash = mix(hash, (uint32_t)jp_multiply_shift(a, b, shift));
    hash = mix(hash, (uint32_t)jp_q16_multiply(a, b));
    hash = mix(hash, (uint32_t)jp_q24_multiply(a, b));
    hash = mix(hash, (uint32_t)jp_q31_multiply(a, b));
    uint64_t sum = (uint64_t)jp_multiply_accumulate(wide, a, b);
    hash = mix(mix(hash, (uint32_t)sum), (uint32_t)(sum >> 32));
    return mix(hash, (uint32_t)jp_round_shift(wide, shift));
}

static uint32_t hash_functions(uint32_t hash, int32_t a, int32_t b, int64_t wide)
{
    hash = mix(hash, (uint32_t)jp_divide(wide, a));
    hash = mix(hash, (uint32_t)jp_q16_divide(a, b));
    hash = mix(hash, (uint32_t)jp_q24_divide(a, b));
    hash = mix(hash, (uint32_t)jp_q31_divide(a, b));
    hash = mix(hash, jp_square_root((uint64_t)wide));
    hash = mix(hash, (uint32_t)jp_q16_square_root(a));
    hash = mix(hash, (uint32_t)jp_sin((jp_angle)a));
    hash = mix(hash, (uint32_t)jp_cos((jp_angle)a));
    hash = mix(hash, jp_atan2(a, b));
    hash = mix(hash, jp_angle_from_radians(a));
    return mix(hash, (uint32_t)jp_angle_to_radians((jp_angle)a));
}

static void test_same_bits_on_every_core(void)
{
    uint32_t state = 1;
    uint32_t hash = 2166136261u;
    for (int i = 0; i < 2000; i++) {
        int32_t a = random_int32(&state);
        int32_t b = random_int32(&state);
        uint64_t bits = ((uint64_t)(uint32_t)a << 32) | random32(&state);
        int64_t wide = (int64_t)bits >> (random32(&state) >> 26);
        unsigned shift = 1 + random32(&state) % 62;
        hash = hash_arithmetic(hash, a, b, wide, shift);
        hash = hash_functions(hash, a, b, wide);
    }
    TEST_ASSERT_EQUAL_HEX32(0x707CF847u, hash);
}
