/** AD* on the states of a planner: one search from a seed (the goal, or the robot) to a target. */
#ifndef JOULEPATH_PLANNER_SEARCH_H
#define JOULEPATH_PLANNER_SEARCH_H

#include <joulepath/planner.h>

enum search_result {
    SEARCH_WORKING,
    SEARCH_FOUND,      /* the target's cost is within ε of the optimum */
    SEARCH_IMPOSSIBLE, /* no route leads to the target */
    SEARCH_FULL,       /* the next expansion may not fit the table */
    SEARCH_RANGE       /* the queue needs a wider range */
};

/** Forgets everything and seeds the search. The field must have grown. */
void jp_search_start(struct jp_planner *planner);

/** Starts to sort the queue anew, for planner->epsilon; `widen` doubles its range. */
void jp_search_rekey(struct jp_planner *planner, bool widen);

/** Goes on sorting; *slots counts down. True when done. */
bool jp_search_rekey_work(struct jp_planner *planner, unsigned *slots);

/** Expands states; *expansions counts down to 0. */
enum search_result jp_search_expand(struct jp_planner *planner, unsigned *expansions);

/** Repairs a state whose outgoing primitives have changed. False when the table is full. */
bool jp_search_repair(struct jp_planner *planner, uint32_t id, bool may_be_cheaper);

/** Sorts the states of some cells anew, whose bounds have fallen. */
void jp_search_rekey_cells(struct jp_planner *planner, const struct jp_cell_box *box);

/** State where the search has arrived: the robot's, or the cheapest of the goal's; NO_SLOT when it has not. */
uint32_t jp_search_target(const struct jp_planner *planner);

/** The cheapest way of a state by the neighbours on its seed's side. */
struct search_way {
    jp_cost cost;                         /* to the seed; JP_COST_MAX: there is none */
    const struct jp_primitive *primitive; /* the first on the way, the last of the robot's when searching forward */
};

struct search_way jp_search_cheapest_way(const struct jp_planner *planner, const struct jp_pose *pose);

/** True at a state with cost 0: the goal's, or the robot's when searching forward. */
bool jp_search_is_seed(const struct jp_planner *planner, const struct jp_pose *pose);

struct jp_pose jp_search_pose(const struct jp_planner *planner, uint32_t slot);

/** What is left of the way between a state and the target: a bound in an exact search, else the guide's estimate. */
jp_cost jp_search_rest(const struct jp_planner *planner, const struct jp_pose *pose);

uint32_t jp_search_id(const struct jp_planner *planner, int32_t x, int32_t y, unsigned heading);

#endif
