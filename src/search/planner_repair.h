/** What a change of the map does to a search: which states lose or gain a primitive. */
#ifndef JOULEPATH_SEARCH_PLANNER_REPAIR_H
#define JOULEPATH_SEARCH_PLANNER_REPAIR_H

#include <joulepath/planner.h>

/** True when the noted changes and this one can be repaired together. */
bool jp_repair_fits(const struct jp_planner_internal *planner, int32_t x, int32_t y);

enum repair_result { REPAIR_WORKING, REPAIR_DONE, REPAIR_FULL };

/** Repairs the states whose primitives sweep a changed cell, from planner->changes.cursor on; *states counts down. */
enum repair_result jp_repair_work(struct jp_planner_internal *planner, unsigned *states);

#endif
