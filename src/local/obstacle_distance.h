/** Distance of a footprint from a shape. Private to libjoulepath_float. */
#ifndef JOULEPATH_LOCAL_OBSTACLE_DISTANCE_H
#define JOULEPATH_LOCAL_OBSTACLE_DISTANCE_H

#include <joulepath/obstacles.h>

/** In place of a feature. */
#define JP_FEATURE_UNKNOWN UINT8_MAX

/** As jp_obstacle_distance(), where the cosine and sine of the heading are at hand. *feature is the shape's feature
 * that was nearest from a pose near this one, or unknown; then the one that is. A feature that stays the nearest saves
 * two thirds of the work, and the distance is the same but for rounding. */
float jp_obstacle_distance_along(const struct jp_footprint *footprint, const struct jp_plane_pose *pose,
                                 struct jp_plane_point direction, const struct jp_obstacle *shape, uint8_t *feature,
                                 struct jp_plane_pose *gradient);

#endif
