/** A robot that finds its way by itself: the library's navigator in a simulated world in which there is more than
 * the map shows, and which it sees as far as it looks. */
#ifndef JOULEPATH_SIM_MISSIONS_NAVIGATION_H
#define JOULEPATH_SIM_MISSIONS_NAVIGATION_H

#include "sim/missions/navigation_robot.h"
#include "sim/missions/navigation_task.h"

/** Drives a robot that stands at the start of the task. False after one line on stderr: no memory, or a configuration
 * is refused. */
bool navigation_run(const struct navigation_task *task, const struct navigation_robot *robot,
                    struct navigation_result *result);

#endif
