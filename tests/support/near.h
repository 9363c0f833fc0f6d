/** Assertions about single-precision numbers, in integers: they print the same with every Unity, on every target. */
#ifndef JOULEPATH_TESTS_SUPPORT_NEAR_H
#define JOULEPATH_TESTS_SUPPORT_NEAR_H

#include <stdint.h>
#include <string.h>

#include "unity.h"

/** In millionths; of numbers within ±2 000. */
#define TEST_ASSERT_NEAR(tolerance, expected, actual)                                                                  \
    TEST_ASSERT_INT32_WITHIN(in_millionths(tolerance), in_millionths(expected), in_millionths(actual))

static inline int32_t in_millionths(float value)
{
    return (int32_t)(value * 1.0e6f);
}

/** The hash (FNV-1a) of the bits of numbers, to be compared between compilers. */
#define BITS_HASH_START 2166136261U

static inline uint32_t hash_bits(uint32_t hash, float value)
{
    uint32_t bits;

    memcpy(&bits, &value, sizeof bits);
    return (hash ^ bits) * 16777619U;
}

#endif
