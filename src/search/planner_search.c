#include "src/search/planner_search.h"

#include "src/search/planner_fields.h"
#include "src/search/planner_head.h"
#include "src/search/planner_pose.h"
#include "src/search/planner_rehearsal.h"
#include "src/search/planner_states.h"

enum {
    EPSILON_BITS = 8,
    RANGE_PER_TARGET = 2, /* the buckets resolve keys up to so many times the expected one of the target */
};

uint32_t jp_search_id(const struct jp_planner_internal *planner, int32_t x, int32_t y, unsigned heading)
{
    return ((uint32_t)y * planner->terrain->config.width + (uint32_t)x) * JP_HEADINGS + heading;
}

struct jp_lattice_pose jp_search_pose_of(const struct jp_planner_internal *planner, uint32_t id)
{
    const uint32_t cell = id / JP_HEADINGS;
    const uint32_t width = planner->terrain->config.width;

    return (struct jp_lattice_pose){(int16_t)(cell % width), (int16_t)(cell / width), (uint8_t)(id % JP_HEADINGS)};
}

struct jp_lattice_pose jp_search_pose(const struct jp_planner_internal *planner, uint32_t slot)
{
    return jp_search_pose_of(planner, (uint32_t)planner->search.states[slot].id);
}

static uint32_t start_id(const struct jp_planner_internal *planner)
{
    return jp_search_id(planner, planner->start.x, planner->start.y, planner->start.heading);
}

bool jp_search_is_seed(const struct jp_planner_internal *planner, const struct jp_lattice_pose *pose)
{
    return jp_search_is_forward(planner) ? jp_pose_is_same(&planner->start, pose)
                                         : jp_pose_is_goal(&planner->goal, pose);
}

jp_cost jp_search_heuristic(const struct jp_planner_internal *planner, const struct jp_lattice_pose *pose)
{
    return jp_search_is_exact(planner) ? jp_fields_bound(planner, pose)
                                       : jp_guide_field_estimate(&planner->guide, pose->x, pose->y, pose->heading);
}

static uint32_t inflate(const struct jp_planner_internal *planner, jp_cost heuristic)
{
    return (uint32_t)(((uint64_t)heuristic * planner->search.epsilon) >> EPSILON_BITS);
}

/** Width of a bucket, in keys: the queue does not order the keys within one. */
static uint32_t bucket_width(const struct jp_planner_internal *planner)
{
    return UINT32_C(1) << planner->search.bucket_shift;
}

/** Key of a state: min(g, rhs) + ε·h when it is overconsistent. An underconsistent state (g < rhs) must be expanded
 * before all states whose cost it determines, or these would raise each other step by step. So its key uses an
 * admissible heuristic, the bound, or 0 without one, and the keys of overconsistent states are one bucket higher. */
static uint32_t key_of(const struct jp_planner_internal *planner, const struct jp_planner_state *state,
                       jp_cost heuristic)
{
    if (state->g > state->rhs) {
        return (uint32_t)state->rhs + inflate(planner, heuristic) + bucket_width(planner);
    }
    return (uint32_t)state->g + (jp_search_is_exact(planner) ? heuristic : 0U);
}

/** True for a state that must not be expanded now: one that was expanded at this ε by an inflated heuristic and has
 * become cheaper since waits for the next ε (the INCONS list of AD*); one that the robot cannot reach waits until it
 * can. */
static bool is_waiting(const struct jp_planner_internal *planner, const struct jp_planner_state *state,
                       jp_cost heuristic)
{
    return jp_search_is_exact(planner) ? heuristic == JP_COST_MAX : state->closed && state->g > state->rhs;
}

/** Puts a state into the open list with its present key if it is inconsistent; else takes it out. */
static void update(struct jp_planner_internal *planner, uint32_t slot, jp_cost heuristic)
{
    const struct jp_planner_state *state = &planner->search.states[slot];

    if (slot >= planner->search.rekey_slot) {
        return;
    }
    if (state->g != state->rhs && !is_waiting(planner, state, heuristic)) {
        jp_planner_queue_put(&planner->search, slot, key_of(planner, state, heuristic));
    } else {
        jp_planner_queue_remove(&planner->search, slot);
    }
}

