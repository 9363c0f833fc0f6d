/** Requests of the background to the tick: single bytes, and what one of them guards. Release and acquire order the
 *  rest. Private to the core. */
#ifndef JOULEPATH_BASE_REQUEST_H
#define JOULEPATH_BASE_REQUEST_H

#include <stdbool.h>
#include <stdint.h>

#include "src/base/compiler.h"

static inline void jp_post(uint8_t *flag, uint8_t value)
{
    JP_STORE_RELEASE(flag, value);
}

static inline uint8_t jp_posted(const uint8_t *flag)
{
    return JP_LOAD_ACQUIRE(flag);
}

static inline bool jp_take(uint8_t *flag)
{
    bool was_posted = jp_posted(flag) != 0U;

    if (was_posted) {
        jp_post(flag, 0);
    }
    return was_posted;
}

#endif
