/** The planner's work other than expansions, in slices: a call with a budget does what takes as long as at most so
 *  many expansions, which count down, and returns true when it is done. */
#ifndef JOULEPATH_SEARCH_PLANNER_SLICES_H
#define JOULEPATH_SEARCH_PLANNER_SLICES_H

#include <joulepath/planner.h>

/** The energy field and, where it is beside it, the turn field. */
bool jp_slice_grow_fields(struct jp_planner_internal *planner, unsigned *budget);

/** The turn field alone. */
bool jp_slice_grow_turns(struct jp_planner_internal *planner, unsigned *budget);

/** Lets the guide grow anew from the search's target. Constant time. */
void jp_slice_begin_guide(struct jp_planner_internal *planner);

bool jp_slice_grow_guide(struct jp_planner_internal *planner, unsigned *budget);

bool jp_slice_clear(struct jp_planner_internal *planner, unsigned *budget);

/** As jp_plan_check(). */
bool jp_slice_check_plan(struct jp_planner_internal *planner, unsigned *budget);

bool jp_slice_rekey(struct jp_planner_internal *planner, unsigned *budget);

/** See jp_cut_work(). */
bool jp_slice_cut(struct jp_planner_internal *planner, unsigned *budget);

#endif
