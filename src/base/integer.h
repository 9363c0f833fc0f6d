/** Small arithmetic of integers that fixed.h does not have. Private to the core. */
#ifndef JOULEPATH_BASE_INTEGER_H
#define JOULEPATH_BASE_INTEGER_H

#include <stdbool.h>
#include <stdint.h>

static inline bool jp_is_between(int32_t value, int32_t low, int32_t high)
{
    return value >= low && value <= high;
}

/** |x| > limit, for a limit >= 0: what is below −limit wraps round and is large, too. */
static inline bool jp_is_beyond(int32_t x, int32_t limit)
{
    return (uint32_t)x + (uint32_t)limit > 2U * (uint32_t)limit;
}

/** |x|, of any x. */
static inline uint32_t jp_magnitude32(int32_t x)
{
    return x < 0 ? 0U - (uint32_t)x : (uint32_t)x;
}

/** |x| as a number with a sign; x > INT32_MIN. */
static inline int32_t jp_absolute32(int32_t x)
{
    return x < 0 ? -x : x;
}

/** |x| as a number with a sign; x > INT64_MIN. */
static inline int64_t jp_absolute64(int64_t x)
{
    return x < 0 ? -x : x;
}

/** x / 2^shift to nearest, ties towards +infinity; shift > 0, and half of 2^shift can be added. */
static inline int64_t jp_round_shift64(int64_t x, unsigned shift)
{
    return (x + ((int64_t)1 << (shift - 1U))) >> shift;
}

/** x · 2^exponent, rounded down; the result fits, |exponent| < 63. */
static inline int64_t jp_times_power(int64_t x, int32_t exponent)
{
    return exponent < 0 ? x >> (unsigned)-exponent : x * ((int64_t)1 << (unsigned)exponent);
}

#endif
