#include "sim/missions/cruise_plan.h"

#include <joulepath/trajectory_optimiser.h>
#include <math.h>

#include "sim/balancer/energy_unit.h"

/* As a pilot does it. */
#define SLOWER_MAX 8U

static struct jp_trajectory_task task_of(struct cruise_plan *plan, const struct scenario *scenario,
                                         const struct jp_robot_config *robot, jp_q24 cruise)
{
    const size_t count = scenario->waypoint_count - 1;

    for (size_t i = 0; i < count; i++) {
        plan->targets[i] = (struct jp_point){(jp_q16)lround(scenario->waypoints[i + 1].x * JP_Q16_ONE),
                                             (jp_q16)lround(scenario->waypoints[i + 1].y * JP_Q16_ONE)};
    }
    return (struct jp_trajectory_task){.config = &robot->trajectory,
                                       .cruise = cruise,
                                       .targets = plan->targets,
                                       .passages = &scenario->passages[1],
                                       .count = (uint16_t)count,
                                       .to_stand = scenario->to_stand};
}

enum jp_status cruise_plan_at(struct cruise_plan *plan, const struct scenario *scenario,
                              const struct jp_robot_config *robot, const struct jp_energy_model *model, jp_q24 cruise)
{
    const struct jp_trajectory_task task = task_of(plan, scenario, robot, cruise);
    const enum jp_status status = jp_trajectory_by_rule(&task, plan->legs, &plan->trajectory);

    plan->forecast = (struct jp_budget_plan){cruise, INT32_MAX, INT32_MAX};
    if (status == JP_OK) {
        (void)jp_trajectory_duration(task.config, &plan->trajectory, &plan->forecast.seconds);
        (void)jp_trajectory_energy(task.config, model, &plan->trajectory, &plan->forecast.energy);
    }
    return status;
}

enum jp_status cruise_plan_within(struct cruise_plan *plan, const struct scenario *scenario,
                                  const struct jp_robot_config *robot, const struct jp_energy_model *model)
{
    const bool in_time = scenario->within_seconds > 0;
    const double limit =
        in_time ? scenario->within_seconds * JP_Q16_ONE : energy_unit_number(model, scenario->within_joules);
    const struct jp_trajectory_budget_config config = {
        .task = task_of(plan, scenario, robot, robot->limits.speed),
        .model = model,
        .kind = in_time ? JP_BUDGET_SECONDS : JP_BUDGET_JOULES,
        .limit = (jp_q16)floor(fmin(INT32_MAX, limit)),
        .legs = plan->legs,
        .trajectory = &plan->trajectory,
    };
    struct jp_trajectory_budget budget;
    enum jp_status status = jp_trajectory_budget_start(&budget, &config);

    if (status == JP_OK) {
        do {
            status = jp_trajectory_budget_work(&budget);
        } while (status == JP_WORKING);
        plan->forecast = budget.best;
    }
    return status;
}

static enum jp_status optimise_at(struct cruise_plan *plan, const struct scenario *scenario,
                                  const struct jp_robot_config *robot, const struct jp_energy_model *model,
                                  jp_q24 cruise)
{
    struct jp_optimiser_place places[BEZIER_WAYPOINTS_MAX];
    const enum jp_pilot_meter meter = scenario->energy == ENERGY_BATTERY ? JP_PILOT_BATTERY : JP_PILOT_MOTORS;
    const struct jp_trajectory_optimiser_config config = {
        .task = task_of(plan, scenario, robot, cruise),
        .model = model,
        .back_emf = jp_pilot_back_emf(robot, meter),
        .passages = plan->passages,
        .places = places,
        .place_count = BEZIER_WAYPOINTS_MAX,
    };
    struct jp_trajectory_optimiser optimiser;
    enum jp_status status = jp_trajectory_optimiser_start(&optimiser, &config);

    if (status == JP_OK) {
        do {
            status = jp_trajectory_optimiser_work(&optimiser);
        } while (status == JP_WORKING);
    }
    return status;
}

enum jp_status cruise_plan_optimise(struct cruise_plan *plan, const struct scenario *scenario,
                                    const struct jp_robot_config *robot, const struct jp_energy_model *model)
{
    jp_q24 cruise = jp_pilot_cruise(robot, model);
    enum jp_status status = optimise_at(plan, scenario, robot, model, cruise);

    for (unsigned i = 0; i < SLOWER_MAX && status == JP_ERR_INFEASIBLE; i++) {
        cruise -= cruise / 4;
        status = optimise_at(plan, scenario, robot, model, cruise);
    }
    return status;
}
