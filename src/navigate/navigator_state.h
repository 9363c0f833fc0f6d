/** The states of the navigator: what each begins with. Private to the navigator. */
#ifndef JOULEPATH_NAVIGATE_NAVIGATOR_STATE_H
#define JOULEPATH_NAVIGATE_NAVIGATOR_STATE_H

#include <joulepath/navigator.h>

/** The one place that assigns the state. */
void jp_navigator_enter(struct jp_navigator *navigator, enum jp_navigator_state state, enum jp_navigator_reason reason);

/** Enters FAILED. */
void jp_navigator_fail(struct jp_navigator *navigator, enum jp_navigator_reason reason);

/** False: the vehicle's failure ends the way to the goal. */
bool jp_navigator_accepts(struct jp_navigator *navigator, enum jp_status status);

/** Enters PLANNING, and counts it. */
void jp_navigator_plan_anew(struct jp_navigator *navigator, enum jp_navigator_reason reason);

/** It cannot reach the goal by what it has seen: enters a state of the end unless that may mislead it; then it forgets
 *  it, and looks again. */
void jp_navigator_give_up(struct jp_navigator *navigator, enum jp_navigator_state state,
                          enum jp_navigator_reason reason);

/** What is planned from now on is by this version of the map. */
void jp_navigator_see_map(struct jp_navigator *navigator);

/** Since then. */
bool jp_navigator_has_map_changed(const struct jp_navigator *navigator);

/** It is on a course that was surveyed. */
bool jp_navigator_has_course(const struct jp_navigator *navigator);

#endif
