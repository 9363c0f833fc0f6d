/** Random numbers of the target benches: xorshift, equal on every machine. */
#ifndef TARGET_RANDOM_H
#define TARGET_RANDOM_H

#include <stdint.h>

/** The next 32 bits; the state must not be 0. */
static inline uint32_t target_random(uint32_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

#endif
