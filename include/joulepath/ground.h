/** The ground under a robot as what drives it asks for it. */
#ifndef JOULEPATH_GROUND_H
#define JOULEPATH_GROUND_H

#include <joulepath/point.h>

#ifdef __cplusplus
extern "C" {
#endif

struct jp_ground {
    /** At a point, m. */
    jp_q16 (*elevation)(const void *context, const struct jp_point *point);
    const void *context; /**< handed to it */
    jp_q16 spacing;      /**< between points that tell what lies between them, m; above 0 */
};

#ifdef __cplusplus
}
#endif

#endif
