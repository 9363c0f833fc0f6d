#include "src/base/power_of_half.h"

#include <stddef.h>

/*
 * 2^-x = 1 − x P(x) for x in [0, 1), in Q30; x in Q32.
 * P: minimax coefficients by fixed_polynomials.py, in Q32; their signs alternate, so the nested differences stay
 * positive.
 */
static uint32_t power_of_fraction(uint32_t x)
{
    static const uint32_t coefficients[] = {5486705u, 41155296u, 238337602u, 1031757278u, 2977044080u};
    uint32_t p = 472172u;
    for (size_t i = 0; i < sizeof coefficients / sizeof coefficients[0]; i++) {
        p = coefficients[i] - (uint32_t)(((uint64_t)x * p) >> 32);
    }
    return ((uint32_t)1 << 30) - (uint32_t)(((uint64_t)x * p) >> 34);
}

int32_t jp_power_of_half(uint64_t x)
{
    const uint32_t whole = (uint32_t)(x >> 32);

    if (whole > 30U) {
        return 0;
    }

    const uint32_t power = power_of_fraction((uint32_t)x) >> whole;

    return (int32_t)power;
}
