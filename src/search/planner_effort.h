/** When a search becomes dearer than one that begins anew. */
#ifndef JOULEPATH_SEARCH_PLANNER_EFFORT_H
#define JOULEPATH_SEARCH_PLANNER_EFFORT_H

#include <joulepath/planner.h>

/** Expansions that may be spent at once: up to where a repair has become too dear. 0: it has. */
unsigned jp_effort_slice(const struct jp_planner_internal *planner, unsigned expansions);

/** Notes what has been spent, and what a search takes that was begun anew. */
void jp_effort_note(struct jp_planner_internal *planner, unsigned spent, bool had_route);

/** What a new search would take, by the present one when it was new and by how much of its route is left: until it has
 *  a route, or proves the one that there is. 0: it was not that far yet, and must not be given up before. */
uint32_t jp_effort_anew(const struct jp_planner_internal *planner);

#endif
