/** Whether a rectangle fits between the obstacles of a map: exact for the rectangle, in integers. Private to the core.
 */
#ifndef JOULEPATH_MAP_CLEARANCE_H
#define JOULEPATH_MAP_CLEARANCE_H

#include <joulepath/terrain.h>

/** Cells in Q12.20: ±2 048, step 10⁻⁶ of a cell. */
typedef int32_t jp_cells_q20;

#define JP_CELLS_ONE ((jp_cells_q20)1 << 20)

/** A rectangle whose corners are at most 60 cells from its centre. */
struct jp_box {
    jp_cells_q20 x; /**< of the centre, from the south-west corner of the map; −100…1 124 cells */
    jp_cells_q20 y;
    jp_angle heading; /**< of its length, from the x axis */
    jp_cells_q20 half_length;
    jp_cells_q20 half_width;
};

/** True when the rectangle overlaps no cell that is blocked or off the map; touching is not overlapping. Work: the
 * cells around it. */
bool jp_box_is_clear(const struct jp_terrain *terrain, const struct jp_box *box);

#endif
