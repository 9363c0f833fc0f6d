/** Numbers of the library as raw values of signals: rounded, and saturated to what the signal holds. */
#ifndef JOULEPATH_HAL_APP_SIGNALS_H
#define JOULEPATH_HAL_APP_SIGNALS_H

#include <joulepath/fixed.h>

/* Fraction bits that a signal leaves out. */
#define JP_RATE_SHIFT    12U /* Q24 to Q12 */
#define JP_ANGLE_SHIFT   8U  /* Q24 to Q16 */
#define JP_VOLTAGE_SHIFT 9U  /* Q16 to Q7 */
#define JP_FACTOR_SHIFT  4U  /* Q16 to Q12 */
#define JP_MASS_SHIFT    9U  /* Q16 to Q7 */

static inline int16_t jp_signal16(int32_t value, unsigned shift)
{
    return (int16_t)jp_saturate_bits(jp_round_shift(value, shift), 16);
}

/** Of a value that is at least 0. */
static inline uint16_t jp_signal16u(int32_t value, unsigned shift)
{
    return (uint16_t)jp_clamp32(jp_round_shift(value, shift), 0, UINT16_MAX);
}

static inline uint8_t jp_signal_count8(uint32_t value)
{
    return (uint8_t)(value > UINT8_MAX ? UINT8_MAX : value);
}

/** Low bits of a phase in 2⁻⁵⁶ turn, rounded down: an angle within ±½ turn. */
static inline int16_t jp_signal_phase(jp_phase phase, unsigned bits)
{
    const uint32_t angle = jp_phase_angle(phase);

    return (int16_t)((int32_t)angle >> (32U - bits));
}

#endif
