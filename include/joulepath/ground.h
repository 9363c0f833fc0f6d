/** The ground under a robot as what drives it asks for it: its elevation, and of which kind it is. */
#ifndef JOULEPATH_GROUND_H
#define JOULEPATH_GROUND_H

#include <joulepath/point.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Kinds of ground that a map tells apart: asphalt, grass, mud … Class 0 is the ground that the robot's energy model was
 * made for; what others take beside it is learned (ground_learner.h).
 */
#define JP_GROUND_CLASSES 4U

struct jp_ground {
    /** At a point, m; ±16 383. */
    jp_q16 (*elevation)(const void *context, const struct jp_point *point);
    /** At a point: 0…JP_GROUND_CLASSES − 1. Null: 0 everywhere. */
    uint8_t (*class_at)(const void *context, const struct jp_point *point);
    const void *context; /**< handed to it */
    jp_q16 spacing;      /**< between points that tell what lies between them, m; above 0 */
    jp_q16 margin;       /**< which the robot may be aside of where it is taken to be, m; 0…2 */
};

#ifdef __cplusplus
}
#endif

#endif