/** A primitive between a state and its neighbour. */
struct edge {
    const struct jp_primitive *primitive;
    struct jp_lattice_pose from; /* where the robot starts to drive it */
    struct jp_lattice_pose other;
};

/** Range of the primitives that leave a heading, or arrive at it. */
static unsigned first_edge(const struct jp_lattice *lattice, bool leaving, unsigned heading)
{
    return leaving ? lattice->first_from[heading] : lattice->first_to[heading];
}

/** Edge `index` of a pose. False when its other end is off the map. */
static bool edge_at(const struct jp_planner_internal *planner, const struct jp_lattice_pose *pose, bool leaving,
                    unsigned index, struct edge *edge)
{
    const struct jp_lattice *lattice = planner->config.lattice;
    const struct jp_primitive *primitive = &lattice->primitives[leaving ? index : lattice->by_end[index]];
    const int32_t sign = leaving ? 1 : -1;
    const int32_t x = pose->x + sign * primitive->dx;
    const int32_t y = pose->y + sign * primitive->dy;

    edge->primitive = primitive;
    edge->other = (struct jp_lattice_pose){(int16_t)x, (int16_t)y, leaving ? primitive->end : primitive->start};
    edge->from = leaving ? *pose : edge->other;
    return jp_terrain_contains(planner->terrain, x, y);
}

static bool is_edge_clear(const struct jp_planner_internal *planner, const struct edge *edge)
{
    return jp_lattice_is_clear(planner->config.lattice, planner->terrain, edge->primitive, edge->from.x, edge->from.y);
}

/** Obstacles left aside: most edges are too dear to matter, and need no look at what they sweep. */
static jp_cost edge_energy(const struct jp_planner_internal *planner, const struct edge *edge)
{
    return jp_lattice_energy(planner->config.lattice, planner->config.cost, planner->terrain, edge->primitive,
                             edge->from.x, edge->from.y);
}

static void note_edge(struct jp_planner_internal *planner, jp_cost from, jp_cost to)
{
    if (to - from > planner->search.edge_max) {
        planner->search.edge_max = to - from;
    }
}

struct search_predecessor jp_search_predecessor(const struct jp_planner_internal *planner,
                                                const struct jp_lattice_pose *pose)
{
    const struct jp_lattice *lattice = planner->config.lattice;
    const bool leaving = !jp_search_is_forward(planner);
    const unsigned end = first_edge(lattice, leaving, pose->heading + 1U);
    struct search_predecessor best = {JP_COST_MAX, JP_COST_MAX, NULL};

    for (unsigned i = first_edge(lattice, leaving, pose->heading); i < end; i++) {
        struct edge edge;
        if (!edge_at(planner, pose, leaving, i, &edge)) {
            continue;
        }
        const uint32_t slot = jp_planner_states_find(
            &planner->search, jp_search_id(planner, edge.other.x, edge.other.y, edge.other.heading));
        if (slot == NO_SLOT || planner->search.states[slot].g >= best.cost) {
            continue;
        }
        const jp_cost cost = jp_cost_add((jp_cost)planner->search.states[slot].g, edge_energy(planner, &edge));
        if (cost < best.cost && is_edge_clear(planner, &edge)) {
            best = (struct search_predecessor){cost, (jp_cost)planner->search.states[slot].g, edge.primitive};
        }
    }
    return best;
}

static void set_rhs(struct jp_planner_internal *planner, uint32_t slot, const struct jp_lattice_pose *pose, jp_cost rhs)
{
    planner->search.states[slot].rhs = rhs & JP_COST_MAX;
    update(planner, slot, jp_search_heuristic(planner, pose));
}

/** Cost over the best neighbour. */
static jp_cost lookahead(struct jp_planner_internal *planner, const struct jp_lattice_pose *pose)
{
    const struct search_predecessor best = jp_search_predecessor(planner, pose);

    if (best.primitive != NULL) {
        note_edge(planner, best.from, best.cost);
    }
    return best.cost;
}

static void recompute(struct jp_planner_internal *planner, uint32_t slot, const struct jp_lattice_pose *pose)
{
    if (!jp_search_is_seed(planner, pose)) {
        set_rhs(planner, slot, pose, lookahead(planner, pose));
    }
}

