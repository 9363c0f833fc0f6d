/** A bound where the block has no room for the energy field beside the states: after the search it grows in their
 *  place. */
#ifndef JOULEPATH_SEARCH_PLANNER_BOUND_H
#define JOULEPATH_SEARCH_PLANNER_BOUND_H

#include <joulepath/planner.h>

/** True when the schedule asks for a proof that the search has not given, and the field fits in the place of its
 *  states. */
bool jp_bound_is_wanted(const struct jp_planner_internal *planner);

/** Lends the states' memory to the energy field; what is left of it is the search's, whose states are lost. */
void jp_bound_lend_states(struct jp_planner_internal *planner);

/** True when enough is left for an exact search, which raises the field's bound. */
bool jp_bound_has_states(const struct jp_planner_internal *planner);

/** Gives the memory back to the search, whose states must be cleared. */
void jp_bound_return_states(struct jp_planner_internal *planner);

#endif
