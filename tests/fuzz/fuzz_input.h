/**
 * What a fuzz target draws from the bytes of its input. Where the input ends, everything is at its lowest value: loops
 * ask fuzz_more().
 */
#ifndef JOULEPATH_TESTS_FUZZ_FUZZ_INPUT_H
#define JOULEPATH_TESTS_FUZZ_FUZZ_INPUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** libFuzzer's entry. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

struct fuzz_input {
    const uint8_t *next;
    size_t left;
};

static inline bool fuzz_more(const struct fuzz_input *input)
{
    return input->left > 0U;
}

/** Fills memory; with zeros where the input has ended. */
static inline void fuzz_fill(struct fuzz_input *input, void *memory, size_t size)
{
    const size_t taken = size < input->left ? size : input->left;

    memset(memory, 0, size);
    if (taken > 0U) {
        memcpy(memory, input->next, taken);
        input->next += taken;
        input->left -= taken;
    }
}

static inline uint8_t fuzz_u8(struct fuzz_input *input)
{
    uint8_t value;

    fuzz_fill(input, &value, sizeof value);
    return value;
}

static inline uint16_t fuzz_u16(struct fuzz_input *input)
{
    uint16_t value;

    fuzz_fill(input, &value, sizeof value);
    return value;
}

static inline uint32_t fuzz_u32(struct fuzz_input *input)
{
    uint32_t value;

    fuzz_fill(input, &value, sizeof value);
    return value;
}

static inline uint64_t fuzz_u64(struct fuzz_input *input)
{
    uint64_t value;

    fuzz_fill(input, &value, sizeof value);
    return value;
}

/** From 0 to bound - 1, by no more bytes than that takes. */
static inline uint32_t fuzz_below(struct fuzz_input *input, uint32_t bound)
{
    const uint32_t value = bound <= 0x100U ? fuzz_u8(input) : bound <= 0x10000U ? fuzz_u16(input) : fuzz_u32(input);

    return bound == 0U ? 0U : value % bound;
}

static inline bool fuzz_bool(struct fuzz_input *input)
{
    return (fuzz_u8(input) & 1U) != 0U;
}

/** From low to high. */
static inline int32_t fuzz_range(struct fuzz_input *input, int32_t low, int32_t high)
{
    const uint32_t span = (uint32_t)high - (uint32_t)low;

    return (int32_t)((uint32_t)low + (span == UINT32_MAX ? fuzz_u32(input) : fuzz_below(input, span + 1U)));
}

/** An integer of any size: most are where something ends. */
static inline int32_t fuzz_hostile(struct fuzz_input *input)
{
    const uint8_t kind = fuzz_u8(input);

    switch (kind % 4U) {
    case 0:
        return (int32_t)fuzz_u32(input);
    case 1:
        return (int16_t)fuzz_u16(input);
    case 2:
        return (int32_t)((UINT32_C(1) << (kind >> 3)) - ((kind >> 2) & 1U)); /* a power of two, or one less */
    default:
        return -(int32_t)((UINT32_C(1) << (kind >> 3) & INT32_MAX) - ((kind >> 2) & 1U));
    }
}

/** What a target has found: libFuzzer keeps the input. */
static inline void fuzz_require(bool condition, const char *what)
{
    if (!condition) {
        fprintf(stderr, "ERROR: found: %s\n", what);
        abort();
    }
}

/**
 * A configuration between what a robot has and just any bytes: `memory` as it is, with fields changed. Fields are where
 * they are in any struct, at multiples of their size.
 */
static inline void fuzz_change(struct fuzz_input *input, void *memory, size_t size)
{
    for (unsigned left = fuzz_below(input, 8); left > 0U; left--) {
        const uint8_t kind = fuzz_u8(input);
        const size_t width = (size_t)1 << (kind & 3U);
        const int64_t value = (kind & 4U) != 0U ? fuzz_hostile(input) : (int64_t)fuzz_u64(input);

        if (width <= size) {
            memcpy((uint8_t *)memory + width * fuzz_below(input, (uint32_t)(size / width)), &value, width);
        }
    }
}

#endif
