/** Joins head and tail of a plan around what blocks it. */
#ifndef JOULEPATH_SEARCH_PLANNER_SPLICE_H
#define JOULEPATH_SEARCH_PLANNER_SPLICE_H

#include <joulepath/planner.h>

/** Notes the last states of the head that the check has left of the plan, and seeds the search with the first ones of
 *  its tail. Work: the head's steps; the costs of 32. */
void jp_splice_begin(struct jp_planner_internal *planner);

/** Where the head has its junction. */
struct jp_lattice_pose jp_splice_junction(const struct jp_planner_internal *planner);

/** True at one of the states that the search was seeded with. Work: at most 33 comparisons. */
bool jp_splice_is_on_tail(const struct jp_planner_internal *planner, const struct jp_lattice_pose *pose);

/** Completes a trace from the junction to the tail by the steps before it and behind it. False when they do not fit.
 *  Work: the costs of 64 steps. */
bool jp_splice_join(struct jp_planner_internal *planner);

#endif
