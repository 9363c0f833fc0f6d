/** Points of the plane in fixed point. Private to the core. */
#ifndef JOULEPATH_BASE_POINT_H
#define JOULEPATH_BASE_POINT_H

#include <joulepath/point.h>
#include <stdbool.h>

static inline bool jp_is_same_point(const struct jp_point *a, const struct jp_point *b)
{
    return a->x == b->x && a->y == b->y;
}

#endif
