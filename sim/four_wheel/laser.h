/**
 * A planar laser scanner over a map and moving shapes.
 *
 * A scan is taken at one instant, without the distortion of a scan while moving. A beam is a line without width; it
 * ends at the first solid cell (solid_map.h: unknown cells and the edge of the map are walls, unless unknown ones may
 * be driven over) or shape. Exact up to rounding, then noise and dropouts are added.
 */
#ifndef JOULEPATH_SIM_FOUR_WHEEL_LASER_H
#define JOULEPATH_SIM_FOUR_WHEEL_LASER_H

#include <stddef.h>

#include "sim/base/planar.h"
#include "sim/base/random.h"
#include "sim/four_wheel/solid_map.h"

#define LASER_BEAMS_MAX 720

/** The range of a beam that dropped out, as in struct jp_scan. */
#define LASER_DROPPED (-1.0f)

struct laser_config {
    int beams;        /**< 1…LASER_BEAMS_MAX */
    double first;     /**< bearing of beam 0 from straight ahead, rad */
    double step;      /**< from a beam to the next, counterclockwise, rad */
    double range_max; /**< m */
    double noise;     /**< standard deviation, m */
    double dropout;   /**< probability that a beam drops out, 0…1 */
};

struct laser_scan {
    int beams;
    double first;
    double step;
    float ranges[LASER_BEAMS_MAX]; /**< m; 0: nothing within range; LASER_DROPPED */
};

/** Beams over a field of view, rad: symmetric about straight ahead, and evenly around in a full turn. No dropouts. */
struct laser_config laser_config_of(int beams, double field, double range_max, double noise);

/** Distance from a point along a bearing, rad, to the first solid cell or shape, m; infinity beyond `range_max`. */
double laser_ray(const struct solid_map *map, const struct planar_shape *shapes, size_t count,
                 const struct planar_point *from, double bearing, double range_max);

/** A scan from the scanner's pose. Shapes that hold the scanner are not seen; within a solid cell all ranges are 0. */
void laser_take(const struct laser_config *config, const struct solid_map *map, const struct planar_shape *shapes,
                size_t count, const struct planar_pose *scanner, struct random *random, struct laser_scan *scan);

#endif
