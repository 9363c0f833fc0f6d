/** How a search of the planner begins, or goes on. */
#ifndef JOULEPATH_SEARCH_PLANNER_START_H
#define JOULEPATH_SEARCH_PLANNER_START_H

#include <joulepath/planner.h>

/** Roots the fields at the robot; they grow in `phase`, before or within a search. */
void jp_start_field(struct jp_planner_internal *planner, enum jp_planner_phase phase);

/** Lets the guide grow, for a search that follows. */
void jp_start_guide(struct jp_planner_internal *planner);

/** Begins from scratch; the search follows when its field has grown. */
void jp_start_anew(struct jp_planner_internal *planner, enum jp_planner_direction direction);

/** Begins anew with the first ε, where start and goal are known. */
void jp_start_over(struct jp_planner_internal *planner);

/** Clears the states; then the search itself begins. */
void jp_start_search(struct jp_planner_internal *planner);

/** Continues a search; all keys are computed anew when the heuristic changes or states wait for this ε. */
void jp_start_resume(struct jp_planner_internal *planner);

#endif
