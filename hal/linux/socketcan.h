/** A CAN link on a network interface of SocketCAN, real or virtual. */
#ifndef JOULEPATH_HAL_LINUX_SOCKETCAN_H
#define JOULEPATH_HAL_LINUX_SOCKETCAN_H

#include "hal/linux/can_link.h"

/**
 * Opens the interface `name`, such as vcan0. It receives what other sockets and nodes send, not its own frames.
 *
 * An interface that goes down or vanishes is JP_CAN_DOWN and is taken up again when it is back. After bus-off the link
 * is JP_CAN_BUS_OFF until the controller has restarted, at most 100 ms. JP_ERR_ARGUMENT when sending: a frame of more
 * than 8 bytes or with an id that does not fit its kind. False: see jp_can_link_open().
 */
bool jp_socketcan_open(struct jp_can_link *link, const char *name, char *error, unsigned size);

#endif
