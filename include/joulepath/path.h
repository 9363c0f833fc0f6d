/** A way over the plane as points: what the planners give and the trackers follow. */
#ifndef JOULEPATH_PATH_H
#define JOULEPATH_PATH_H

#include <joulepath/fixed.h>

#ifdef __cplusplus
extern "C" {
#endif

/** In m from the south-west corner of the map, x to the east, y to the north; Q16.16, ±32 767 m, step 15 µm. */
struct jp_path_point {
    jp_q16 x;
    jp_q16 y;
};

#ifdef __cplusplus
}
#endif

#endif
