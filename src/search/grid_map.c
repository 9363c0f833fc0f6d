#include "src/search/grid_map.h"

#include <string.h>

enum { CELLS_PER_UNIT = 8 /* filled for a unit of the budget */ };

/** Half-width of row `y` of the disc, cells: the outermost cell that is nearer than the clearance; below 0: none is.
 * The n-th cell from a centre begins (2n − 1)/2 cells from it along each axis. `clearance_cells`: Q16. */
static int32_t half_width(int32_t y, int64_t clearance_cells)
{
    const int64_t across = y == 0 ? 0 : 2 * (y < 0 ? -y : y) - 1;
    const int64_t reach = clearance_cells * 2;
    int32_t x = y == 0 ? 0 : -1;

    for (int64_t along = x < 0 ? 0 : 1;; along = along == 0 ? 1 : along + 2) {
        if ((along * along + across * across) << 32 >= reach * reach) {
            return x;
        }
        x++;
    }
}

void jp_grid_make_disc(struct jp_grid_planner_internal *planner)
{
    const int64_t resolution = planner->terrain->config.resolution;
    const int64_t clearance = ((int64_t)planner->config.clearance * JP_Q16_ONE + resolution - 1) / resolution;

    planner->disc_rows = 0;
    for (int32_t y = -JP_GRID_CLEARANCE_MAX; y <= JP_GRID_CLEARANCE_MAX; y++) {
        const int32_t x = half_width(y, clearance);
        if (x >= 0) {
            planner->disc[planner->disc_rows] = (struct jp_span){(int8_t)y, (int8_t)-x, (int8_t)x};
            planner->disc_rows++;
        }
    }
}

static void release(uint32_t *plane, uint32_t words, int32_t bit, int32_t row)
{
    const uint32_t column = (uint32_t)(bit + 1);
    const uint32_t line = (uint32_t)(row + 1);
    const uint32_t mask = UINT32_C(1) << (column % GRID_WORD_BITS);

    plane[line * words + column / GRID_WORD_BITS] &= ~mask;
}

static void fill_cell(struct jp_grid_planner_internal *planner, int32_t x, int32_t y)
{
    if (jp_terrain_is_clear(planner->terrain, planner->disc, planner->disc_rows, x, y)) {
        release(planner->rows, planner->row_words, x, y);
        release(planner->columns, planner->column_words, y, x);
    }
}

static void block_all(struct jp_grid_planner_internal *planner)
{
    const struct jp_terrain_config *map = &planner->terrain->config;

    (void)memset(planner->rows, 0xFF, planner->row_words * ((size_t)map->height + 2U) * sizeof(uint32_t));
    (void)memset(planner->columns, 0xFF, planner->column_words * ((size_t)map->width + 2U) * sizeof(uint32_t));
}

bool jp_grid_fill_planes(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    const uint32_t cells = jp_grid_cell_count(planner);
    const uint32_t width = planner->terrain->config.width;

    if (planner->cursor == 0U) {
        block_all(planner);
    }
    for (; *budget > 0U && planner->cursor < cells; --*budget) {
        for (unsigned i = 0; i < CELLS_PER_UNIT && planner->cursor < cells; i++, planner->cursor++) {
            const uint32_t x = planner->cursor % width;
            const uint32_t y = planner->cursor / width;
            fill_cell(planner, (int32_t)x, (int32_t)y);
        }
    }
    return planner->cursor == cells;
}
