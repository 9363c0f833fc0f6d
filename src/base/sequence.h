/** Whole copies of what the tick writes: a count that is odd while a tick is under way. Private to the core. */
#ifndef JOULEPATH_BASE_SEQUENCE_H
#define JOULEPATH_BASE_SEQUENCE_H

#include <stdbool.h>
#include <stdint.h>

#include "src/base/compiler.h"

/** The tick begins to write. */
static inline void jp_sequence_begin(uint32_t *sequence)
{
    JP_STORE(sequence, *sequence + 1U);
    JP_FENCE_RELEASE();
}

/** All is written. */
static inline void jp_sequence_end(uint32_t *sequence)
{
    JP_STORE_RELEASE(sequence, *sequence + 1U);
}

/** Before a copy. False: a tick is under way. */
static inline bool jp_sequence_begin_copy(const uint32_t *sequence, uint32_t *begun)
{
    *begun = JP_LOAD_ACQUIRE(sequence);
    return (*begun & 1U) == 0U;
}

/** After it. False: a tick came between. */
static inline bool jp_sequence_is_whole(const uint32_t *sequence, uint32_t begun)
{
    JP_FENCE_ACQUIRE();
    return JP_LOAD(sequence) == begun;
}

#endif
