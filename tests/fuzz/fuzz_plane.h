/** Numbers of single precision that come from an input. */
#ifndef JOULEPATH_TESTS_FUZZ_FUZZ_PLANE_H
#define JOULEPATH_TESTS_FUZZ_FUZZ_PLANE_H

#include <joulepath/plane.h>

#include "tests/fuzz/fuzz_input.h"

/** Mostly of this size, and now and then any bits. */
static inline float fuzz_float(struct fuzz_input *input, float most)
{
    float value;

    if (fuzz_below(input, 32) == 31U) {
        fuzz_fill(input, &value, sizeof value);
        return value;
    }
    return most * (float)fuzz_range(input, -32768, 32767) / 32768.0f;
}

static inline struct jp_plane_pose fuzz_pose(struct fuzz_input *input, float most)
{
    return (struct jp_plane_pose){fuzz_float(input, most), fuzz_float(input, most), fuzz_float(input, 3.2f)};
}

#endif
