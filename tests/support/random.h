/** Random numbers of the tests: xorshift64*, equal on every machine. */
#ifndef JOULEPATH_TESTS_SUPPORT_RANDOM_H
#define JOULEPATH_TESTS_SUPPORT_RANDOM_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

static uint64_t random_state = 1; /* not 0 */

/** The next 64 bits of a state that is not 0. */
static inline uint64_t random_next(uint64_t *state)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * UINT64_C(0x2545F4914F6CDD1D);
}

static inline uint64_t random_bits(void)
{
    return random_next(&random_state);
}

/** The better half of 64 bits. */
static inline uint32_t random_word(void)
{
    return (uint32_t)(random_bits() >> 32);
}

/** Begins one of many streams of a seed, such as that of a case: it can be repeated alone. */
static inline void begin_random(uint64_t seed, uint64_t stream)
{
    random_state = seed * 1000003U + stream * 7919U + 1U;
    (void)random_bits();
}

/** From 0 to bound - 1. */
static inline uint32_t below(uint32_t bound)
{
    return (uint32_t)(((uint64_t)random_word() * bound) >> 32);
}

/** 0: never. */
static inline bool one_in(uint32_t times)
{
    return times != 0U && below(times) == 0U;
}

static inline double uniform(double low, double high)
{
    return low + (high - low) * (double)(random_bits() >> 11) * 0x1p-53;
}

static inline double log_uniform(double low, double high)
{
    return exp(uniform(log(low), log(high)));
}

static inline double gaussian(double deviation)
{
    return deviation * sqrt(-2 * log(1 - uniform(0, 1))) * cos(6.283185307179586 * uniform(0, 1));
}

#endif
