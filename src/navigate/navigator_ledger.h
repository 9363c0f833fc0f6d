/** What drives to goals take beside the forecasts of their first courses. Private to the navigator, and to home. */
#ifndef JOULEPATH_NAVIGATE_NAVIGATOR_LEDGER_H
#define JOULEPATH_NAVIGATE_NAVIGATOR_LEDGER_H

#include <joulepath/navigator.h>

/** A drive to a goal begins. */
void jp_ledger_begin(struct jp_navigator *navigator);

/** A course was surveyed: the first one of a drive is what the drive was forecast to take. */
void jp_ledger_add_course(struct jp_navigator *navigator);

/** The robot has arrived, by which is learned. */
void jp_ledger_end(struct jp_navigator *navigator);

/** What is left of the course, its energy as the vehicle forecasts it; false: there is none. */
bool jp_ledger_left(const struct jp_navigator *navigator, struct jp_progress *left);

/** The same as drives have taken it. */
bool jp_ledger_expected(const struct jp_navigator *navigator, struct jp_progress *left);

#endif
