/** The hash of what a core computed, for tests of equal bits on all cores. */
#ifndef JOULEPATH_TESTS_SUPPORT_BITS_HASH_H
#define JOULEPATH_TESTS_SUPPORT_BITS_HASH_H

#include <stdint.h>

#include "unity.h"

static uint32_t hash;

void setUp(void)
{
    hash = 2166136261u;
}

void tearDown(void)
{
}

static inline void mix(uint32_t value)
{
    hash = (hash ^ value) * 16777619u;
}

#endif
