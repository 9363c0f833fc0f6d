#include "src/search/planner_route.h"

#include <stddef.h>
#include <string.h>

#include "src/search/planner_search.h"
#include "src/search/planner_states.h"

/** The chain of best predecessors from a state towards the seed. */
struct trace {
    struct jp_lattice_pose end; /* where it ended */
    jp_cost cost;
    uint32_t steps;
    bool is_complete;
};

static uint8_t index_of(const struct jp_lattice *lattice, const struct jp_primitive *primitive)
{
    const ptrdiff_t index = primitive - &lattice->primitives[lattice->first_from[primitive->start]];

    return (uint8_t)index;
}

static struct jp_lattice_pose move(const struct jp_lattice_pose *pose, const struct jp_primitive *primitive,
                                   bool backward)
{
    const int32_t sign = backward ? -1 : 1;

    return (struct jp_lattice_pose){(int16_t)(pose->x + sign * primitive->dx),
                                    (int16_t)(pose->y + sign * primitive->dy),
                                    backward ? primitive->start : primitive->end};
}

static jp_cost cost_of(const struct jp_planner_internal *planner, const struct jp_lattice_pose *from,
                       const struct jp_primitive *primitive)
{
    return jp_lattice_energy(planner->config.lattice, planner->config.cost, planner->terrain, primitive, from->x,
                             from->y);
}

/** True where a trace ends: at the seed, or on the tail of the plan that the scout leads to. */
static bool is_end_of_trace(const struct jp_planner_internal *planner, const struct jp_lattice_pose *pose)
{
    return jp_search_is_seed(planner, pose) || (planner->is_splicing && jp_search_is_on_tail(planner, pose));
}

/** Follows the predecessors for at most steps_max steps. `route`, if not null, is written from its start on in a
 * backward search and from its end back in a forward one. */
static struct trace walk(const struct jp_planner_internal *planner, const struct jp_lattice_pose *from,
                         uint32_t steps_max, uint8_t *route, uint32_t route_steps)
{
    struct trace trace = {.end = *from};

    while (!is_end_of_trace(planner, &trace.end) && trace.steps < steps_max) {
        const struct search_predecessor before = jp_search_predecessor(planner, &trace.end);
        if (before.primitive == NULL) {
            return trace;
        }
        const struct jp_lattice_pose next = move(&trace.end, before.primitive, jp_search_is_forward(planner));
        trace.cost = jp_cost_add(
            trace.cost, cost_of(planner, jp_search_is_forward(planner) ? &next : &trace.end, before.primitive));
        if (route != NULL) {
            route[jp_search_is_forward(planner) ? route_steps - 1U - trace.steps : trace.steps] =
                index_of(planner->config.lattice, before.primitive);
        }
        trace.end = next;
        trace.steps++;
    }
    trace.is_complete = is_end_of_trace(planner, &trace.end);
    return trace;
}

/** Lower bound of any route from the robot to one of the goal's headings, obstacles left aside. */
static jp_cost straight_bound(const struct jp_planner_internal *planner)
{
    const struct jp_lattice_pose *start = &planner->start;
    const struct jp_goal *goal = &planner->goal;
    const int32_t rise = jp_terrain_elevation(planner->terrain, goal->x, goal->y) -
                         jp_terrain_elevation(planner->terrain, start->x, start->y);
    uint16_t turn = UINT16_MAX;

    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const uint16_t cost = planner->turns.cost[start->heading][heading];
        if (((goal->headings >> heading) & 1U) != 0U && cost < turn) {
            turn = cost;
        }
    }
    return jp_cost_add(jp_straight_bound(&planner->straight, goal->x - start->x, goal->y - start->y, rise), turn);
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

