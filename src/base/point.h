/** Points of the plane in fixed point. Private to the core. */
#ifndef JOULEPATH_BASE_POINT_H
#define JOULEPATH_BASE_POINT_H

#include <joulepath/point.h>
#include <stdbool.h>

/** m, saturated: of points that are farther apart than a format holds, too. */
static inline jp_q16 jp_distance(const struct jp_point *a, const struct jp_point *b)
{
    const int64_t x = jp_sub(a->x, b->x);
    const int64_t y = jp_sub(a->y, b->y);

    return jp_saturate32((int64_t)jp_square_root((uint64_t)(x * x) + (uint64_t)(y * y)));
}

static inline bool jp_is_same_point(const struct jp_point *a, const struct jp_point *b)
{
    return a->x == b->x && a->y == b->y;
}

#endif
