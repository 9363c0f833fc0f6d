/** Random routes of eight legs of 1…15 m that turn by up to 120°, for the benches of trajectories. */
#ifndef JOULEPATH_TESTS_BENCH_RANDOM_LEGS_H
#define JOULEPATH_TESTS_BENCH_RANDOM_LEGS_H

#include <joulepath/point.h>

enum { RANDOM_LEGS = 8 };

static inline uint32_t random_share(uint32_t *state)
{
    *state = *state * 1664525U + 1013904223U;
    return *state >> 8;
}

static inline void draw_legs(uint32_t *state, struct jp_point targets[RANDOM_LEGS])
{
    struct jp_point point = {0, 0};
    jp_angle direction = 0;

    for (unsigned k = 0; k < RANDOM_LEGS; k++) {
        const jp_q16 length = JP_Q16(1) + jp_multiply_shift((int32_t)random_share(state), JP_Q16(14), 24);

        direction += (jp_angle)(((int64_t)random_share(state) - (1 << 23)) * (int64_t)(JP_ANGLE_DEGREES(120) >> 23));
        point.x += jp_multiply_shift(length, jp_cos(direction), 31);
        point.y += jp_multiply_shift(length, jp_sin(direction), 31);
        targets[k] = point;
    }
}

#endif
