/** The planes of blocked cells, and places on the grid. Private to the grid planner. */
#ifndef JOULEPATH_SEARCH_GRID_MAP_H
#define JOULEPATH_SEARCH_GRID_MAP_H

#include <joulepath/grid_planner.h>

#define GRID_WORD_BITS 32U

/** Words of a row of a plane with `cells` cells and its border. */
static inline size_t jp_grid_words(uint16_t cells)
{
    return ((size_t)cells + 2U + GRID_WORD_BITS - 1U) / GRID_WORD_BITS;
}

/** x is −1…width, y is −1…height: the border of one cell around the map counts as blocked. */
static inline bool jp_grid_is_blocked(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y)
{
    const uint32_t column = (uint32_t)(x + 1);
    const uint32_t row = (uint32_t)(y + 1);
    const uint32_t word = planner->rows[row * planner->row_words + column / GRID_WORD_BITS];

    return ((word >> (column % GRID_WORD_BITS)) & 1U) != 0U;
}

static inline struct jp_grid_node *jp_grid_node(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y)
{
    return &planner->nodes[(size_t)y * planner->terrain->config.width + (size_t)x];
}

static inline uint32_t jp_grid_cell_count(const struct jp_grid_planner_internal *planner)
{
    return (uint32_t)planner->terrain->config.width * planner->terrain->config.height;
}

/** Makes the spans of the disc with the clearance as radius. */
void jp_grid_make_disc(struct jp_grid_planner_internal *planner);

/** Makes the bit planes of blocked cells anew, some cells for a unit of the budget. True when they are complete. */
bool jp_grid_fill_planes(struct jp_grid_planner_internal *planner, unsigned *budget);

#endif
