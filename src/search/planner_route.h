/** The route that a search has found, as the plan that the user sees. */
#ifndef JOULEPATH_SEARCH_PLANNER_ROUTE_H
#define JOULEPATH_SEARCH_PLANNER_ROUTE_H

#include <joulepath/planner.h>

/** Replaces the plan by the route of the search: optimal or within a bound, or partial when the search runs forward and
 *  has not arrived or the route does not fit. False, with the old plan kept, when the search holds no route. */
bool jp_plan_publish(struct jp_planner_internal *planner, bool is_optimal);

/** Lowers the plan's bound to what the exact search proves by now of this start, goal and map. Constant time. */
void jp_plan_tighten(struct jp_planner_internal *planner);

/** Lets the plan begin at the robot's new start, if that is on its route. False, with the plan kept, if it is not. */
bool jp_plan_follow(struct jp_planner_internal *planner);

/** True when the plan is a route to the goal for this start and map. */
static inline bool jp_plan_is_current(const struct jp_planner_internal *planner)
{
    return planner->answer == JP_ANSWER_OPTIMAL || planner->answer == JP_ANSWER_WITHIN_BOUND;
}

/** True when the plan's route ends at the present goal. */
bool jp_plan_leads_to_goal(const struct jp_planner_internal *planner);

/** Begins to check the plan's route on the present map. */
void jp_plan_begin_check(struct jp_planner_internal *planner);

enum plan_check { PLAN_CHECKING, PLAN_INTACT, PLAN_BROKEN };

/** Continues, over at most *steps steps, which counts down. Intact: the robot is at its start, nothing blocks it, and
 *  it has its present cost and bound. Else planner->check says which tail of it leads to the goal. */
enum plan_check jp_plan_check(struct jp_planner_internal *planner, unsigned *steps);

/** Seeds a search with the first states of the tail that the check has found. Work: at most 64 steps. */
void jp_plan_begin_splice(struct jp_planner_internal *planner);

/** As jp_planner_step(). */
const struct jp_primitive *jp_plan_step(const struct jp_planner_internal *planner, unsigned index,
                                        struct jp_lattice_pose *pose);

#endif
