/** Ways of turning points: traced, shortcut by line of sight and pulled tight. Private to the grid planner. */
#ifndef JOULEPATH_SEARCH_GRID_WAY_H
#define JOULEPATH_SEARCH_GRID_WAY_H

#include "src/search/grid_line.h"
#include "src/search/grid_search.h"

/** Appends a point in place of the last one if the one before that sees it (`shortcut`) or all three are on one line.
 *  False: there is no room. */
bool jp_grid_way_add(const struct jp_grid_planner_internal *planner, struct jp_grid_way *way, struct jp_point point,
                     bool shortcut);

/** The way that the search found, a cell a unit of the budget, from the goal to the start. */
enum jp_grid_progress jp_grid_way_trace(struct jp_grid_planner_internal *planner, unsigned *budget);

void jp_grid_way_reverse(struct jp_grid_way *way);

/** Pulls a way tight, a turning point for eight units of the budget. */
enum jp_grid_progress jp_grid_way_tighten(struct jp_grid_planner_internal *planner, struct jp_grid_way *way,
                                          unsigned *budget);

/** Length, m, Q16. */
uint64_t jp_grid_way_length(const struct jp_grid_way *way);

#endif
