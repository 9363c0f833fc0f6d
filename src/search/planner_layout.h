/** How a planner divides its block: the routes first; then guide, energy field if most of the block is left for the
 *  states, and states. */
#ifndef JOULEPATH_SEARCH_PLANNER_LAYOUT_H
#define JOULEPATH_SEARCH_PLANNER_LAYOUT_H

#include <joulepath/planner.h>

/** Fewest states of a search. */
#define JP_LAYOUT_STATES_MIN ((uint32_t)64)

/** Gives the routes their memory. */
void jp_layout_routes(struct jp_planner_internal *planner);

/** Divides the first `size` bytes of the block, at least jp_planner_size(), but for the routes, which stay. What was in
 *  them is lost. */
void jp_layout_divide(struct jp_planner_internal *planner, size_t size);

#endif
