/** Arithmetic of the odometry's parts (skid_odometry.h). Private to the core. */
#ifndef JOULEPATH_SKID_STEER_SKID_ARITHMETIC_H
#define JOULEPATH_SKID_STEER_SKID_ARITHMETIC_H

#include <joulepath/skid_odometry.h>

#include "src/base/integer.h"

#define JP_SKID_ONE ((int32_t)1 << 30) /* Q30 */

#define JP_SKID_TWO_PI JP_Q24(6.283185307179586)

/** What variances are limited to, Q30, so that the reciprocal of their sum is precise. */
#define JP_SKID_VARIANCE_MIN ((int64_t)1 << 16)
#define JP_SKID_VARIANCE_MAX ((int64_t)1 << 45)

/** x · share of Q24. */
static inline int32_t jp_skid_part(int32_t x, jp_q24 share)
{
    return jp_multiply_shift(x, share, 24);
}

/** |x|, saturated. */
static inline int32_t jp_skid_size(int32_t x)
{
    return x < 0 ? jp_sub(0, x) : x;
}

static inline int32_t jp_skid_lesser(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static inline int32_t jp_skid_at_least_one(int32_t variance)
{
    return variance < 1 ? 1 : variance;
}

/** Limited to what filters add up. */
static inline int64_t jp_skid_variance(int64_t x, int64_t high)
{
    const int64_t at_least = x < JP_SKID_VARIANCE_MIN ? JP_SKID_VARIANCE_MIN : x;

    return at_least > high ? high : at_least;
}

static inline int64_t jp_skid_square(int64_t x)
{
    return x * x;
}

/** x 2^bits / divisor, so limited that its square fits: two numbers of the configuration; divisor > 0. */
int64_t jp_skid_over(int32_t x, unsigned bits, int32_t divisor);

#endif
