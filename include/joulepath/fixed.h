/**
 * Saturating fixed-point arithmetic.
 *
 * Every operation gives the same bits on every compiler and core, with and
 * without DSP instructions. Unless a comment says otherwise a function rounds
 * to nearest (ties toward +infinity), saturates instead of wrapping, has no
 * failure, runs in bounded time and may be called from an ISR.
 *
 * Worst-case error of each function, in units in the last place of its result,
 * is stated beside it; tests/unit/base/test_fixed.c and tests/property/ prove it.
 */
#ifndef JOULEPATH_FIXED_H
#define JOULEPATH_FIXED_H

#include <stdint.h>

#if defined(__ARM_FEATURE_DSP) && !defined(JP_NO_DSP)
#define JP_DSP 1
#include <arm_acle.h>
#else
#define JP_DSP 0
#endif

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__ARM_ARCH_ISA_THUMB) && __ARM_ARCH_ISA_THUMB == 1
#define JP_LONG_MULTIPLY 0
#else
#define JP_LONG_MULTIPLY 1
#endif

typedef int32_t jp_q16; /**< Q16.16: ±32 768, step 1.5e-5 */
typedef int32_t jp_q24; /**< Q8.24: ±128, step 6.0e-8 */
typedef int32_t jp_q31; /**< Q1.31: [−1, 1), step 4.7e-10 */

typedef jp_q24 jp_turns_per_s;   /**< Q8.24 turn/s: what sensors, estimator and references count in */
typedef jp_q24 jp_radians_per_s; /**< Q8.24 rad/s: what the energy model and its segments count in */

/** Wrapping binary angle: 2³² is one turn. Differences are exact for ever; cast one to int32_t for ±½ turn. */
typedef uint32_t jp_angle;

/** Wrapping count of turns: 2⁵⁶ is one turn, so differences up to ±128 turns are exact for ever. */
typedef uint64_t jp_phase;

#define JP_Q16_ONE    ((jp_q16)65536)
#define JP_Q24_ONE    ((jp_q24)16777216)
#define JP_Q31_MAX    INT32_MAX
#define JP_PHASE_TURN ((jp_phase)1 << 56)

/** Constant expressions from decimal literals; no floating point reaches the image. */
#define JP_Q16(x)           ((jp_q16)((x)*65536.0 + ((x) >= 0 ? 0.5 : -0.5)))
#define JP_Q24(x)           ((jp_q24)((x)*16777216.0 + ((x) >= 0 ? 0.5 : -0.5)))
#define JP_ANGLE_DEGREES(x) ((jp_angle)(int64_t)((x)*4294967296.0 / 360.0 + ((x) >= 0 ? 0.5 : -0.5)))

/** Nearest value of 32 bits. Exact inside the range. */
inline int32_t jp_saturate32(int64_t x)
{
    int32_t low = (int32_t)x;
    int32_t high = (int32_t)(x >> 32);

    /* It fits when the upper half repeats the sign of the lower. */
    if (high == (low < 0 ? -1 : 0)) {
        return low;
    }
    return high < 0 ? INT32_MIN : INT32_MAX;
}

/** a limited to [low, high]; low <= high. */
static inline int32_t jp_clamp32(int32_t a, int32_t low, int32_t high)
{
    int32_t at_least = a < low ? low : a;

    return at_least > high ? high : at_least;
}

/** a limited to `bits` bits, a constant of 2…31: −2^(bits − 1)…2^(bits − 1) − 1. One instruction (SSAT) where the core
 *  has it. */
#if JP_DSP
#define jp_saturate_bits(a, bits) ((int32_t)__builtin_arm_ssat(a, bits))
#else
#define jp_saturate_bits(a, bits) jp_clamp32(a, -((int32_t)1 << ((bits)-1)), ((int32_t)1 << ((bits)-1)) - 1)
#endif

/** a + b, saturated. Exact inside the range. One instruction (QADD) where the core has it. */
inline int32_t jp_add(int32_t a, int32_t b)
{
#if JP_DSP
    return __qadd(a, b);
#else
    return jp_saturate32((int64_t)a + b);
#endif
}

/** a − b, saturated. Exact inside the range. One instruction (QSUB) where the core has it. */
static inline int32_t jp_sub(int32_t a, int32_t b)
{
#if JP_DSP
    return __qsub(a, b);
#else
    return jp_saturate32((int64_t)a - b);
#endif
}

/** a·b in 64 bits: exact. A function where the core has no such instruction (ARMv6-M). */
#if JP_LONG_MULTIPLY
inline int64_t jp_multiply(int32_t a, int32_t b)
{
    return (int64_t)a * b;
}
#else
int64_t jp_multiply(int32_t a, int32_t b);
#endif

/** a·b / 2^shift, 1 <= shift <= 62, rounded and saturated: 0.5 ulp. */
inline int32_t jp_multiply_shift(int32_t a, int32_t b, unsigned shift)
{
    int64_t half = (int64_t)1 << (shift - 1);
    int64_t shifted = (jp_multiply(a, b) + half) >> shift;

    return shift >= 32U ? (int32_t)shifted : jp_saturate32(shifted);
}

/** jp_multiply_shift() by a share of −1 to 1, which needs no limit; −1 of x > INT32_MIN only. In a build for size both
 *  are one function. */
