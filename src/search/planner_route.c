#include "src/search/planner_route.h"

#include <string.h>

#include "src/search/planner_fields.h"
#include "src/search/planner_pose.h"
#include "src/search/planner_search.h"

jp_cost jp_plan_step_cost(const struct jp_planner_internal *planner, const struct jp_lattice_pose *from,
                          const struct jp_primitive *primitive)
{
    return jp_lattice_energy(planner->config.lattice, planner->config.cost, planner->terrain, primitive, from->x,
                             from->y);
}

/** Lower bound of any route from the robot to one of the goal's headings, whatever lies between. */
static jp_cost straight_bound(const struct jp_planner_internal *planner)
{
    const struct jp_lattice_pose *start = &planner->start;
    const struct jp_goal *goal = &planner->goal;
    const int32_t rise = jp_terrain_elevation(planner->terrain, goal->x, goal->y) -
                         jp_terrain_elevation(planner->terrain, start->x, start->y);

    return jp_cost_add(jp_straight_bound(&planner->straight, goal->x - start->x, goal->y - start->y, rise),
                       jp_fields_turns_to_goal(planner));
}

static jp_cost higher(jp_cost a, jp_cost b)
{
    return a > b ? a : b;
}

/** The best lower bound that is known of any route of this start, goal and map. */
static jp_cost least_cost(const struct jp_planner_internal *planner)
{
    return higher(planner->least, higher(straight_bound(planner), jp_search_least_cost(planner)));
}

/** The bound of a route of this cost where none costs less than `least`. */
static uint16_t bound_over(jp_cost cost, jp_cost least)
{
    if (cost <= least) {
        return JP_EPSILON_ONE;
    }
    const uint64_t ratio = least == 0U ? JP_BOUND_NONE : ((uint64_t)cost * JP_EPSILON_ONE + least - 1U) / least;
    return ratio < JP_BOUND_NONE ? (uint16_t)ratio : JP_BOUND_NONE;
}

static enum jp_answer answer_of(const struct jp_plan *plan)
{
    if (plan->cost_left > 0U) {
        return JP_ANSWER_PARTIAL;
    }
    return plan->bound == JP_EPSILON_ONE ? JP_ANSWER_OPTIMAL : JP_ANSWER_WITHIN_BOUND;
}

static void set_bound(struct jp_plan *plan, uint16_t bound)
{
    plan->bound = bound;
    plan->answer = answer_of(plan);
}

void jp_plan_publish(struct jp_planner_internal *planner, const struct jp_lattice_pose *end, jp_cost cost,
                     jp_cost cost_left, uint32_t steps)
{
    struct jp_plan *plan = &planner->plan;
    uint8_t *route = planner->spare_route;

    planner->spare_route = planner->route;
    planner->route = route;
    plan->start = planner->start;
    plan->end = *end;
    plan->cost = cost;
    plan->cost_left = cost_left;
    plan->step_count = (uint16_t)steps;
    planner->least = least_cost(planner);
    set_bound(plan, cost_left > 0U ? 0U : bound_over(cost, planner->least));
    plan->parameter_version = planner->config.lattice->version;
}

void jp_plan_set_optimal(struct jp_planner_internal *planner)
{
    planner->least = planner->plan.cost;
    set_bound(&planner->plan, JP_EPSILON_ONE);
}

void jp_plan_tighten(struct jp_planner_internal *planner)
{
    planner->least = least_cost(planner);
    if (planner->answer == JP_ANSWER_WITHIN_BOUND) {
        set_bound(&planner->plan, bound_over(planner->plan.cost, planner->least));
        planner->answer = planner->plan.answer;
    }
}

const struct jp_primitive *jp_plan_step(const struct jp_planner_internal *planner, unsigned index,
                                        struct jp_lattice_pose *pose)
{
    const struct jp_lattice *lattice = planner->config.lattice;

