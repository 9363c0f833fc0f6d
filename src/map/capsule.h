/** Whether a disc can be moved along a straight line between the obstacles of a map: exact, in integers. Private to the
 *  core. */
#ifndef JOULEPATH_MAP_CAPSULE_H
#define JOULEPATH_MAP_CAPSULE_H

#include <joulepath/point.h>
#include <joulepath/terrain.h>

/** All places within `radius` of a line. */
struct jp_capsule {
    struct jp_point from; /**< m from the south-west corner of the map */
    struct jp_point to;   /**< at most 256 cells from it */
    jp_q16 radius;        /**< m; a quarter of a cell to 64 cells */
};

/** True when the capsule overlaps no cell that is blocked or off the map; touching is not overlapping, to 1/1024 of a
 *  cell. Work: a look at the map for each row of cells that it touches, and a distance for each blocked cell near it.
 */
bool jp_capsule_is_clear(const struct jp_terrain *terrain, const struct jp_capsule *capsule);

#endif
