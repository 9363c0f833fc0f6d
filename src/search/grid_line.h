/** Line of sight on the grid. Private to the grid planner. */
#ifndef JOULEPATH_SEARCH_GRID_LINE_H
#define JOULEPATH_SEARCH_GRID_LINE_H

#include "src/search/grid_map.h"

/** The centre of a cell, m. */
static inline struct jp_point jp_grid_centre(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y)
{
    const int32_t side = planner->terrain->config.resolution;

    return (struct jp_point){x * side + side / 2, y * side + side / 2};
}

/** As jp_grid_planner_line_is_free(). */
bool jp_grid_line_is_free(const struct jp_grid_planner_internal *planner, const struct jp_point *from,
                          const struct jp_point *to);

#endif