    if (index >= planner->plan.step_count) {
        return NULL;
    }
    const struct jp_primitive *primitive =
        &lattice->primitives[lattice->first_from[pose->heading] + planner->route[index]];
    pose->x = (int16_t)(pose->x + primitive->dx);
    pose->y = (int16_t)(pose->y + primitive->dy);
    pose->heading = primitive->end;
    return primitive;
}

/** Gives the plan its cost from the robot on, and the bound that is known of it. */
static void set_cost(struct jp_planner_internal *planner, jp_cost cost)
{
    planner->least = higher(planner->least, straight_bound(planner));
    planner->plan.cost = cost;
    set_bound(&planner->plan, bound_over(cost, planner->least));
}

bool jp_plan_follow(struct jp_planner_internal *planner)
{
    struct jp_plan *plan = &planner->plan;
    struct jp_lattice_pose pose = plan->start;
    unsigned steps = 0;
    jp_cost driven = 0;

    while (!jp_pose_is_same(&pose, &planner->start)) {
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *step = jp_plan_step(planner, steps, &pose);
        if (step == NULL) {
            return false;
        }
        driven = jp_cost_add(driven, jp_plan_step_cost(planner, &from, step));
        steps++;
    }
    plan->start = planner->start;
    plan->step_count = (uint16_t)(plan->step_count - steps);
    (void)memmove(planner->route, &planner->route[steps], plan->step_count);
    /* A route from the old start leads over the new one: what is left costs at least the rest of its bound. */
    planner->least = planner->least > driven ? planner->least - driven : 0U;
    set_cost(planner, plan->cost - driven);
    return true;
}

bool jp_plan_leads_to_goal(const struct jp_planner_internal *planner)
{
    const struct jp_plan *plan = &planner->plan;

    return (plan->answer == JP_ANSWER_OPTIMAL || plan->answer == JP_ANSWER_WITHIN_BOUND) &&
           jp_pose_is_goal(&planner->goal, &plan->end);
}

static void begin_tail(struct jp_planner_check *check)
{
    check->tail_pose = check->pose;
    check->tail_step = check->step;
    check->tail_cost = 0;
}

void jp_plan_begin_check(struct jp_planner_internal *planner)
{
    planner->check.pose = planner->plan.start;
    planner->check.step = 0;
    planner->check.head_steps = UINT32_MAX;
    begin_tail(&planner->check);
}

/** Adds the next step of the plan to the tail; one that is blocked ends it, and the next begins behind it. */
static void check_step(struct jp_planner_internal *planner, const struct jp_primitive *step,
                       const struct jp_lattice_pose *from)
{
    struct jp_planner_check *check = &planner->check;

    const jp_cost before = check->tail_cost;

    check->step++;
    check->tail_cost = jp_cost_add(check->tail_cost, jp_lattice_cost(planner->config.lattice, planner->config.cost,
                                                                     planner->terrain, step, from->x, from->y));
    if (check->tail_cost == JP_COST_MAX) {
        if (check->head_steps == UINT32_MAX) {
            check->head_steps = check->step - 1U;
            check->head_cost = before;
        }
        begin_tail(check);
    }
}

/** After a check of all steps. */
static void end_check(struct jp_planner_internal *planner)
{
    if (planner->check.tail_step > 0U || !jp_pose_is_same(&planner->plan.start, &planner->start)) {
        return;
    }
    set_cost(planner, planner->check.tail_cost);
    planner->plan.parameter_version = planner->config.lattice->version;
    planner->answer = planner->plan.answer;
}

bool jp_plan_check(struct jp_planner_internal *planner, unsigned *steps)
{
    struct jp_planner_check *check = &planner->check;

    while (*steps > 0U) {
        const struct jp_lattice_pose from = check->pose;
        const struct jp_primitive *step = jp_plan_step(planner, check->step, &check->pose);
        if (step == NULL) {
            end_check(planner);
            return true;
        }
        check_step(planner, step, &from);
        --*steps;
    }
    return false;
}