/** True when the present plan is for the same start, goal and map and costs no more: it stays then. */
static bool is_no_better(const struct jp_planner_internal *planner, jp_cost cost)
{
    return planner->answer == JP_ANSWER_WITHIN_BOUND && cost >= planner->plan.cost;
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

static void publish(struct jp_planner_internal *planner, const struct jp_lattice_pose *end, jp_cost cost,
                    jp_cost cost_left, uint32_t steps)
{
    struct jp_plan *plan = &planner->plan;

    plan->start = planner->start;
    plan->end = *end;
    plan->cost = cost;
    plan->cost_left = cost_left;
    plan->step_count = (uint16_t)steps;
    planner->least = least_cost(planner);
    set_bound(plan, cost_left > 0U ? 0U : bound_over(cost, planner->least));
    plan->parameter_version = planner->config.lattice->version;
}

static void take_spare_route(struct jp_planner_internal *planner)
{
    uint8_t *route = planner->spare_route;

    planner->spare_route = planner->route;
    planner->route = route;
}

static bool is_same_pose(const struct jp_lattice_pose *a, const struct jp_lattice_pose *b)
{
    return a->x == b->x && a->y == b->y && a->heading == b->heading;
}

/** Appends the plan's steps from where the trace has met its tail. False when they do not fit. */
static bool append_tail(struct jp_planner_internal *planner, struct trace *trace)
{
    struct jp_lattice_pose pose = planner->check.tail_pose;
    jp_cost cost = planner->check.tail_cost;
    uint32_t step = planner->check.tail_step;

    if (jp_search_is_seed(planner, &trace->end)) {
        return true;
    }
    while (!is_same_pose(&pose, &trace->end)) {
        const struct jp_lattice_pose from = pose;
        cost -= cost_of(planner, &from, jp_plan_step(planner, step, &pose));
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

/** Publishes the plan's head up to the junction, the way from there to its tail, and the tail. */
static bool publish_splice(struct jp_planner_internal *planner)
{
    const uint32_t steps = planner->head.first_step + planner->head.junction;
    struct jp_lattice_pose junction = planner->start;
    jp_cost cost = 0;

    for (uint32_t i = 0; i < steps; i++) {
        const struct jp_lattice_pose from = junction;
        cost = jp_cost_add(cost, cost_of(planner, &from, jp_plan_step(planner, i, &junction)));
    }
    struct trace trace = walk(planner, &junction, planner->route_max - steps, &planner->spare_route[steps], 0);

    trace.cost = jp_cost_add(trace.cost, cost);
    trace.steps += steps;
    if (!trace.is_complete || !append_tail(planner, &trace)) {
        return false;
    }
    (void)memcpy(planner->spare_route, planner->route, steps);
    take_spare_route(planner);
    publish(planner, &trace.end, trace.cost, 0, trace.steps);
    return true;
}

/** Publishes the route from the robot on, cut where the route's memory ends. */
static bool publish_backward(struct jp_planner_internal *planner)
{
    const struct trace trace = walk(planner, &planner->start, planner->route_max, planner->spare_route, 0);

    if (!trace.is_complete && trace.steps < planner->route_max) {
        return false;
    }
    if (trace.is_complete && is_no_better(planner, trace.cost)) {
        return true;
    }
    take_spare_route(planner);
    publish(planner, &trace.end, trace.cost, trace.is_complete ? 0U : jp_search_predecessor(planner, &trace.end).cost,
            trace.steps);
    return true;
}

/** Estimate from the end of a partial route to the goal: at least 1, also where the guide is too coarse to see it. */
static jp_cost estimate_left(const struct jp_planner_internal *planner, const struct jp_lattice_pose *end)
{
    const jp_cost left = jp_search_heuristic(planner, end);

    return left > 0U ? left : 1U;
}

/** Publishes the route to the goal, or to the state with the least heuristic, cut at its far end where the route's
 * memory ends. */
static bool publish_forward(struct jp_planner_internal *planner)
{
    const uint32_t target = jp_search_target(planner);
    const bool arrived = target != NO_SLOT && planner->search.states[target].g != JP_COST_MAX;
    const uint32_t slot = arrived ? target : planner->search.nearest;

    if (slot == NO_SLOT) {
        return false;
    }
    struct jp_lattice_pose end = jp_search_pose(planner, slot);
    struct trace trace = walk(planner, &end, planner->search.state_count_max, NULL, 0);
    if (!trace.is_complete) {
        return false;
    }
    const bool is_cut = trace.steps > planner->route_max;
    if (is_cut) {
        end = walk(planner, &end, trace.steps - planner->route_max, NULL, 0).end;
        trace = walk(planner, &end, planner->route_max, NULL, 0);
    }
    (void)walk(planner, &end, trace.steps, planner->spare_route, trace.steps);
    take_spare_route(planner);
    publish(planner, &end, trace.cost, arrived && !is_cut ? 0U : estimate_left(planner, &end), trace.steps);
    return true;
}

bool jp_plan_publish(struct jp_planner_internal *planner, bool is_optimal)
{
    if (jp_search_is_forward(planner)) {
        return publish_forward(planner);
    }
    if (planner->is_splicing) {
        return publish_splice(planner);
    }
    if (!publish_backward(planner)) {
        return false;
    }
    if (is_optimal && planner->plan.cost_left == 0U) {
        planner->least = planner->plan.cost;
        set_bound(&planner->plan, JP_EPSILON_ONE);
    }
    return true;
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

    while (!is_same_pose(&pose, &planner->start)) {
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *step = jp_plan_step(planner, steps, &pose);
        if (step == NULL) {
            return false;
        }
        driven = jp_cost_add(driven, cost_of(planner, &from, step));
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
           jp_search_is_goal(planner, &plan->end);
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

    check->step++;
    check->tail_cost = jp_cost_add(check->tail_cost, jp_lattice_cost(planner->config.lattice, planner->config.cost,
                                                                     planner->terrain, step, from->x, from->y));
    if (check->tail_cost == JP_COST_MAX) {
        check->head_steps = check->head_steps < check->step ? check->head_steps : check->step - 1U;
        begin_tail(check);
    }
}

/** After a check of all steps. */
static enum plan_check end_check(struct jp_planner_internal *planner)
{
    if (planner->check.tail_step > 0U || !is_same_pose(&planner->plan.start, &planner->start)) {
        return PLAN_BROKEN;
    }
    set_cost(planner, planner->check.tail_cost);
    planner->plan.parameter_version = planner->config.lattice->version;
    return PLAN_INTACT;
}

enum plan_check jp_plan_check(struct jp_planner_internal *planner, unsigned *steps)
{
    struct jp_planner_check *check = &planner->check;

    while (*steps > 0U) {
        const struct jp_lattice_pose from = check->pose;
        const struct jp_primitive *step = jp_plan_step(planner, check->step, &check->pose);
        if (step == NULL) {
            return end_check(planner);
        }
        check_step(planner, step, &from);
        --*steps;
    }
    return PLAN_CHECKING;
}

/** The states before what is blocked; where the robot has left the plan, its own alone. */
static void begin_head(struct jp_planner_internal *planner)
{
    struct jp_planner_head *head = &planner->head;
    struct jp_lattice_pose pose = planner->plan.start;
    const bool is_on_plan = is_same_pose(&pose, &planner->start);
    const uint32_t steps = is_on_plan ? planner->check.head_steps : 0U;

    pose = planner->start;
    head->first_step = steps > JP_PLANNER_SPLICE_STEPS ? steps - JP_PLANNER_SPLICE_STEPS : 0U;
    head->count = 0;
    for (uint32_t step = 0; step <= steps; step++) {
        if (step >= head->first_step) {
            head->ids[head->count] = jp_search_id(planner, pose.x, pose.y, pose.heading);
            head->count++;
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
        cost -= cost_of(planner, &from, primitive);
        step++;
    }
}

void jp_plan_begin_splice(struct jp_planner_internal *planner)
{
    begin_head(planner);
    seed_tail(planner);
}
