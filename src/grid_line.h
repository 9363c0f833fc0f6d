/** Line of sight on the grid. Private to the grid planner. */
#ifndef JOULEPATH_GRID_LINE_H
#define JOULEPATH_GRID_LINE_H

#include "grid_map.h"

/** The centre of a cell, m. */
static inline struct jp_path_point jp_grid_centre(const struct jp_grid_planner *planner, int32_t x, int32_t y)
{
    const int32_t side = planner->terrain->config.resolution;

    return (struct jp_path_point){x * side + side / 2, y * side + side / 2};
}

#endif
