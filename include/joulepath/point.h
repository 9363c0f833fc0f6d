/** A point on the plane: a target of a route, or a point of a path that a planner gives and a tracker follows. */
#ifndef JOULEPATH_POINT_H
#define JOULEPATH_POINT_H

#include <joulepath/fixed.h>

#ifdef __cplusplus
extern "C" {
#endif

/** m, Q16.16; ±32 767 m, step 15 µm. The points of a route count from the origin of odometry; those on a map from its
 *  south-west corner, x to the east and y to the north. */
struct jp_point {
    jp_q16 x;
    jp_q16 y;
};

#ifdef __cplusplus
}
#endif

#endif
