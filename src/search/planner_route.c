#include "src/search/planner_route.h"

#include <stddef.h>

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

/** Follows the predecessors for at most steps_max steps. `route`, if not null, is written from its start on in a
 * backward search and from its end back in a forward one. */
static struct trace walk(const struct jp_planner_internal *planner, const struct jp_lattice_pose *from,
                         uint32_t steps_max, uint8_t *route, uint32_t route_steps)
{
    struct trace trace = {.end = *from};

    while (!jp_search_is_seed(planner, &trace.end) && trace.steps < steps_max) {
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
    trace.is_complete = jp_search_is_seed(planner, &trace.end);
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
    return jp_cost_add(jp_lattice_straight_bound(planner->config.lattice, planner->config.cost, goal->x - start->x,
                                                 goal->y - start->y, rise),
                       turn);
}

/** The proved bound of a route of this cost: 1 after an exact search, else the ratio to the straight-line bound. */
static uint16_t proved_bound(const struct jp_planner_internal *planner, jp_cost cost)
{
    const jp_cost least = straight_bound(planner);

    if (jp_search_is_exact(planner) || cost <= least) {
        return JP_EPSILON_ONE;
    }
    const uint64_t ratio = least == 0U ? JP_BOUND_NONE : ((uint64_t)cost * JP_EPSILON_ONE + least - 1U) / least;
    return ratio < JP_BOUND_NONE ? (uint16_t)ratio : JP_BOUND_NONE;
}

/** True when the present plan is for the same start, goal and map and costs less: it stays then. */
static bool is_worse(const struct jp_planner_internal *planner, jp_cost cost)
{
    return planner->answer == JP_ANSWER_WITHIN_BOUND && !jp_search_is_exact(planner) && cost >= planner->plan.cost;
}

static enum jp_answer answer_of(const struct jp_plan *plan)
{
    if (plan->cost_left > 0U) {
        return JP_ANSWER_PARTIAL;
    }
    return plan->bound == JP_EPSILON_ONE ? JP_ANSWER_OPTIMAL : JP_ANSWER_WITHIN_BOUND;
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
    plan->bound = cost_left > 0U ? 0U : proved_bound(planner, cost);
    plan->answer = answer_of(plan);
    plan->parameter_version = planner->config.lattice->version;
}

static void take_spare_route(struct jp_planner_internal *planner)
{
    uint8_t *route = planner->spare_route;

    planner->spare_route = planner->route;
    planner->route = route;
}

/** Publishes the route from the robot on, cut where the route's memory ends. */
static bool publish_backward(struct jp_planner_internal *planner)
{
    const struct trace trace = walk(planner, &planner->start, planner->route_max, planner->spare_route, 0);

    if (!trace.is_complete && trace.steps < planner->route_max) {
        return false;
    }
    if (trace.is_complete && is_worse(planner, trace.cost)) {
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
    const bool arrived = target != NO_SLOT && planner->states[target].g != JP_COST_MAX;
    const uint32_t slot = arrived ? target : planner->nearest;

    if (slot == NO_SLOT) {
        return false;
    }
    struct jp_lattice_pose end = jp_search_pose(planner, slot);
    struct trace trace = walk(planner, &end, planner->statistics.states_max, NULL, 0);
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

bool jp_plan_publish(struct jp_planner_internal *planner)
{
    return jp_search_is_forward(planner) ? publish_forward(planner) : publish_backward(planner);
}

static bool is_same_pose(const struct jp_lattice_pose *a, const struct jp_lattice_pose *b)
{
    return a->x == b->x && a->y == b->y && a->heading == b->heading;
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

bool jp_plan_is_intact(const struct jp_planner_internal *planner)
{
    const struct jp_lattice_pose *start = &planner->start;
    const uint32_t slot = jp_planner_states_find(planner, jp_search_id(planner, start->x, start->y, start->heading));
    struct jp_lattice_pose pose = planner->plan.start;
    bool is_ahead = is_same_pose(&pose, start);
    jp_cost cost = 0;

    for (unsigned i = 0; i < planner->plan.step_count; i++) {
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *step = jp_plan_step(planner, i, &pose);
        if (is_ahead) {
            cost = jp_cost_add(cost, jp_lattice_cost(planner->config.lattice, planner->config.cost, planner->terrain,
                                                     step, from.x, from.y));
        }
        is_ahead = is_ahead || is_same_pose(&pose, start);
    }
    return is_ahead && slot != NO_SLOT && cost == planner->states[slot].g;
}
