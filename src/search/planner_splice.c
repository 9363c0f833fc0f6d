#include "src/search/planner_splice.h"

#include <stddef.h>
#include <string.h>

#include "src/search/planner_pose.h"
#include "src/search/planner_route.h"
#include "src/search/planner_search.h"

/** The states before what is blocked; where the robot has left the plan, its own alone. */
static void begin_head(struct jp_planner_internal *planner)
{
    struct jp_planner_head *head = &planner->head;
    struct jp_lattice_pose pose = planner->start;
    const bool is_on_plan = jp_pose_is_same(&planner->plan.start, &pose);

    head->start_id = jp_search_id(planner, pose.x, pose.y, pose.heading);
    head->steps = is_on_plan ? planner->check.head_steps : 0U;
    head->cost = is_on_plan ? planner->check.head_cost : 0U;
    head->first_step = head->steps > JP_PLANNER_SPLICE_STEPS ? head->steps - JP_PLANNER_SPLICE_STEPS : 0U;
    for (uint32_t step = 0; step <= head->steps; step++) {
        if (step >= head->first_step) {
            head->ids[step - head->first_step] = jp_search_id(planner, pose.x, pose.y, pose.heading);
        }
        (void)jp_plan_step(planner, step, &pose);
    }
}

static void seed_tail(struct jp_planner_internal *planner)
{
    struct jp_lattice_pose pose = planner->check.tail_pose;
    jp_cost cost = planner->check.tail_cost;
    uint32_t step = planner->check.tail_step;

    for (uint32_t count = 0; count <= JP_PLANNER_SPLICE_STEPS; count++) {
        jp_search_seed_tail(planner, &pose, cost);
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *primitive = jp_plan_step(planner, step, &pose);
        if (primitive == NULL) {
            return;
        }
        cost -= jp_plan_step_cost(planner, &from, primitive);
        step++;
    }
}

void jp_splice_begin(struct jp_planner_internal *planner)
{
    begin_head(planner);
    seed_tail(planner);
}

struct jp_lattice_pose jp_splice_junction(const struct jp_planner_internal *planner)
{
    const struct jp_planner_head *head = &planner->head;

    return head->junction_step == 0U ? planner->start
                                     : jp_search_pose_of(planner, head->ids[head->junction_step - head->first_step]);
}

/** Cost of the head's steps before the junction. */
static jp_cost cost_before_junction(const struct jp_planner_internal *planner)
{
    const struct jp_planner_head *head = &planner->head;
    struct jp_lattice_pose pose = jp_splice_junction(planner);
    jp_cost cost = head->cost;

    if (head->junction_step == 0U) {
        return 0;
    }
    for (uint32_t step = head->junction_step; step < head->steps; step++) {
        const struct jp_lattice_pose from = pose;
        cost -= jp_plan_step_cost(planner, &from, jp_plan_step(planner, step, &pose));
    }
    return cost;
}

/** Appends the plan's steps from where the trace has met its tail. False when they do not fit. */
static bool append_tail(struct jp_planner_internal *planner)
{
    struct jp_planner_trace *trace = &planner->trace;
    struct jp_lattice_pose pose = planner->check.tail_pose;
    jp_cost cost = planner->check.tail_cost;
    uint32_t step = planner->check.tail_step;

    if (jp_search_is_seed(planner, &trace->end)) {
        return true;
    }
    while (!jp_pose_is_same(&pose, &trace->end)) {
        const struct jp_lattice_pose from = pose;
        cost -= jp_plan_step_cost(planner, &from, jp_plan_step(planner, step, &pose));
        step++;
    }
    const uint32_t count = planner->plan.step_count - step;
    if (trace->steps + count > planner->route_max) {
        return false;
    }
    (void)memcpy(&planner->spare_route[trace->steps], &planner->route[step], count);
    trace->cost = jp_cost_add(trace->cost, cost);
    trace->steps += count;
    trace->end = planner->plan.end;
    return true;
}

bool jp_splice_is_on_tail(const struct jp_planner_internal *planner, const struct jp_lattice_pose *pose)
{
    struct jp_lattice_pose tail = planner->check.tail_pose;

    for (uint32_t i = 0; i < JP_PLANNER_SPLICE_STEPS && !jp_pose_is_same(&tail, pose); i++) {
        if (jp_plan_step(planner, planner->check.tail_step + i, &tail) == NULL) {
            break;
        }
    }
    return jp_pose_is_same(&tail, pose);
}

bool jp_splice_join(struct jp_planner_internal *planner)
{
    struct jp_planner_trace *trace = &planner->trace;

    (void)memcpy(planner->spare_route, planner->route, planner->head.junction_step);
    trace->cost = jp_cost_add(trace->cost, cost_before_junction(planner));
    return append_tail(planner);
}