static inline int32_t jp_share(int32_t x, int32_t share, unsigned shift)
{
#if defined(__OPTIMIZE_SIZE__)
    return jp_multiply_shift(x, share, shift);
#else
    int64_t half = (int64_t)1 << (shift - 1);

    return (int32_t)((jp_multiply(x, share) + half) >> shift);
#endif
}

/** Products of equal formats, saturated: 0.5 ulp. jp_q31_multiply(−1, −1) is JP_Q31_MAX. */
static inline jp_q16 jp_q16_multiply(jp_q16 a, jp_q16 b)
{
    return jp_multiply_shift(a, b, 16);
}

static inline jp_q24 jp_q24_multiply(jp_q24 a, jp_q24 b)
{
    return jp_multiply_shift(a, b, 24);
}

static inline jp_q31 jp_q31_multiply(jp_q31 a, jp_q31 b)
{
    return jp_multiply_shift(a, b, 31);
}

/** accumulator + a·b in 64 bits, saturated at ±2⁶³. Exact inside the range. */
static inline int64_t jp_multiply_accumulate(int64_t accumulator, int32_t a, int32_t b)
{
    int64_t product = jp_multiply(a, b);
    if (product > 0 && accumulator > INT64_MAX - product) {
        return INT64_MAX;
    }
    if (product < 0 && accumulator < INT64_MIN - product) {
        return INT64_MIN;
    }
    return accumulator + product;
}

/** x / 2^shift, 1 <= shift <= 62, rounded and saturated to 32 bits: 0.5 ulp. */
inline int32_t jp_round_shift(int64_t x, unsigned shift)
{
    int64_t doubled = x >> (shift - 1);
    int32_t first_dropped_bit = (int32_t)doubled & 1;

    return shift >= 32U ? jp_add((int32_t)(doubled >> 1), first_dropped_bit)
                        : jp_saturate32((doubled >> 1) + first_dropped_bit);
}

/** numerator / denominator, rounded (ties away from zero) and saturated: 0.5 ulp.
 *  A zero denominator saturates by the sign of the numerator; 0/0 is 0. One 64-bit division. */
int32_t jp_divide(int64_t numerator, int32_t denominator);

/** Quotients of equal formats, as jp_divide. */
static inline jp_q16 jp_q16_divide(jp_q16 a, jp_q16 b)
{
    return jp_divide((int64_t)a * ((int64_t)1 << 16), b);
}

static inline jp_q24 jp_q24_divide(jp_q24 a, jp_q24 b)
{
    return jp_divide((int64_t)a * ((int64_t)1 << 24), b);
}

static inline jp_q31 jp_q31_divide(jp_q31 a, jp_q31 b)
{
    return jp_divide((int64_t)a * ((int64_t)1 << 31), b);
}

/** Largest integer whose square is <= x. Exact. 32 rounds of shift and subtract. */
uint32_t jp_square_root(uint64_t x);

/** √x: 0.5 ulp. A negative x gives 0. */
jp_q16 jp_q16_square_root(jp_q16 x);

/** sin and cos of a wrapping angle: within JP_SIN_ERROR_ULP of the exact value, +1 saturated to JP_Q31_MAX;
 *  exact at the quarter turns. */
#define JP_SIN_ERROR_ULP 2
jp_q31 jp_sin(jp_angle angle);
jp_q31 jp_cos(jp_angle angle);

/** Direction of (x, y), whose common format does not matter: within JP_ATAN2_ERROR units of 2⁻³² turn
 *  of the exact value, exact at the eighth turns. (0, 0) gives 0. One 64-bit division. */
#define JP_ATAN2_ERROR 2
jp_angle jp_atan2(int32_t y, int32_t x);

/** Radians in Q8.24 to a wrapping angle and back: within 1 unit of 2⁻³² turn; 0.5 ulp. Back: (−π, π]. */
jp_angle jp_angle_from_radians(jp_q24 radians);
jp_q24 jp_angle_to_radians(jp_angle angle);

/** Difference of two phases that are within ±128 turns, rounded down to 2⁻²⁴ turn; the same across every wrap. */
static inline jp_q24 jp_phase_difference(jp_phase a, jp_phase b)
{
    return (jp_q24)(uint32_t)((a - b) >> 32);
}

/** 2³²/rate, rounded; rate is 2…2³¹. The angle that one of `rate` ticks a second adds to a phase at 2⁻²⁴ turn/s, and
 *  the tick's length in 2⁻³² s. One 32-bit division. */
static inline int32_t jp_phase_per_rate(uint32_t rate)
{
    /* 2³² does not fit; 2³² − rate does, and gives 1 less. */
    return (int32_t)((0U - rate + rate / 2U) / rate + 1U);
}

/** The angle of one tick at `rate`, Q24 turn/s. */
static inline jp_phase jp_phase_step(jp_q24 rate, int32_t phase_per_rate)
{
    return (jp_phase)jp_multiply(rate, phase_per_rate);
}

/** The wrapping angle of a phase, rounded down. */
static inline jp_angle jp_phase_angle(jp_phase phase)
{
    return (jp_angle)(phase >> 24);
}

#ifdef __cplusplus
}
#endif

#endif
