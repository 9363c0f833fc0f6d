/** The cut: what a change cannot have touched stays of a search, and the rest is forgotten. Costs rest on smaller ones
 * only, so those below the least that has become wrong are right. What follows is the last part of a new search. */
#ifndef JOULEPATH_SEARCH_PLANNER_CUT_H
#define JOULEPATH_SEARCH_PLANNER_CUT_H

#include <joulepath/planner.h>

/** Prepares it. The search is exact, and its states are repaired. */
void jp_cut_begin(struct jp_planner_internal *planner);

/** Looks for the least wrong cost, then forgets those from it on; *slots counts down. True when that is done: all keys
 *  must be computed anew then. */
bool jp_cut_work(struct jp_planner_internal *planner, unsigned *slots);

/** False when more is lost, and needed again, than a new search takes. */
bool jp_cut_is_worth_it(const struct jp_planner_internal *planner);

#endif
