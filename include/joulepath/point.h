/** A point on the plane: of targets, of the ways that the planners give and of those that the trackers follow. */
#ifndef JOULEPATH_POINT_H
#define JOULEPATH_POINT_H

#include <joulepath/fixed.h>

#ifdef __cplusplus
extern "C" {
#endif

/** In m; Q16.16, ±32 767 m, step 15 µm. Of a route from the origin of odometry; on a map from its south-west corner, x
 *  to the east and y to the north. */
struct jp_point {
    jp_q16 x;
    jp_q16 y;
};

#ifdef __cplusplus
}
#endif

#endif
