/** A* over the cells to their eight neighbours, step by step or by jump points. Private to the grid planner. */
#ifndef JOULEPATH_SEARCH_GRID_SEARCH_H
#define JOULEPATH_SEARCH_GRID_SEARCH_H

#include "src/search/grid_cost.h"

enum jp_grid_progress { GRID_WORKING, GRID_DONE, GRID_IMPOSSIBLE, GRID_FULL };

/** Puts the start into the queue. */
void jp_grid_search_start(struct jp_grid_planner_internal *planner);

/** Expands until the goal is settled; each expansion takes a unit of the budget or more. GRID_IMPOSSIBLE: there is no
 *  path. GRID_FULL: the queue is full, or every path exceeds JP_GRID_LENGTH_MAX or
 *  JP_GRID_PRICE_MAX. */
enum jp_grid_progress jp_grid_search_work(struct jp_grid_planner_internal *planner, unsigned *budget);

/** Direction from the parent of a settled cell; GRID_NO_DIRECTION at the start. */
unsigned jp_grid_search_parent_direction(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y);

#endif
