/** A balancer that finds its way by itself: the library's navigator in a simulated world in which there is more than
 * the map shows, and which it sees as far as it looks. */
#ifndef JOULEPATH_SIM_MISSIONS_NAVIGATION_H
#define JOULEPATH_SIM_MISSIONS_NAVIGATION_H

#include "sim/missions/navigation_task.h"

/** Drives. False after one line on stderr: no memory, or a configuration is refused. */
bool navigation_run(const struct navigation_task *task, struct navigation_result *result);

#endif
