/**
 * The clock of a host, and a loop that runs at a fixed rate: each wait ends at a multiple of the period after the
 * start, so that lateness does not add up.
 */
#ifndef JOULEPATH_HAL_LINUX_PERIODIC_H
#define JOULEPATH_HAL_LINUX_PERIODIC_H

#include <stdint.h>

/** Counts since the start. */
struct jp_periodic {
    uint32_t period_ns;
    int64_t next_ns;            /**< the next end of a wait, on the monotonic clock */
    uint64_t ticks;             /**< waits that ended */
    uint64_t missed;            /**< periods that no wait ended in */
    uint32_t worst_lateness_us; /**< of a wait's end after its multiple of the period, saturating */
};

/** Monotonic time, µs. */
int64_t jp_monotonic_us(void);

/** The first wait ends one period from now. period_ns: above 0. */
void jp_periodic_start(struct jp_periodic *periodic, uint32_t period_ns);

/** Waits for the end of the period. Returns how many periods were missed: 0 when the wait ended in the one that follows
 *  the last. Signals do not end it. */
uint64_t jp_periodic_wait(struct jp_periodic *periodic);

#endif
