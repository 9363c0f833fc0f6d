/**
 * In place of tests/support/random.h, so that what draws random traffic draws it from the input of a fuzz target: small
 * choices and whole words are its bytes, the noise between them a stream that the input begins. Include it first.
 */
#ifndef JOULEPATH_TESTS_FUZZ_FUZZ_RANDOM_H
#define JOULEPATH_TESTS_FUZZ_FUZZ_RANDOM_H

#ifdef JOULEPATH_TESTS_SUPPORT_RANDOM_H
#error "tests/support/random.h was included before"
#endif
#define JOULEPATH_TESTS_SUPPORT_RANDOM_H

#include <math.h>

#include "tests/fuzz/fuzz_input.h"

static struct fuzz_input fuzz_random;
static uint64_t random_state = 1;

static inline uint64_t random_next(uint64_t *state)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * UINT64_C(0x2545F4914F6CDD1D);
}

static inline void fuzz_random_begin(const uint8_t *bytes, size_t size)
{
    fuzz_random = (struct fuzz_input){.next = bytes, .left = size};
    random_state = fuzz_u64(&fuzz_random) | 1U;
}

static inline uint64_t random_bits(void)
{
    return fuzz_more(&fuzz_random) ? fuzz_u64(&fuzz_random) : random_next(&random_state);
}

/** From 0 to bound - 1. */
static inline uint32_t below(uint32_t bound)
{
    if (bound <= 256U && fuzz_more(&fuzz_random)) {
        return fuzz_below(&fuzz_random, bound);
    }
    return (uint32_t)(((random_next(&random_state) >> 32) * bound) >> 32);
}

/** 0: never. */
static inline bool one_in(uint32_t times)
{
    return times != 0U && below(times) == 0U;
}

static inline double uniform(double low, double high)
{
    return low + (high - low) * (double)(random_next(&random_state) >> 11) * 0x1p-53;
}

static inline double gaussian(double deviation)
{
    return deviation * sqrt(-2 * log(1 - uniform(0, 1))) * cos(6.283185307179586 * uniform(0, 1));
}

#endif
