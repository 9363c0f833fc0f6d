/** The phases of a planner's work, as a state machine. Private to the planner. */
#ifndef JOULEPATH_SEARCH_PLANNER_PHASES_H
#define JOULEPATH_SEARCH_PLANNER_PHASES_H

#include <joulepath/planner.h>

/** Works for at most so many expansions, or as much other work. */
void jp_phases_work(struct jp_planner_internal *planner, unsigned expansions);

/** After a new start: continues the search where its states hold for the new start too, else begins anew. */
void jp_phases_follow_robot(struct jp_planner_internal *planner);

/** Notes a change of cell (x, y) for repair. */
void jp_phases_note_change(struct jp_planner_internal *planner, int32_t x, int32_t y, bool may_be_cheaper);

/** True when there is nothing to do. */
bool jp_phases_is_idle(const struct jp_planner_internal *planner);

#endif
