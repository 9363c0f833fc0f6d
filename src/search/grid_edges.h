/** Field D* in the tube around a path: the cost-to-go, interpolated along the edges between neighbouring nodes, and the
 *  path of its descent. Private to the grid planner. */
#ifndef JOULEPATH_SEARCH_GRID_EDGES_H
#define JOULEPATH_SEARCH_GRID_EDGES_H

#include "src/search/grid_path.h"

/** Marks the cells of the tube; each of its rows takes a unit of the budget. */
enum jp_grid_progress jp_grid_edges_mark(struct jp_grid_planner_internal *planner, unsigned *budget);

/** Puts the goal into the queue. */
void jp_grid_edges_start(struct jp_grid_planner_internal *planner);

/** Settles the nodes of the tube in the order of their cost-to-go until the start is settled, one for a unit of the
 *  budget. GRID_IMPOSSIBLE: the start cannot be reached within the tube. GRID_FULL: the queue is full. */
enum jp_grid_progress jp_grid_edges_propagate(struct jp_grid_planner_internal *planner, unsigned *budget);

/** Descends from the start to the goal, a step for a unit of the budget, and writes the candidate path, shortcut by
 * line of sight. GRID_IMPOSSIBLE: the only step that descends touches the corner of a blocked cell, and rounding to the
 *  map's units makes it enter that cell. GRID_FULL: the path has too many turning points. */
enum jp_grid_progress jp_grid_edges_descend(struct jp_grid_planner_internal *planner, unsigned *budget);

#endif
