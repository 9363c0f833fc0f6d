/** Random damage to the text of a file. */
#ifndef JOULEPATH_TESTS_SUPPORT_MUTATION_H
#define JOULEPATH_TESTS_SUPPORT_MUTATION_H

#include <string.h>

#include "sim/base/random.h"

enum { MUTATION_GROWTH_MAX = 12 }; /* bytes that one mutation may add */

static inline size_t draw(struct random *noise, size_t count)
{
    return (size_t)random_uniform(noise, 0.0, (double)count);
}

/** A byte changed, a piece taken out, or a piece doubled. Returns the new size. */
static inline size_t mutate(char *text, size_t size, struct random *noise)
{
    static const char bytes[] = "{}[]\",:.-+0123456789eE#?\\nul \n\xff"; /* and the NUL that ends it */
    const size_t at = draw(noise, size);
    const size_t left = size - at;
    const size_t length = 1 + draw(noise, left < MUTATION_GROWTH_MAX ? left : (size_t)MUTATION_GROWTH_MAX);

    switch (draw(noise, 3)) {
    case 0:
        text[at] = bytes[draw(noise, sizeof bytes)];
        return size;
    case 1:
        memmove(text + at, text + at + length, size - at - length);
        return size - length;
    default:
        memmove(text + at + length, text + at, size - at);
        return size + length;
    }
}

#endif
