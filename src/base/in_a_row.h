/** Counting what lasts. Private to the core. */
#ifndef JOULEPATH_BASE_IN_A_ROW_H
#define JOULEPATH_BASE_IN_A_ROW_H

#include <stdbool.h>
#include <stdint.h>

/** Counts calls in a row with this condition; true once there are `limit`. */
static inline bool jp_count_in_a_row(uint16_t *calls, bool condition, uint16_t limit)
{
    if (!condition) {
        *calls = 0;
        return false;
    }
    if (*calls < limit) {
        (*calls)++;
    }
    return *calls >= limit;
}

#endif
