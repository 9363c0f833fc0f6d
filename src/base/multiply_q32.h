/** A product that meter and current check share. Private to the core. */
#ifndef JOULEPATH_BASE_MULTIPLY_Q32_H
#define JOULEPATH_BASE_MULTIPLY_Q32_H

#include <stdint.h>

#include "src/base/compiler.h"

/** a·b of Q32 numbers, rounded: the halves of a one by one, because the whole product needs 80 bits. */
static JP_INLINE_FOR_SPEED int64_t multiply_q32(int64_t a, uint32_t b)
{
    const uint64_t low = (uint64_t)(uint32_t)a * b + ((uint64_t)1 << 31);

    return (a >> 32) * b + (int64_t)(low >> 32);
}

#endif
