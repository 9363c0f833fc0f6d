#include "hal/storage/memory_check.h"

#include <string.h>

uint32_t jp_memory_check(uint32_t start, const void *memory, size_t size)
{
    uint32_t check = start;
    uint32_t word;

    for (size_t offset = 0; offset < size; offset += sizeof word) {
        memcpy(&word, (const uint8_t *)memory + offset, sizeof word);
        /* The rotation makes the order of the words count. */
        check = ((check << 1) | (check >> 31)) + word;
    }
    return check;
}
