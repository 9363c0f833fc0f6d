/** Fixed point (joulepath/fixed.h) as numbers in double, and back. */
#ifndef JOULEPATH_TESTS_SUPPORT_DECIMAL_H
#define JOULEPATH_TESTS_SUPPORT_DECIMAL_H

#include <joulepath/fixed.h>
#include <math.h>

static inline double q16(jp_q16 x)
{
    return x * 0x1p-16;
}

static inline double q24(jp_q24 x)
{
    return x * 0x1p-24;
}

static inline jp_q16 to_q16(double x)
{
    return (jp_q16)lround(x * 0x1p16);
}

static inline jp_q24 to_q24(double x)
{
    return (jp_q24)lround(x * 0x1p24);
}

#endif
