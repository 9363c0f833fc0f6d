/** What a process asks of the system so that its deadlines hold. */
#ifndef JOULEPATH_SIM_BASE_REAL_TIME_H
#define JOULEPATH_SIM_BASE_REAL_TIME_H

#include <stdbool.h>

/** Asks for a real-time priority and for memory that stays in place. Where that is not allowed the process goes on as
 * it is, and false is returned. */
bool real_time_claim(void);

#endif
