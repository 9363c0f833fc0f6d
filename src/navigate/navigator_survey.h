/** What a course takes, and where the robot must stand on it. Private to the navigator. */
#ifndef JOULEPATH_NAVIGATE_NAVIGATOR_SURVEY_H
#define JOULEPATH_NAVIGATE_NAVIGATOR_SURVEY_H

#include <joulepath/navigator.h>

/** Begins anew, with the course that there is. */
void jp_survey_start(struct jp_navigator *navigator);

/** Surveys the next leg, or begins a run: how far the robot leaves the leg's line; it shall stand at a corner for which
 *  there is no room, or which it cannot take in motion. JP_WORKING: legs are left. Failures of the vehicle. */
enum jp_status jp_survey_work(struct jp_navigator *navigator, const struct jp_place *place);

/** Legs from one on up to the next stand, whose ends are written as targets. */
uint16_t jp_survey_write_run(struct jp_navigator *navigator, unsigned first);

#endif
