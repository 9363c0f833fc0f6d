/** The duty of a bridge that gives a voltage. Private to the core. */
#ifndef JOULEPATH_BASE_DUTY_H
#define JOULEPATH_BASE_DUTY_H

#include <joulepath/fixed.h>

#include "src/base/integer.h"

/** The next `bits` of a long division: at most 6 with a divisor below 2²⁶. */
static inline void jp_divide_on(uint32_t *quotient, uint32_t *remainder, uint32_t divisor, unsigned bits)
{
    uint32_t dividend = *remainder << bits;

    *quotient = (*quotient << bits) + dividend / divisor;
    *remainder = dividend % divisor;
}

/** voltage/bus_voltage, rounded; |voltage| is at most bus_voltage, and that 1 000 V. */
static inline jp_q31 jp_duty(jp_q16 voltage, jp_q16 bus_voltage)
{
    uint32_t divisor = (uint32_t)bus_voltage;
    uint32_t remainder = jp_magnitude32(voltage);
    uint32_t quotient = 0;

    jp_divide_on(&quotient, &remainder, divisor, 6);
    jp_divide_on(&quotient, &remainder, divisor, 6);
    jp_divide_on(&quotient, &remainder, divisor, 6);
    jp_divide_on(&quotient, &remainder, divisor, 6);
    jp_divide_on(&quotient, &remainder, divisor, 6);
    jp_divide_on(&quotient, &remainder, divisor, 1);
    if (remainder >= divisor - remainder) {
        quotient++;
    }
    if (voltage < 0) {
        return (int32_t)(0U - quotient);
    }
    return quotient > (uint32_t)INT32_MAX ? INT32_MAX : (int32_t)quotient;
}

#endif
