/** An arc over a map: where it keeps clear of obstacles, and what its slopes cost. Private to the core. */
#ifndef JOULEPATH_NAVIGATE_WAYPOINT_ARC_H
#define JOULEPATH_NAVIGATE_WAYPOINT_ARC_H

#include <joulepath/lattice.h>

#include "src/map/clearance.h"

/** A turn in place is an arc of length 0, a chord one that does not turn. */
struct jp_waypoint_arc {
    jp_cells_q20 x; /**< of the start, as in struct jp_box */
    jp_cells_q20 y;
    jp_angle heading; /**< at the start */
    int64_t turn;     /**< of the heading, units of jp_angle; less than a turn */
    int64_t length;   /**< cells in Q20; less than 1 300 cells */
};

/** The robot's footprint, and a margin on all its sides, in cells. */
struct jp_waypoint_footprint {
    jp_cells_q20 half_length;
    jp_cells_q20 half_width;
    jp_cells_q20 margin;
};

/** True when the footprint with its margin overlaps no obstacle along the arc, at poses between which no point of the
 *  footprint moves farther than a tenth of a cell. Work: the cells around it for each pose. */
bool jp_waypoint_arc_is_clear(const struct jp_terrain *terrain, const struct jp_waypoint_footprint *footprint,
                              const struct jp_waypoint_arc *arc);

/** What the slopes under the arc cost beyond level ground, in steps of at most a cell, in units of jp_cost; false when
 *  one is too steep. Work: its cells. */
bool jp_waypoint_arc_slopes(const struct jp_terrain *terrain, const struct jp_slope_cost *step,
                            const struct jp_waypoint_arc *arc, int64_t *cost);

#endif
