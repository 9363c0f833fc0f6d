/** Ground that a wheeled robot drives on: level, a slope, or a map with elevation. */
#ifndef JOULEPATH_SIM_SKID_STEER_SKID_GROUND_H
#define JOULEPATH_SIM_SKID_STEER_SKID_GROUND_H

#include <joulepath/terrain.h>

/** The ground at a place. */
struct skid_ground_point {
    double elevation; /**< m */
    double slope_x;   /**< its derivative along x */
    double slope_y;
};

/** What the plant asks for the ground under each wheel. NULL for `at`: level. */
struct skid_ground {
    struct skid_ground_point (*at)(const void *context, double x, double y);
    const void *context;
};

/** A plane that rises along x and y. */
struct skid_slope {
    double slope_x;
    double slope_y;
};

/** Rises by tan(`degrees`) a metre in the direction `heading`, rad. */
struct skid_slope skid_slope_towards(double degrees, double heading);

/** The ground of a plane, which stays in use. */
struct skid_ground skid_ground_slope(const struct skid_slope *slope);

/** The ground of a map, which stays in use: elevations are those of the cells' middles, bilinear between them; beyond
 *  the outermost middles the ground goes on level. (0, 0) is the south-west corner of the map. */
struct skid_ground skid_ground_map(const struct jp_terrain *map);

#endif