/** Relaxes a neighbour of a state whose cost fell to `g`. */
static void relax(struct jp_planner_internal *planner, const struct edge *edge, jp_cost g)
{
    const uint32_t id = jp_search_id(planner, edge->other.x, edge->other.y, edge->other.heading);
    const uint32_t known = jp_planner_states_find(&planner->search, id);

    if (known != NO_SLOT && planner->search.states[known].rhs <= g) {
        return;
    }
    const jp_cost cost = jp_cost_add(g, edge_energy(planner, edge));
    if (cost == JP_COST_MAX || (known != NO_SLOT && planner->search.states[known].rhs <= cost) ||
        !is_edge_clear(planner, edge)) {
        return;
    }
    note_edge(planner, g, cost);
    set_rhs(planner, known != NO_SLOT ? known : jp_planner_states_add(&planner->search, id), &edge->other, cost);
}

/** Recomputes rhs of a neighbour whose best predecessor was the state before its cost rose from `old_g`. */
static void withdraw(struct jp_planner_internal *planner, const struct edge *edge, jp_cost old_g)
{
    const uint32_t slot = jp_planner_states_find(
        &planner->search, jp_search_id(planner, edge->other.x, edge->other.y, edge->other.heading));

    if (slot == NO_SLOT || planner->search.states[slot].rhs < old_g ||
        planner->search.states[slot].rhs == JP_COST_MAX) {
        return;
    }
    /* An edge that is blocked by now counts, too: to recompute is right for any state. */
    if (planner->search.states[slot].rhs == jp_cost_add(old_g, edge_energy(planner, edge))) {
        recompute(planner, slot, &edge->other);
    }
}

/** Keeps the expanded state with the least heuristic: a partial route ends there. */
static void note_nearest(struct jp_planner_internal *planner, uint32_t slot, jp_cost heuristic)
{
    if (planner->search.nearest == NO_SLOT || heuristic < planner->search.nearest_heuristic) {
        planner->search.nearest = slot;
        planner->search.nearest_heuristic = heuristic;
    }
}

static void expand(struct jp_planner_internal *planner, uint32_t slot)
{
    const struct jp_lattice *lattice = planner->config.lattice;
    struct jp_planner_state *state = &planner->search.states[slot];
    const struct jp_lattice_pose pose = jp_search_pose_of(planner, (uint32_t)state->id);
    const bool leaving = jp_search_is_forward(planner);
    const bool cheaper = state->g > state->rhs;
    const jp_cost g = (jp_cost)(cheaper ? state->rhs : state->g);
    const unsigned end = first_edge(lattice, leaving, pose.heading + 1U);
    const jp_cost heuristic = jp_search_heuristic(planner, &pose);

    planner->statistics.expansions++;
    state->g = cheaper ? state->rhs : JP_COST_MAX;
    state->closed = cheaper;
    update(planner, slot, heuristic);
    if (cheaper) {
        note_nearest(planner, slot, heuristic);
    }
    for (unsigned i = first_edge(lattice, leaving, pose.heading); i < end; i++) {
        struct edge edge;
        if (!edge_at(planner, &pose, leaving, i, &edge)) {
            continue;
        }
        if (cheaper) {
            relax(planner, &edge, g);
        } else {
            withdraw(planner, &edge, g);
        }
    }
}

uint32_t jp_search_target(const struct jp_planner_internal *planner)
{
    uint32_t best = NO_SLOT;

    if (!jp_search_is_forward(planner)) {
        return jp_planner_states_find(&planner->search, start_id(planner));
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const uint32_t slot = ((planner->goal.headings >> heading) & 1U) != 0U
                                  ? jp_planner_states_find(&planner->search, jp_search_id(planner, planner->goal.x,
                                                                                          planner->goal.y, heading))
                                  : NO_SLOT;
        if (slot != NO_SLOT && (best == NO_SLOT || planner->search.states[slot].g < planner->search.states[best].g)) {
            best = slot;
        }
    }
    return best;
}

/** The key above which an inconsistent state cannot lower the cost of the target. */
static uint32_t target_key(const struct jp_planner_internal *planner, uint32_t slot)
{
    const struct jp_lattice_pose pose = jp_search_pose(planner, slot);

    return (uint32_t)planner->search.states[slot].g + inflate(planner, jp_search_heuristic(planner, &pose)) +
           bucket_width(planner);
}

