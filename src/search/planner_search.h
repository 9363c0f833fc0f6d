/** AD* on the states of a planner: one search from a seed (the goal, or the robot) to a target. */
#ifndef JOULEPATH_SEARCH_PLANNER_SEARCH_H
#define JOULEPATH_SEARCH_PLANNER_SEARCH_H

#include <joulepath/planner.h>

enum search_result {
    SEARCH_WORKING,
    SEARCH_ROUTE,      /* the first route to the target; a cheaper one may follow */
    SEARCH_FOUND,      /* the target's cost is within ε of the optimum */
    SEARCH_IMPOSSIBLE, /* no route leads to the target */
    SEARCH_FULL,       /* the next expansion may not fit the table */
    SEARCH_RANGE       /* the queue needs a wider range */
};

/** The search is optimal when it ends: the energy field's bound steers it, with ε = 1. */
static inline bool jp_search_is_exact(const struct jp_planner_internal *planner)
{
    return planner->search.is_exact;
}

static inline bool jp_search_is_forward(const struct jp_planner_internal *planner)
{
    return planner->search.direction == JP_PLANNER_FROM_ROBOT;
}

/** Seeds the search. All states must have been cleared, and the field that steers it must have grown. */
void jp_search_start(struct jp_planner_internal *planner);

/** Adds a state on the tail of the plan, with its cost to the goal. The table must have room. */
void jp_search_seed_tail(struct jp_planner_internal *planner, const struct jp_lattice_pose *pose, jp_cost cost);

/** Begins to compute all keys anew, for planner->search.epsilon; `widen` doubles the range of the queue. */
void jp_search_rekey(struct jp_planner_internal *planner, bool widen);

/** Continues; *slots counts down. True when all keys are computed. */
bool jp_search_rekey_work(struct jp_planner_internal *planner, unsigned *slots);

/** Expands states; *expansions counts down to 0. */
enum search_result jp_search_expand(struct jp_planner_internal *planner, unsigned *expansions);

/** True when the target's cost is final: the next expansion would end the search. */
bool jp_search_has_arrived(struct jp_planner_internal *planner);

/** Repairs a state whose outgoing primitives have changed. False when the table is full. */
bool jp_search_repair(struct jp_planner_internal *planner, uint32_t id, bool may_be_cheaper);

/** Computes the keys of the states on some cells anew, after the energy field's bounds have fallen there. */
void jp_search_rekey_cells(struct jp_planner_internal *planner, const struct jp_cell_box *box);

/** Slot of the target: the robot's state, or the cheapest of the goal's states; NO_SLOT before the search has reached
 * it. */
uint32_t jp_search_target(const struct jp_planner_internal *planner);

/** Lower bound of any route of this start, goal and map: by the energy field if it has a root, and by the least key of
 * an exact search. 0: nothing is known. */
jp_cost jp_search_least_cost(const struct jp_planner_internal *planner);

/** The best predecessor of a state: the neighbour over which the seed costs least by the present g. */
struct search_predecessor {
    jp_cost cost;                         /* of the state over this neighbour; JP_COST_MAX: there is none */
    jp_cost from;                         /* g of the neighbour */
    const struct jp_primitive *primitive; /* between the two; the robot drives it away from the seed when the search
                                             runs forward, else towards it */
};

struct search_predecessor jp_search_predecessor(const struct jp_planner_internal *planner,
                                                const struct jp_lattice_pose *pose);

/** True at a state with cost 0: the goal's, or the robot's when searching forward. */
bool jp_search_is_seed(const struct jp_planner_internal *planner, const struct jp_lattice_pose *pose);

struct jp_lattice_pose jp_search_pose_of(const struct jp_planner_internal *planner, uint32_t id);

struct jp_lattice_pose jp_search_pose(const struct jp_planner_internal *planner, uint32_t slot);

/** Heuristic, the cost between a state and the target: a bound in an exact search, else the guide's estimate. */
jp_cost jp_search_heuristic(const struct jp_planner_internal *planner, const struct jp_lattice_pose *pose);

uint32_t jp_search_id(const struct jp_planner_internal *planner, int32_t x, int32_t y, unsigned heading);

#endif
