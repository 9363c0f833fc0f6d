/** The route that a search has found, as the plan that the user sees. */
#ifndef JOULEPATH_SEARCH_PLANNER_ROUTE_H
#define JOULEPATH_SEARCH_PLANNER_ROUTE_H

#include <joulepath/planner.h>

/** Replaces the plan by the route of the search: optimal or within a bound, or partial when the search runs forward and
 *  has not arrived or the route does not fit. False, with the old plan kept, when the search holds no route. */
bool jp_plan_publish(struct jp_planner_internal *planner);

/** True when the plan leads on from where the robot is now and costs what the search knew before the last changes. */
bool jp_plan_is_intact(const struct jp_planner_internal *planner);

/** As jp_planner_step(). */
const struct jp_primitive *jp_plan_step(const struct jp_planner_internal *planner, unsigned index,
                                        struct jp_lattice_pose *pose);

#endif
