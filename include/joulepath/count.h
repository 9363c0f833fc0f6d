/** Counters that stop at their maximum. */
#ifndef JOULEPATH_COUNT_H
#define JOULEPATH_COUNT_H

#include <stdint.h>

static inline uint8_t jp_one_more8(uint8_t count)
{
    return (uint8_t)(count + (count < UINT8_MAX ? 1U : 0U));
}

static inline uint16_t jp_one_more16(uint16_t count)
{
    return (uint16_t)(count + (count < UINT16_MAX ? 1U : 0U));
}

static inline uint32_t jp_one_more32(uint32_t count)
{
    return count < UINT32_MAX ? count + 1U : count;
}

#endif
