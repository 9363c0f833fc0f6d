/** Cost-to-go in the tube around a way, interpolated along the edges between neighbouring nodes, and the way down it.
 *  Private to the grid planner. */
#ifndef JOULEPATH_SEARCH_GRID_EDGES_H
#define JOULEPATH_SEARCH_GRID_EDGES_H

#include "src/search/grid_way.h"

/** Marks the cells of the tube, a row of it a unit of the budget. */
enum jp_grid_progress jp_grid_edges_mark(struct jp_grid_planner_internal *planner, unsigned *budget);

/** Puts the goal into the queue. */
void jp_grid_edges_start(struct jp_grid_planner_internal *planner);

/** Settles nodes outward from the goal until the start is. GRID_IMPOSSIBLE: the tube's steps do not reach it. */
enum jp_grid_progress jp_grid_edges_spread(struct jp_grid_planner_internal *planner, unsigned *budget);

/** Goes down from the start to the goal, a piece a unit of the budget, with shortcuts, into the other way.
 *  GRID_IMPOSSIBLE: the only step down from a place touches the corner of a blocked cell, and the rounding of the
 * places to the map's units makes it enter that cell. */
enum jp_grid_progress jp_grid_edges_descend(struct jp_grid_planner_internal *planner, unsigned *budget);

#endif
