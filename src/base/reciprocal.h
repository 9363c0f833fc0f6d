/** A division that serves several quotients: filters' gains. Private to the core. */
#ifndef JOULEPATH_BASE_RECIPROCAL_H
#define JOULEPATH_BASE_RECIPROCAL_H

#include <joulepath/fixed.h>

#include "src/base/compiler.h"

/** 1/x = mantissa / 2^(63 − zeros), mantissa of 2¹⁵…2¹⁶. */
struct jp_reciprocal {
    int32_t mantissa;
    unsigned zeros;
};

/** Of 2¹⁶ <= x < 2⁴⁸, to 2⁻¹⁵. One 32-bit division. */
inline struct jp_reciprocal jp_reciprocal_of(int64_t x)
{
    const unsigned zeros = JP_LEADING_ZEROS((uint32_t)(x >> 16));
    const uint32_t divisor = (uint32_t)(((uint64_t)x << zeros) >> 32);
    const uint32_t mantissa = ((uint32_t)1 << 31) / divisor;

    return (struct jp_reciprocal){(int32_t)mantissa, zeros};
}

/** x over what the reciprocal is of, both in one format, Q24; |x| < 2⁴⁶. */
inline jp_q24 jp_share_of(int64_t x, const struct jp_reciprocal *reciprocal)
{
    return jp_saturate32((x * reciprocal->mantissa) >> (39U - reciprocal->zeros));
}

#endif
