/** Writes every frame that passes a CAN link to a file, in the format of candump -L, with the simulated time. */
#ifndef JOULEPATH_SIM_BUS_CAN_LOG_H
#define JOULEPATH_SIM_BUS_CAN_LOG_H

#include <stdio.h>

#include "hal/linux/can_link.h"

struct can_log {
    struct jp_can_link inner;
    FILE *stream;
    const char *interface; /**< as the log names it */
    const uint32_t *tick;  /**< whose time the frames have */
    uint32_t rate_hz;
};

/** A log whose members are set as a link around `inner`. It must not be moved after it. */
struct jp_can_link can_log_link(struct can_log *log);

#endif
