/** The route that a search has found, as the plan that the user sees. */
#ifndef JOULEPATH_PLANNER_ROUTE_H
#define JOULEPATH_PLANNER_ROUTE_H

#include <joulepath/planner.h>

/** Replaces the plan by the route of the search: optimal or within a bound, or partial when the search runs forward and
 *  has not arrived or the route does not fit. False, with the old plan kept, when the search holds no route. */
bool jp_route_publish(struct jp_planner *planner);

/** True when the plan leads on from where the robot is now and costs what the search knew before the last changes. */
bool jp_route_is_intact(const struct jp_planner *planner);

#endif
