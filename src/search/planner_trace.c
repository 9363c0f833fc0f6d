#include "src/search/planner_trace.h"

#include <stddef.h>

#include "src/search/planner_pose.h"
#include "src/search/planner_route.h"
#include "src/search/planner_search.h"
#include "src/search/planner_splice.h"
#include "src/search/planner_states.h"

static void begin_stage(struct jp_planner_internal *planner, enum jp_planner_trace_stage stage,
                        struct jp_lattice_pose from, uint32_t steps_max)
{
    struct jp_planner_trace *trace = &planner->trace;

    trace->stage = stage;
    trace->begin = from;
    trace->end = from;
    trace->cost = 0;
    trace->steps = 0;
    trace->steps_max = steps_max;
}

/** Where the route of a search from the robot ends: at the goal, or at the state with the least heuristic. */
static uint32_t end_of_forward_route(const struct jp_planner_internal *planner)
{
    const uint32_t target = jp_search_target(planner);
    const bool has_arrived = target != NO_SLOT && planner->search.states[target].g != JP_COST_MAX;

    return has_arrived ? target : planner->search.nearest;
}

static bool begin_forward(struct jp_planner_internal *planner)
{
    const uint32_t slot = end_of_forward_route(planner);

    if (slot == NO_SLOT) {
        return false;
    }
    begin_stage(planner, JP_PLANNER_COUNT_STEPS, jp_search_pose(planner, slot), planner->search.state_count_max);
    return true;
}

bool jp_trace_begin(struct jp_planner_internal *planner, bool has_ended)
{
    planner->trace.has_ended = has_ended;
    if (jp_search_is_forward(planner)) {
        return begin_forward(planner);
    }
    begin_stage(planner, JP_PLANNER_WRITE_STEPS, planner->start, planner->route_max);
    if (planner->is_splicing) {
        planner->trace.end = jp_splice_junction(planner);
        planner->trace.steps = planner->head.junction_step;
    }
    return true;
}

/** True at the seed, and on the tail of the plan that a splice leads to. */
static bool is_at_end(const struct jp_planner_internal *planner)
{
    const struct jp_lattice_pose *pose = &planner->trace.end;

    return jp_search_is_seed(planner, pose) || (planner->is_splicing && jp_splice_is_on_tail(planner, pose));
}

static uint8_t index_of(const struct jp_lattice *lattice, const struct jp_primitive *primitive)
{
    const ptrdiff_t index = primitive - &lattice->primitives[lattice->first_from[primitive->start]];

    return (uint8_t)index;
}

/** Goes on to the best predecessor. False when there is none. */
static bool follow_step(struct jp_planner_internal *planner)
{
    struct jp_planner_trace *trace = &planner->trace;
    const bool backward = jp_search_is_forward(planner); /* against the way of the robot */
    const struct jp_primitive *primitive = jp_search_predecessor(planner, &trace->end).primitive;

    if (primitive == NULL) {
        return false;
    }
    const int32_t sign = backward ? -1 : 1;
    const struct jp_lattice_pose next = {(int16_t)(trace->end.x + sign * primitive->dx),
                                         (int16_t)(trace->end.y + sign * primitive->dy),
                                         backward ? primitive->start : primitive->end};

    trace->cost = jp_cost_add(trace->cost, jp_plan_step_cost(planner, backward ? &next : &trace->end, primitive));
    if (trace->stage == JP_PLANNER_WRITE_STEPS) {
        planner->spare_route[backward ? trace->route_steps - 1U - trace->steps : trace->steps] =
            index_of(planner->config.lattice, primitive);
    }
    trace->end = next;
    trace->steps++;
    return true;
}

/** True when the present plan is for the same start, goal and map and costs no more: it stays then. */
static bool is_no_better(const struct jp_planner_internal *planner)
{
    return planner->answer == JP_ANSWER_WITHIN_BOUND && planner->trace.cost >= planner->plan.cost;
}

/** The route from the robot on, cut where its memory ends. */
static void publish_backward(struct jp_planner_internal *planner)
{
    const struct jp_planner_trace *trace = &planner->trace;
    const bool is_whole = is_at_end(planner);

    if (!is_whole || !is_no_better(planner)) {
        jp_plan_publish(planner, &trace->end, trace->cost,
                        is_whole ? 0U : jp_search_predecessor(planner, &trace->end).cost, trace->steps);
    }
    if (is_whole && trace->has_ended && jp_search_is_exact(planner)) {
        jp_plan_set_optimal(planner);
    }
}

/** Estimate from the end of a partial route to the goal: at least 1, also where the guide is too coarse to see it. */
static jp_cost estimate_left(const struct jp_planner_internal *planner, const struct jp_lattice_pose *end)
{
    const jp_cost left = jp_search_heuristic(planner, end);

    return left > 0U ? left : 1U;
}

/** The route to the goal, or to the state with the least heuristic, cut at its far end where the memory ends; that is
 * worth less than any whole one. */
static void publish_forward(struct jp_planner_internal *planner)
{
    const struct jp_planner_trace *trace = &planner->trace;
    const struct jp_lattice_pose end = trace->begin;
    const bool is_whole = jp_pose_is_goal(&planner->goal, &end);

    if (is_whole ? is_no_better(planner) : jp_plan_is_current(planner)) {
        return;
    }

    jp_plan_publish(planner, &end, trace->cost, is_whole ? 0U : estimate_left(planner, &end), trace->steps);
}

static enum trace_result end_writing(struct jp_planner_internal *planner)
{
    const struct jp_planner_trace *trace = &planner->trace;

    if (jp_search_is_forward(planner)) {
        publish_forward(planner);
    } else if (!planner->is_splicing) {
        publish_backward(planner);
    } else if (is_at_end(planner) && jp_splice_join(planner)) {
        jp_plan_publish(planner, &trace->end, trace->cost, 0, trace->steps);
    } else {
        return TRACE_FAILED;
    }
    return TRACE_PUBLISHED;
}

/** Goes on to the next stage, or ends the last one. */
static enum trace_result end_stage(struct jp_planner_internal *planner)
{
    struct jp_planner_trace *trace = &planner->trace;

    switch (trace->stage) {
    case JP_PLANNER_COUNT_STEPS:
        trace->route_steps = trace->steps < planner->route_max ? trace->steps : planner->route_max;
        begin_stage(planner, JP_PLANNER_SKIP_STEPS, trace->begin, trace->steps - trace->route_steps);
        return TRACE_WORKING;
    case JP_PLANNER_SKIP_STEPS:
        begin_stage(planner, JP_PLANNER_WRITE_STEPS, trace->end, trace->route_steps);
        return TRACE_WORKING;
    case JP_PLANNER_WRITE_STEPS:
    default:
        return end_writing(planner);
    }
}

enum trace_result jp_trace_work(struct jp_planner_internal *planner, unsigned *steps)
{
    const struct jp_planner_trace *trace = &planner->trace;
    enum trace_result result = TRACE_WORKING;

    while (result == TRACE_WORKING && *steps > 0U) {
        if (is_at_end(planner) || trace->steps >= trace->steps_max) {
            result = end_stage(planner);
        } else {
            result = follow_step(planner) ? TRACE_WORKING : TRACE_FAILED;
        }
        --*steps;
    }
    return result;
}
