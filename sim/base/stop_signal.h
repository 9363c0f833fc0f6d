/** Ends a program in good order when it is asked to stop (SIGINT, SIGTERM); asked twice, it ends at once. */
#ifndef JOULEPATH_SIM_BASE_STOP_SIGNAL_H
#define JOULEPATH_SIM_BASE_STOP_SIGNAL_H

#include <stdbool.h>

/** From now on the signals are only noted. */
void stop_signal_catch(void);

/** One came since then. */
bool stop_signal_came(void);

#endif
