/** Counters that stop at their maximum. Private to the core. */
#ifndef JOULEPATH_BASE_COUNT_H
#define JOULEPATH_BASE_COUNT_H

#include <stdint.h>

static inline uint16_t jp_one_more16(uint16_t count)
{
    return count < UINT16_MAX ? (uint16_t)(count + 1U) : count;
}

static inline uint32_t jp_one_more32(uint32_t count)
{
    return count < UINT32_MAX ? count + 1U : count;
}

#endif
