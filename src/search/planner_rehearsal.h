/** Searches in smaller parts of the block after one that has not proved its route. A search by the guide finds now a
 *  better route, now a worse one; the cheapest of all stays, so that more memory gives none that is dearer. */
#ifndef JOULEPATH_SEARCH_PLANNER_REHEARSAL_H
#define JOULEPATH_SEARCH_PLANNER_REHEARSAL_H

#include <joulepath/planner.h>

static inline bool jp_rehearsal_is_on(const struct jp_planner_internal *planner)
{
    return planner->rehearsal.size > 0U;
}

/** True before this search, or this rehearsal, has found a route. */
static inline bool jp_rehearsal_awaits_route(const struct jp_planner_internal *planner)
{
    if (jp_rehearsal_is_on(planner)) {
        return !planner->rehearsal.has_route;
    }
    return planner->answer == JP_ANSWER_OUT_OF_BUDGET;
}

/** Divides the next smaller part of the block for a search that begins anew, with the first ε. False when there is
 * none. The states are lost. */
bool jp_rehearsal_next(struct jp_planner_internal *planner);

/** Ends the rehearsals. */
void jp_rehearsal_end(struct jp_planner_internal *planner);

#endif
