/** The ends of a CAN bus that a Linux machine has, by name. */
#ifndef JOULEPATH_HAL_LINUX_CAN_OPEN_H
#define JOULEPATH_HAL_LINUX_CAN_OPEN_H

#include "hal/linux/can_link.h"

/**
 * Opens the bus that `name` stands for:
 *
 *   can:vcan0            a network interface of SocketCAN
 *   slcan:/dev/ttyACM0   a serial line that speaks SLCAN (an adapter, a board)
 *   pty:/tmp/ecu         the same on a new pseudo-terminal, whose far end appears under that name
 *
 * False after one line in `error` (at most `size` bytes): what, where, why, what to do.
 */
bool jp_can_link_open(struct jp_can_link *link, const char *name, char *error, unsigned size);

#endif
