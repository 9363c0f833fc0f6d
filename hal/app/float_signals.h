/** Numbers in single precision as signals are made of them. */
#ifndef JOULEPATH_HAL_APP_FLOAT_SIGNALS_H
#define JOULEPATH_HAL_APP_FLOAT_SIGNALS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_TURNS_PER_RADIAN 0.15915494f

/** A number of at least 0 in steps of 1/one, saturated. */
static inline int32_t jp_fixed_of(float value, float one)
{
    const float scaled = value * one;

    return scaled >= 2147483520.0f ? INT32_MAX : (int32_t)scaled;
}

#ifdef __cplusplus
}
#endif

#endif
