/** Bounds where the states do not fit. With the energy field beside them, the turn field takes the place of some. Where
 *  there is no room for the energy field either, both grow in the states' place after the search, the turn field first,
 *  of which the bound at the goal is kept. */
#ifndef JOULEPATH_SEARCH_PLANNER_BOUND_H
#define JOULEPATH_SEARCH_PLANNER_BOUND_H

#include <joulepath/planner.h>

/** True when the schedule asks for a proof. */
bool jp_bound_is_scheduled(const struct jp_planner_internal *planner);

/** True when there is an energy field, and a turn field would fit in the place of some of the states. */
bool jp_bound_can_share(const struct jp_planner_internal *planner);

/** Gives the memory of some of the states, which are all lost, to the turn field; it must grow next. */
void jp_bound_share_with_turns(struct jp_planner_internal *planner);

/** Gives it back; the states must be cleared. */
void jp_bound_drop_turns(struct jp_planner_internal *planner);

/** True when the schedule asks for a proof that the search has not given, and a field fits in the place of its
 *  states. */
bool jp_bound_is_wanted(const struct jp_planner_internal *planner);

/** Lends the memory of the states, which are lost, to the turn field; it must grow next. */
void jp_bound_lend_to_turns(struct jp_planner_internal *planner);

/** Takes from the turn field what it says of the goal. */
void jp_bound_take_turns(struct jp_planner_internal *planner);

/** True when the energy field fits in the place of the states. */
bool jp_bound_fits_field(const struct jp_planner_internal *planner);

/** Lends the memory on to the energy field; what is left of it is the search's. */
void jp_bound_lend_to_field(struct jp_planner_internal *planner);

/** True when enough is left for an exact search, which raises the field's bound. */
bool jp_bound_has_states(const struct jp_planner_internal *planner);

/** Gives the memory back to the search, whose states must be cleared. */
void jp_bound_return_states(struct jp_planner_internal *planner);

#endif
