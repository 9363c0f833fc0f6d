/**
 * Waypoints for the segment optimiser from a route of the lattice.
 *
 * The robot follows waypoints by arcs, each planned for least energy from where the last one ends. Waypoints are poses
 * along a route; between two of them the straight chord, the arc that the optimiser gives and the turn before it must
 * be clear of obstacles. The choice with the least predicted energy is taken, among those that go on from the best way
 * to each pose and heading (of WAYPOINTS_SECTORS). What the slopes on its way add counts too; the segment's own energy
 * is that of level ground. A segment closer to obstacles than WAYPOINTS_MARGIN_M counts for more, up to
 * WAYPOINTS_MARGIN_PRICE of its energy, since the driven path leaves the predicted one by some centimetres.
 */
#ifndef JOULEPATH_SIM_WAYPOINTS_H
#define JOULEPATH_SIM_WAYPOINTS_H

#include <joulepath/lattice.h>
#include <joulepath/segment.h>

#include "clearance.h"

/** Poses of the route that are farther apart than this many are not joined by one segment. */
#define WAYPOINTS_REACH 96

#define WAYPOINTS_SECTORS 16

#define WAYPOINTS_MARGIN_M     0.15
#define WAYPOINTS_MARGIN_STEPS 3
#define WAYPOINTS_MARGIN_PRICE 0.30

struct waypoints_robot {
    double length_m; /**< of the footprint */
    double width_m;
    const struct jp_energy_model *model;
    const struct jp_segment_limits *limits;
    double margin_min_m;              /**< of all segments but the first and the last, whose places are given */
    const struct jp_slope_cost *step; /**< physical cost of the lattice's step along an axis: what slopes add */
};

/** A waypoint and the segment that leads to it. */
struct waypoint {
    struct clearance_pose pose; /**< predicted at its end */
    struct jp_segment segment;  /**< of the first waypoint, the start: all 0 */
    double margin_m;            /**< that the segment keeps, at most WAYPOINTS_MARGIN_M, in WAYPOINTS_MARGIN_STEPS */
};

/**
 * Chooses waypoints among `count` poses (at least 2) along a route; the first and the last are always taken. Writes at
 * most `count` waypoints and returns how many; 0 when no choice is clear and within the limits, or there is no memory.
 */
size_t waypoints_choose(const struct jp_terrain *terrain, const struct waypoints_robot *robot,
                        const struct clearance_pose *route, size_t count, struct waypoint *waypoints);

/** More places to choose from: writes the poses of a route, between its ends each with one at `aside_m` to its left and
 *  one to its right. Returns how many: 3 `count` − 4. */
size_t waypoints_widen(const struct clearance_pose *route, size_t count, double aside_m, struct clearance_pose *wide);

#endif
