/** The duties of bridges that give voltages. Private to the core. */
#ifndef JOULEPATH_BASE_DUTY_H
#define JOULEPATH_BASE_DUTY_H

#include <joulepath/fixed.h>

#include "src/base/compiler.h"
#include "src/base/integer.h"

/** Bits of the divisor, so that a remainder below three of it, of eight times the weight, fits a word. */
#define JP_BUS_BITS 26U

/** Bits of a quotient that one product with the reciprocal gives. */
#define JP_BUS_DIGIT_BITS 14U

/** What is divided by: a bus voltage. */
struct jp_bus {
    unsigned shift;
    uint32_t divisor;    /**< the voltage times 2^shift: 2²⁵…2²⁶ */
    uint32_t reciprocal; /**< below 2⁴⁶/divisor, by at most 2⁻¹⁴ of it */
};

/** Of 0 < voltage <= 1 000 V. */
static inline struct jp_bus jp_bus_of(jp_q16 voltage)
{
    const unsigned shift = JP_LEADING_ZEROS((uint32_t)voltage) - (32U - JP_BUS_BITS);
    const uint32_t divisor = (uint32_t)voltage << shift;

    return (struct jp_bus){shift, divisor, (UINT32_MAX / ((divisor >> 10) + 1U)) << 4};
}

/** Next digit of a long division. Left of a remainder of up to two divisors are less than three: digits are less than
 *  two too small. */
static inline uint32_t jp_bus_digit(const struct jp_bus *bus, uint32_t *remainder)
{
    const uint32_t digit = (uint32_t)(((uint64_t)*remainder * bus->reciprocal) >> 32);

    *remainder = (*remainder << JP_BUS_DIGIT_BITS) - digit * bus->divisor;
    return digit;
}

/** voltage over that of the bus, rounded; |voltage| is at most that. */
static JP_INLINE_FOR_SPEED jp_q31 jp_duty(jp_q16 voltage, const struct jp_bus *bus)
{
    uint32_t remainder = jp_magnitude32(voltage) << bus->shift;
    const uint32_t high = jp_bus_digit(bus, &remainder);
    const uint32_t middle = jp_bus_digit(bus, &remainder);
    const uint32_t low = ((remainder << 3) + bus->divisor / 2U) / bus->divisor;
    const uint32_t quotient = (((high << JP_BUS_DIGIT_BITS) + middle) << 3) + low;

    if (voltage < 0) {
        return (int32_t)(0U - quotient);
    }
    return quotient > (uint32_t)INT32_MAX ? INT32_MAX : (int32_t)quotient;
}

#endif
