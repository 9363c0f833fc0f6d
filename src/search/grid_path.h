/** Paths as turning points: traced from the search, shortened by line of sight. Private to the grid planner. */
#ifndef JOULEPATH_SEARCH_GRID_PATH_H
#define JOULEPATH_SEARCH_GRID_PATH_H

#include "src/search/grid_line.h"
#include "src/search/grid_search.h"

/** Appends a point in place of the last one if all three are on one line, or (`shortcut`) the one before that sees it
 *  and the way costs no more.
 *  False: there is no room. */
bool jp_grid_path_add(const struct jp_grid_planner_internal *planner, struct jp_grid_path *path, struct jp_point point,
                      bool shortcut);

/** Traces the path that the search found, from the goal to the start; each cell takes a unit of the budget. */
enum jp_grid_progress jp_grid_path_trace(struct jp_grid_planner_internal *planner, unsigned *budget);

void jp_grid_path_reverse(struct jp_grid_path *path);

/** Shortens a path, or makes it cheaper, by line of sight; each turning point takes eight units of the budget. */
enum jp_grid_progress jp_grid_path_tighten(struct jp_grid_planner_internal *planner, struct jp_grid_path *path,
                                           unsigned *budget);

/** As jp_grid_line_price(), of all lines. */
uint64_t jp_grid_path_price(const struct jp_grid_planner_internal *planner, const struct jp_grid_path *path);

#endif
