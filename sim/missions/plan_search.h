/** One search of the planner from start to goal, with its route and what it took. */
#ifndef JOULEPATH_SIM_MISSIONS_PLAN_SEARCH_H
#define JOULEPATH_SIM_MISSIONS_PLAN_SEARCH_H

#include "sim/missions/plan_route.h"

struct plan_search {
    enum jp_cost_kind cost;
    enum jp_answer answer;
    struct jp_plan plan;
    struct jp_planner_counts statistics;
    double planning_s; /**< the search, of the processor */
    double whole_s;    /**< the same with the planner's block, its set-up and the route */
    struct plan_route route;
};

/** Searches until nothing better can be found, in a block of `memory` bytes. False after one line on stderr: start or
 *  goal blocked, too little memory. */
bool plan_search(struct map_file *map, const struct jp_lattice *lattice, enum jp_cost_kind cost,
                 const struct plan_task *task, size_t memory, struct plan_search *search);

/** True when the route leads to the goal. */
bool plan_search_arrives(const struct plan_search *search);

#endif
