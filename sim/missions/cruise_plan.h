/** Cruise and transients through the waypoints of a scenario, within what it allows. */
#ifndef JOULEPATH_SIM_MISSIONS_CRUISE_PLAN_H
#define JOULEPATH_SIM_MISSIONS_CRUISE_PLAN_H

#include <joulepath/pilot.h>
#include <joulepath/trajectory_budget.h>

#include "sim/missions/scenario.h"

/** It must stay where it is as long as its trajectory. */
struct cruise_plan {
    struct jp_point targets[BEZIER_WAYPOINTS_MAX];
    struct jp_trajectory_leg legs[BEZIER_WAYPOINTS_MAX];
    struct jp_trajectory trajectory;
    struct jp_passage passages[BEZIER_WAYPOINTS_MAX]; /**< that were found */
    /** INT32_MAX: more than 32 767 s or J, or not planned. Where a budget is too small: what is needed. */
    struct jp_budget_plan forecast;
};

/** With the best cruise within the scenario's one budget. Statuses as of jp_trajectory_budget_work(). */
enum jp_status cruise_plan_within(struct cruise_plan *plan, const struct scenario *scenario,
                                  const struct jp_robot_config *robot, const struct jp_energy_model *model);

/** With this cruise, whatever the budget. Statuses as of jp_trajectory_by_rule(). */
enum jp_status cruise_plan_at(struct cruise_plan *plan, const struct scenario *scenario,
                              const struct jp_robot_config *robot, const struct jp_energy_model *model, jp_q24 cruise);

/** Finds the passages of least energy, of which this meter counts, at a pilot's cruise, or where legs have no room for
 * it, slower. Statuses as of jp_trajectory_optimiser_work(). */
enum jp_status cruise_plan_optimise(struct cruise_plan *plan, const struct scenario *scenario,
                                    const struct jp_robot_config *robot, const struct jp_energy_model *model);

#endif
