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

/** A field of another value: any, one where something ends, or a share of the one it has. */
static inline int64_t fuzz_other(struct fuzz_input *input, int64_t value)
{
    switch (fuzz_below(input, 4)) {
    case 0:
        return (int64_t)fuzz_u64(input);
    case 1:
        return fuzz_hostile(input);
    case 2:
        return value / (1 + fuzz_u8(input));
    default:
        return (int64_t)((uint64_t)value * fuzz_u8(input));
    }
}

/** One field of `width` bytes, a power of two to 8. */
static inline void fuzz_change_field(struct fuzz_input *input, uint8_t *field, size_t width)
{
    int64_t value = 0;

    memcpy(&value, field, width);
    if (width == 4U) {
        value = (int32_t)value;
    }
    value = fuzz_other(input, value);
    memcpy(field, &value, width);
}

/**
 * A configuration between what a robot has and just any bytes: `memory` as it is, but for up to 15 fields. Fields are
 * where they are in any struct, at multiples of their size.
 */
static inline void fuzz_change(struct fuzz_input *input, void *memory, size_t size)
{
    for (unsigned left = fuzz_below(input, 16); left > 0U; left--) {
        const size_t width = (size_t)1 << fuzz_below(input, 4);

        if (width <= size) {
            fuzz_change_field(input, (uint8_t *)memory + width * fuzz_below(input, (uint32_t)(size / width)), width);
        }
    }
}

/** The same of a whole struct, all of whose bytes may be anything. */
#define FUZZ_CHANGE(input, object) fuzz_change(input, &(object), sizeof(object))

/** The same without what stands before `member`, such as a name. */
#define FUZZ_CHANGE_FROM(input, object, member)                                                                        \
    fuzz_change(input, &(object).member, sizeof(object) - (size_t)((uint8_t *)&(object).member - (uint8_t *)&(object)))

#endif
