/** What the links share: waiting for a frame on a file descriptor. */
#ifndef JOULEPATH_HAL_LINUX_CAN_WAIT_H
#define JOULEPATH_HAL_LINUX_CAN_WAIT_H

#include <poll.h>
#include <stdbool.h>
#include <stdint.h>

/** Time between attempts to get a bus back, µs. */
#define JP_CAN_RETRY_US 100000

struct jp_can_source {
    void *context;

    /** Fetches the next frame, if none is waiting yet, and does what is due. True: one is waiting. */
    bool (*fetch)(void *context);

    /** What to poll; a negative descriptor while there is nothing to poll. */
    struct pollfd (*descriptor)(void *context);
};

/** As `wait` of struct jp_can_link. */
bool jp_can_wait(const struct jp_can_source *source, int64_t timeout_us);

#endif
