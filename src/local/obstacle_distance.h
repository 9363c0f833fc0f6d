/** Distance of a footprint from a shape. Private to libjoulepath_float. */
#ifndef JOULEPATH_LOCAL_OBSTACLE_DISTANCE_H
#define JOULEPATH_LOCAL_OBSTACLE_DISTANCE_H

#include <joulepath/obstacles.h>

/** As jp_obstacle_distance(), where the cosine and sine of the heading are at hand. */
float jp_obstacle_distance_along(const struct jp_footprint *footprint, const struct jp_plane_pose *pose,
                                 struct jp_plane_point direction, const struct jp_obstacle *shape,
                                 struct jp_plane_pose *gradient);

#endif
