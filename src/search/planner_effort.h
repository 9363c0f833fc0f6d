/** When a search becomes dearer than one that begins anew. */
#ifndef JOULEPATH_SEARCH_PLANNER_EFFORT_H
#define JOULEPATH_SEARCH_PLANNER_EFFORT_H

#include <joulepath/planner.h>

/** Expansions that may be spent at once: up to where a repair has become too dear. 0: it has. */
unsigned jp_effort_slice(const struct jp_planner_internal *planner, unsigned expansions);

/** Notes what has been spent, and what a search takes that was begun anew. */
void jp_effort_note(struct jp_planner_internal *planner, unsigned spent, bool had_route);

#endif
