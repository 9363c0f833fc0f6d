#include "sim/base/real_time.h"

#include <sched.h>
#include <sys/mman.h>

/** Above ordinary processes, below the kernel's own threads. */
#define PRIORITY 40

bool real_time_claim(void)
{
    const struct sched_param parameters = {.sched_priority = PRIORITY};
    const bool scheduled = sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;

    return mlockall(MCL_CURRENT | MCL_FUTURE) == 0 && scheduled;
}
