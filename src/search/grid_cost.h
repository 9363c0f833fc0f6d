/** What steps and lines cost: their length, or by the prices of a metre in each cell. Private to the grid planner. */
#ifndef JOULEPATH_SEARCH_GRID_COST_H
#define JOULEPATH_SEARCH_GRID_COST_H

#include "src/search/grid_queue.h"

#define GRID_STRAIGHT UINT32_C(65536) /* cost of a step without prices, cells, Q16 */
#define GRID_DIAGONAL UINT32_C(92682) /* √2, rounded up */

/** Directions, counterclockwise from east; odd ones are diagonal. */
enum { GRID_DIRECTIONS = 8, GRID_NO_DIRECTION = 8 };

struct jp_grid_direction {
    int8_t dx;
    int8_t dy;
};
extern const struct jp_grid_direction jp_grid_directions[GRID_DIRECTIONS];

/** Takes over the prices of the configuration; without any a level cell costs its length. False: one is out of range.
 */
bool jp_grid_take_prices(struct jp_grid_planner_internal *planner);

/** Gives each cell its ring, some cells for a unit of the budget: distances from blocked cells in the nodes' costs, on
 *  in the order of the cells and then back (chamfer 5-7; Borgefors, 1986). True when one of the two is complete. */
bool jp_grid_measure(struct jp_grid_planner_internal *planner, unsigned *budget);
bool jp_grid_measure_back(struct jp_grid_planner_internal *planner, unsigned *budget);

/** Price of a metre in a cell of the map on level ground, in that of one far from things, Q8. */
static inline uint32_t jp_grid_level_price(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y)
{
    return planner->near[jp_grid_node(planner, x, y)->place >> GRID_RING_SHIFT];
}

/** Cost of a step from a cell to its neighbour in a direction, both on the map. */
uint32_t jp_grid_step_cost(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y, unsigned direction);

/** Price of a line on the map, in level metres far from things, Q24. Work: the cells on the line. */
uint64_t jp_grid_line_price(const struct jp_grid_planner_internal *planner, const struct jp_point *from,
                            const struct jp_point *to);

/** The same as a cost. */
uint32_t jp_grid_line_cost(const struct jp_grid_planner_internal *planner, const struct jp_point *from,
                           const struct jp_point *to);

/** Units of the budget for what looks along a line a few times: 1, and more for a long line that is priced. */
unsigned jp_grid_line_units(const struct jp_grid_planner_internal *planner, const struct jp_point *from,
                            const struct jp_point *to);

#endif
