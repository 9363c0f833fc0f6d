/** The route that a search has found, as the plan that the user sees. */
#ifndef JOULEPATH_SEARCH_PLANNER_ROUTE_H
#define JOULEPATH_SEARCH_PLANNER_ROUTE_H

#include <joulepath/planner.h>

/** Makes the spare route the plan, with the bound that is known of it; cost_left of 0: it leads to the goal. */
void jp_plan_publish(struct jp_planner_internal *planner, const struct jp_lattice_pose *end, jp_cost cost,
                     jp_cost cost_left, uint32_t steps);

/** An exact search has proved that no route costs less than the plan. */
void jp_plan_set_optimal(struct jp_planner_internal *planner);

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

/** Continues, over at most *steps steps, which counts down; true when all are checked. Where the robot is at the plan's
 *  start and nothing blocks it, the plan is the answer, with its present cost and bound; else planner->check says which
 *  tail of it leads to the goal. */
bool jp_plan_check(struct jp_planner_internal *planner, unsigned *steps);

/** Cost of a primitive from a pose, obstacles left aside. */
jp_cost jp_plan_step_cost(const struct jp_planner_internal *planner, const struct jp_lattice_pose *from,
                          const struct jp_primitive *primitive);

/** As jp_planner_step(). */
const struct jp_primitive *jp_plan_step(const struct jp_planner_internal *planner, unsigned index,
                                        struct jp_lattice_pose *pose);

#endif