/** True when the target's cost is final for this ε. A target that became cheaper after its expansion waits for the next
 * ε; its route is there all the same. */
static bool is_arrived(const struct jp_planner_internal *planner, uint32_t target)
{
    const struct jp_planner_state *state = &planner->search.states[target];
    const bool is_settled = state->g == state->rhs || (state->closed && state->g > state->rhs);

    return state->g != JP_COST_MAX && is_settled &&
           jp_planner_queue_lowest_key(&planner->search) > target_key(planner, target);
}

bool jp_search_has_arrived(struct jp_planner_internal *planner)
{
    const uint32_t target = jp_search_target(planner);

    (void)jp_planner_queue_top(&planner->search);
    return target != NO_SLOT && is_arrived(planner, target);
}

/** True when a search that has raised no costs has reached the robot, and no route is published yet. */
static bool is_first_route(const struct jp_planner_internal *planner)
{
    return !planner->search.is_repaired && !planner->is_splicing && !jp_search_is_forward(planner) &&
           jp_rehearsal_awaits_route(planner);
}

static bool has_cost(const struct jp_planner_internal *planner, uint32_t slot)
{
    return slot != NO_SLOT && planner->search.states[slot].g != JP_COST_MAX;
}

static bool is_full(const struct jp_planner_internal *planner)
{
    const struct jp_planner_search *search = &planner->search;

    return search->state_count_max - search->state_count < planner->neighbours_max;
}

jp_cost jp_search_least_cost(const struct jp_planner_internal *planner)
{
    if (!planner->is_field_rooted || !planner->are_fields_grown || planner->changes.may_be_cheaper) {
        return 0;
    }
    /* All bounds are from the field's root; the robot has driven on since, and is at least as near to the goal as the
     * root is, less the way from the root to it. */
    const jp_cost root_to_robot = jp_fields_bound(planner, &planner->start);
    uint32_t least = jp_fields_bound_at_goal(planner);

    if (jp_search_is_exact(planner)) {
        const uint32_t key = jp_planner_queue_lowest_key(&planner->search);
        least = key > least + bucket_width(planner) ? key - bucket_width(planner) : least;
    }
    return least > root_to_robot ? (jp_cost)(least - root_to_robot) : 0U;
}

enum search_result jp_search_expand(struct jp_planner_internal *planner, unsigned *expansions)
{
    for (;;) {
        const uint32_t slot = jp_planner_queue_top(&planner->search);

        if (slot == NO_SLOT) {
            return has_cost(planner, jp_search_target(planner)) ? SEARCH_FOUND : SEARCH_IMPOSSIBLE;
        }
        if (jp_planner_queue_is_beyond_range(&planner->search)) {
            return SEARCH_RANGE;
        }
        const uint32_t target = jp_search_target(planner);
        if (target != NO_SLOT && is_arrived(planner, target)) {
            return SEARCH_FOUND;
        }
        if (planner->is_splicing && jp_planner_head_has(&planner->head, (uint32_t)planner->search.states[slot].id)) {
            return SEARCH_FOUND;
        }
        if (target != NO_SLOT && is_first_route(planner)) {
            return SEARCH_ROUTE;
        }
        if (*expansions == 0) {
            return SEARCH_WORKING;
        }
        if (is_full(planner)) {
            return SEARCH_FULL;
        }
        expand(planner, slot);
        --*expansions;
    }
}

static void seed(struct jp_planner_internal *planner, const struct jp_lattice_pose *pose)
{
    set_rhs(planner, jp_planner_states_add(&planner->search, jp_search_id(planner, pose->x, pose->y, pose->heading)),
            pose, 0);
}

static void seed_all(struct jp_planner_internal *planner)
{
    if (jp_search_is_forward(planner)) {
        seed(planner, &planner->start);
        return;
    }
    for (uint8_t heading = 0; heading < JP_HEADINGS; heading++) {
        const struct jp_lattice_pose pose = {planner->goal.x, planner->goal.y, heading};
        if (jp_search_is_seed(planner, &pose)) {
            seed(planner, &pose);
        }
    }
}

