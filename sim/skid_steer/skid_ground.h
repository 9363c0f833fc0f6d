/** Ground that a wheeled robot drives on: level, a slope, or a map with elevation; and what it is like: as the robot
 * file says, or otherwise by its class on a map. */
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

/** What ground is like against that of a robot file; both above 0. */
struct skid_grip {
    double rolling;  /**< resistance, times as much */
    double friction; /**< times as much */
};

/** What the plant asks for the ground under each wheel. NULL for `at`: as the robot file says. */
struct skid_surface {
    struct skid_grip (*at)(const void *context, double x, double y);
    const void *context;
    struct skid_grip most; /**< the most rolling resistance of any place, and the least friction */
};

/** The classes of ground of a map. */
struct skid_classes {
    const struct jp_terrain *map;
    struct skid_grip grip[JP_GROUND_CLASSES];
};

/** The surface of a map; *classes and what it points to stay in use. Off the map it is of class 0. */
struct skid_surface skid_surface_map(const struct skid_classes *classes);

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
