/**
 * CAN links that speak SLCAN on a serial line: the host's end on a line that exists, the adapter's end on a new
 * pseudo-terminal. What cannot be sent at once waits in a buffer of bounded size; beyond that sending is JP_ERR_BUSY.
 * JP_ERR_ARGUMENT when sending: a frame of more than 8 bytes or with an id that does not fit its kind.
 */
#ifndef JOULEPATH_HAL_LINUX_SERIAL_CAN_H
#define JOULEPATH_HAL_LINUX_SERIAL_CAN_H

#include "hal/linux/can_link.h"

/**
 * Opens the host's end on the serial line `path`, at 1 Mbaud. JP_CAN_DOWN until the adapter has answered, after it has
 * not answered for a second, and while the line is gone; a line that comes back is opened again by its path. False: see
 * jp_can_link_open().
 */
bool jp_serial_can_open(struct jp_can_link *link, const char *path, char *error, unsigned size);

/**
 * Opens the adapter's end on a new pseudo-terminal. The link `path` to its far end is removed at the close. JP_CAN_DOWN
 * until a host has opened the channel, and after that one has closed it or has gone. False: see jp_can_link_open();
 * among the reasons: there is something at `path` that is not what a dead process left behind.
 */
bool jp_serial_can_open_pty(struct jp_can_link *link, const char *path, char *error, unsigned size);

#endif