/** Expected range of the keys: the heuristic at the seed is about the cost of the target. */
static uint32_t expected_range(const struct jp_planner_internal *planner)
{
    const struct jp_lattice_pose goal = {planner->goal.x, planner->goal.y, planner->start.heading};

    return inflate(planner, jp_search_heuristic(planner, jp_search_is_forward(planner) ? &planner->start : &goal)) *
           RANGE_PER_TARGET;
}

void jp_search_start(struct jp_planner_internal *planner)
{
    planner->search.nearest = NO_SLOT;
    planner->search.cut_cost = JP_COST_MAX;
    planner->search.edge_max = 0;
    planner->search.rekey_slot = planner->search.slot_count;
    jp_planner_queue_restart(&planner->search, expected_range(planner));
    seed_all(planner);
}

void jp_search_seed_tail(struct jp_planner_internal *planner, const struct jp_lattice_pose *pose, jp_cost cost)
{
    const uint32_t slot =
        jp_planner_states_add(&planner->search, jp_search_id(planner, pose->x, pose->y, pose->heading));

    if (cost < planner->search.states[slot].rhs) {
        set_rhs(planner, slot, pose, cost);
    }
}

void jp_search_rekey(struct jp_planner_internal *planner, bool widen)
{
    const uint32_t range =
        widen ? (planner->search.bucket_count - 1) << (planner->search.bucket_shift + 1) : expected_range(planner);

    jp_planner_queue_restart(&planner->search, range);
    planner->search.rekey_slot = 0;
}

/** Looks again for what a state rests on, which the cut may have taken: none that is left is so near to the seed that a
 *  primitive leads from it to a dearer state than these. */
static void mend_cut(struct jp_planner_internal *planner, struct jp_planner_state *state)
{
    const struct jp_lattice_pose pose = jp_search_pose_of(planner, (uint32_t)state->id);

    if (state->rhs > planner->search.cut_cost) {
        const bool is_near = state->rhs <= jp_cost_add(planner->search.cut_cost, planner->search.edge_max);
        state->rhs = (is_near ? lookahead(planner, &pose) : JP_COST_MAX) & JP_COST_MAX;
    }
}

bool jp_search_rekey_work(struct jp_planner_internal *planner, unsigned *slots)
{
    for (; *slots > 0U && planner->search.rekey_slot < planner->search.slot_count; --*slots) {
        const uint32_t slot = planner->search.rekey_slot;
        struct jp_planner_state *state = &planner->search.states[slot];

        planner->search.rekey_slot++;
        state->queued = 0;
        state->closed = 0;
        if (!jp_planner_state_is_used(state)) {
            continue;
        }
        mend_cut(planner, state);
        if (state->g != state->rhs) {
            const struct jp_lattice_pose pose = jp_search_pose(planner, slot);
            update(planner, slot, jp_search_heuristic(planner, &pose));
        }
    }
    if (planner->search.rekey_slot < planner->search.slot_count) {
        return false;
    }
    planner->search.cut_cost = JP_COST_MAX;
    return true;
}

void jp_search_rekey_cells(struct jp_planner_internal *planner, const struct jp_cell_box *box)
{
    for (int32_t y = box->first_y; y <= box->last_y; y++) {
        for (int32_t x = box->first_x; x <= box->last_x; x++) {
            for (uint8_t heading = 0; heading < JP_HEADINGS; heading++) {
                const struct jp_lattice_pose pose = {(int16_t)x, (int16_t)y, heading};
                const uint32_t slot = jp_planner_states_find(&planner->search, jp_search_id(planner, x, y, heading));
                if (slot != NO_SLOT) {
                    update(planner, slot, jp_search_heuristic(planner, &pose));
                }
            }
        }
    }
}

bool jp_search_repair(struct jp_planner_internal *planner, uint32_t id, bool may_be_cheaper)
{
    const struct jp_lattice_pose pose = jp_search_pose_of(planner, id);
    const uint32_t slot = jp_planner_states_find(&planner->search, id);

    if (slot != NO_SLOT) {
        recompute(planner, slot, &pose);
        return true;
    }
    if (!may_be_cheaper) {
        return true;
    }
    const jp_cost cost = lookahead(planner, &pose);
    if (cost == JP_COST_MAX) {
        return true;
    }
    const uint32_t added = jp_planner_states_add(&planner->search, id);
    if (added == NO_SLOT) {
        return false;
    }
    set_rhs(planner, added, &pose, cost);
    return true;
}
