#include <joulepath/trajectory_budget.h>

#include <stddef.h>

#include "src/base/integer.h"

#define SPEED_MAX  JP_Q24(8)
#define CRUISE_MIN JP_Q24(0.01)

/** Equal steps from the lowest cruise to the greatest; how often the step is halved, to try slower and faster. */
#define STEPS    32U
#define HALVINGS 8U

_Static_assert(JP_BUDGET_SLICES == STEPS + 1U + 2U * HALVINGS + 1U, "the last slice plans the best once more");

#define NEVER INT32_MAX

static bool is_valid(const struct jp_trajectory_budget_config *config)
{
    return config->model != NULL && config->legs != NULL && config->trajectory != NULL && config->limit > 0 &&
           (config->kind == JP_BUDGET_SECONDS || config->kind == JP_BUDGET_JOULES) &&
           jp_is_between(config->task.cruise, CRUISE_MIN, SPEED_MAX);
}

enum jp_status jp_trajectory_budget_start(struct jp_trajectory_budget *budget,
                                          const struct jp_trajectory_budget_config *config)
{
    if (budget == NULL || config == NULL || !is_valid(config)) {
        return JP_ERR_ARGUMENT;
    }

    const jp_q24 cheapest = jp_cruise_speed(config->model);
    const jp_q24 low = (cheapest < config->task.cruise ? cheapest : config->task.cruise) / 4;

    *budget = (struct jp_trajectory_budget){
        .internal = {.config = *config, .low = low > CRUISE_MIN ? low : CRUISE_MIN, .slices_left = JP_BUDGET_SLICES}};
    budget->best = (struct jp_budget_plan){budget->internal.low, NEVER, NEVER};
    return JP_OK;
}

/** The cruise of this slice: of a step, of half a step about the best, or the best. */
static jp_q24 cruise_of(const struct jp_trajectory_budget *budget)
{
    const jp_q24 low = budget->internal.low;
    const jp_q24 high = budget->internal.config.task.cruise;
    const unsigned slice = JP_BUDGET_SLICES - budget->internal.slices_left;

    if (slice <= STEPS) {
        return high - (high - low) / (int32_t)STEPS * (int32_t)(STEPS - slice);
    }
    if (budget->internal.slices_left == 1U) {
        return budget->best.cruise;
    }

    const unsigned half = slice - STEPS - 1U;
    const jp_q24 step = (high - low) / (int32_t)(STEPS << (half / 2U + 1U));

    return jp_clamp32(budget->best.cruise + ((half & 1U) == 0U ? -step : step), low, high);
}

/** Plans with that cruise; figures that are not known are NEVER. */
static enum jp_status plan_with(const struct jp_trajectory_budget_config *config, struct jp_budget_plan *plan)
{
    struct jp_trajectory *trajectory = config->trajectory;
    struct jp_trajectory_leg *legs = config->legs;
    struct jp_trajectory_task task = config->task;

    task.cruise = plan->cruise;

    const enum jp_status status = jp_trajectory_by_rule(&task, legs, trajectory);

    if (status == JP_OK) {
        (void)jp_trajectory_duration(task.config, trajectory, &plan->seconds);
        (void)jp_trajectory_energy(task.config, config->model, trajectory, &plan->energy);
    }
    return status;
}

/** Its figures fit their format. */
static bool is_known(const struct jp_budget_plan *plan)
{
    return plan->seconds < NEVER && plan->energy < NEVER;
}

static bool keeps(const struct jp_trajectory_budget_config *config, const struct jp_budget_plan *plan)
{
    return is_known(plan) && (config->kind == JP_BUDGET_SECONDS ? plan->seconds : plan->energy) <= config->limit;
}

static bool is_better(const struct jp_trajectory_budget_config *config, const struct jp_budget_plan *plan,
                      const struct jp_budget_plan *best)
{
    const bool is_in_time = config->kind == JP_BUDGET_SECONDS;
    const bool kept = keeps(config, plan);

    if (kept != keeps(config, best)) {
        return kept;
    }
    return kept == is_in_time ? plan->energy < best->energy : plan->seconds < best->seconds;
}

static enum jp_status verdict_on(const struct jp_trajectory_budget_config *config, const struct jp_budget_plan *plan)
{
    if (keeps(config, plan)) {
        return JP_OK;
    }
    return is_known(plan) ? JP_ERR_INFEASIBLE : JP_ERR_OVERFLOW;
}

enum jp_status jp_trajectory_budget_work(struct jp_trajectory_budget *budget)
{
    if (budget == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (budget->internal.slices_left == 0U) {
        return JP_ERR_STATE;
    }

    const struct jp_trajectory_budget_config *config = &budget->internal.config;
    struct jp_budget_plan plan = {cruise_of(budget), NEVER, NEVER};
    const enum jp_status status = plan_with(config, &plan);
    const bool is_last = budget->internal.slices_left == 1U;

    if (status != JP_OK && (is_last || status != JP_ERR_INFEASIBLE)) {
        budget->internal.slices_left = 0;
        return status;
    }
    if (is_better(config, &plan, &budget->best)) {
        budget->best = plan;
    }
    budget->internal.slices_left--;
    return is_last ? verdict_on(config, &plan) : JP_WORKING;
}
