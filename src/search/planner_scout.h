/** The scout: the small second search, by the guide, that finds a route while the exact one is repaired. */
#ifndef JOULEPATH_SEARCH_PLANNER_SCOUT_H
#define JOULEPATH_SEARCH_PLANNER_SCOUT_H

#include <joulepath/planner.h>

/** True where the block has states for one. */
static inline bool jp_scout_exists(const struct jp_planner_internal *planner)
{
    return planner->resting.slot_count > 0U;
}

/** Sets it to work in the place of the exact search, which rests; to splice, or to search the whole way. */
void jp_scout_call(struct jp_planner_internal *planner, bool is_splicing);

/** It searches the whole way from now on. */
void jp_scout_take_whole_way(struct jp_planner_internal *planner);

/** If it is at work, it stops where it is; the exact search is the one that counts. */
void jp_scout_dismiss(struct jp_planner_internal *planner);

/** ε of a search of the whole way by the guide. */
uint16_t jp_scout_whole_way_epsilon(const struct jp_planner_internal *planner);

#endif
