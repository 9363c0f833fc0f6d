/** The open list of the grid planner: a binary heap of cells; each queued node knows its entry. Equal keys are ordered
 *  by heuristic, nearest to the target first, then by row and column: so the order is the same on every core. Private
 * to the grid planner. */
#ifndef JOULEPATH_SEARCH_GRID_QUEUE_H
#define JOULEPATH_SEARCH_GRID_QUEUE_H

#include "src/search/grid_map.h"

/** Parts of the member `place` of a node. */
#define GRID_ENTRY_MASK      UINT32_C(0x00FFFFFF) /* its entry in the queue, from 1; 0: in none */
#define GRID_DIRECTION_SHIFT 24U
#define GRID_DIRECTION_MASK  UINT32_C(0x0F000000)
#define GRID_IN_TUBE         UINT32_C(0x10000000)
#define GRID_RING_SHIFT      29U
#define GRID_RING_MASK       0xE0000000U /* its ring around what is blocked; 0: beyond all, or no prices */

#define GRID_COST_MAX UINT32_MAX

static inline bool jp_grid_is_settled(const struct jp_grid_node *node)
{
    return node->g != GRID_COST_MAX && (node->place & GRID_ENTRY_MASK) == 0U;
}

/** Puts a cell, whose node has its new cost, into the queue or moves it forward. `estimate`: its heuristic. False:
 * there is no room. */
bool jp_grid_queue_put(struct jp_grid_planner_internal *planner, int32_t x, int32_t y, uint32_t estimate);

/** Takes the cell of the least key out. False: the queue is empty. */
bool jp_grid_queue_take(struct jp_grid_planner_internal *planner, int32_t *x, int32_t *y);

#endif
