/** A sum over memory that outlives a reset: tells a record from what power-on leaves there. */
#ifndef JOULEPATH_HAL_STORAGE_MEMORY_CHECK_H
#define JOULEPATH_HAL_STORAGE_MEMORY_CHECK_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Over `size` bytes, a multiple of 4; the words' order counts. `start` above 0 keeps cleared memory from adding up,
 * and one kind of record from another. Four instructions or so a word; for ISRs. */
uint32_t jp_memory_check(uint32_t start, const void *memory, size_t size);

#ifdef __cplusplus
}
#endif

#endif
