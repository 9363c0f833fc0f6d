/**
 * One end of a CAN bus on Linux: the port that the application sends on, and what its owner's loop needs. SocketCAN,
 * SLCAN on a serial line and the simulated bus stand behind it.
 */
#ifndef JOULEPATH_HAL_LINUX_CAN_LINK_H
#define JOULEPATH_HAL_LINUX_CAN_LINK_H

#include <stdbool.h>

#include "hal/can/can.h"

struct jp_can_link {
    struct jp_can_port port;

    /** Takes the next frame that has arrived; false: none is waiting. Never blocks. */
    bool (*receive)(void *context, struct jp_can_frame *frame);

    /** Waits until a frame has arrived, at most timeout_us (negative: for ever). False: none came. The context of all
     *  functions is port.context. */
    bool (*wait)(void *context, int64_t timeout_us);

    /** Gives everything back. */
    void (*close)(void *context);
};

#endif
