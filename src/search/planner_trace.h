/** Follows the route that a search has found, in slices, and makes it the plan. */
#ifndef JOULEPATH_SEARCH_PLANNER_TRACE_H
#define JOULEPATH_SEARCH_PLANNER_TRACE_H

#include <joulepath/planner.h>

/** Begins at the search's target; a search from the robot that has not arrived is traced from the state with the least
 *  heuristic. False when there is none. */
bool jp_trace_begin(struct jp_planner_internal *planner, bool has_ended);

enum trace_result { TRACE_WORKING, TRACE_PUBLISHED, TRACE_FAILED };

/** Continues, over at most *steps steps, which counts down. Published: the plan is the search's route, unless that is
 * no better than the plan; it is cut, and partial, where the route's memory ends. Failed: the search holds no route, or
 * a splice does not fit; the plan is the old one. */
enum trace_result jp_trace_work(struct jp_planner_internal *planner, unsigned *steps);

#endif
