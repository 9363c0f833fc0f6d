/** The blocks of memory that callers hand over, and their parts. Private to the core. */
#ifndef JOULEPATH_BASE_BLOCK_H
#define JOULEPATH_BASE_BLOCK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Of a block and of each of its parts, bytes. */
#define JP_BLOCK_ALIGNMENT 8U

/** The size of a part, such that the next one is aligned. */
static inline size_t jp_block_align(size_t size)
{
    return (size + JP_BLOCK_ALIGNMENT - 1U) / JP_BLOCK_ALIGNMENT * JP_BLOCK_ALIGNMENT;
}

static inline bool jp_block_is_aligned(const void *block)
{
    return (uintptr_t)block % JP_BLOCK_ALIGNMENT == 0U;
}

#endif
