/** Fast fixed-point arithmetic of the segment optimiser, to 28 bits. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_SEGMENT_MATH_H
#define JOULEPATH_TRAJECTORY_SEGMENT_MATH_H

#include <joulepath/fixed.h>
#include <stdint.h>

#include "src/base/compiler.h"

#define Q30_ONE ((int32_t)1 << 30)

static inline int32_t multiply30(int32_t a, int32_t b)
{
    return (int32_t)(((int64_t)a * b) >> 30);
}

static inline int32_t multiply31(int32_t a, int32_t b)
{
    return (int32_t)(((int64_t)a * b) >> 31);
}

static inline int32_t multiply32(int32_t a, int32_t b)
{
    return (int32_t)(((int64_t)a * b) >> 32);
}

/** Of a > 0. */
inline unsigned jp_leading_zeros(uint32_t a)
{
    return JP_LEADING_ZEROS(a);
}

/** 1/a for a > 0 as 2^zeros/2⁶² times the result, which is 1…2 in Q30, to 2⁻²⁸. */
inline uint32_t jp_reciprocal(uint32_t a, unsigned *zeros)
{
    *zeros = jp_leading_zeros(a);

    uint32_t mantissa = a << *zeros;
    uint32_t guess = UINT32_MAX / ((mantissa >> 16) + 1U);                               /* Q16 */
    uint32_t error = (uint32_t)Q30_ONE - (uint32_t)(((uint64_t)mantissa * guess) >> 18); /* Q30 */

    return (guess << 14) + (uint32_t)(((uint64_t)guess * error) >> 16);
}

/** a/b in Q30 for 0 <= a <= b, b > 0, to 2⁻²⁸. */
inline int32_t jp_fraction30(uint32_t a, uint32_t b)
{
    unsigned zeros;
    uint32_t inverse = jp_reciprocal(b, &zeros);
    uint32_t numerator = a << zeros;

    return (int32_t)(((uint64_t)numerator * inverse) >> 32);
}

/** a/b in Q31 for a >= 0, b > 0, saturated, to 2⁻²⁸. */
inline int32_t jp_quotient31(int32_t a, int32_t b)
{
    return a < b ? jp_saturate32(2 * (int64_t)jp_fraction30((uint32_t)a, (uint32_t)b)) : INT32_MAX;
}

/** √a for a > 0, at most 1 too large. */
inline uint32_t jp_square_root32(uint32_t a)
{
    uint32_t root = (uint32_t)1 << ((32U - jp_leading_zeros(a)) / 2U);

    for (int i = 0; i < 3; i++) {
        root = (root + a / root) >> 1;
    }
    return root;
}

#endif
