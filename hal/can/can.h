/**
 * A CAN bus as the application sees it: frames out, the state of the controller. One struct of functions for each port;
 * SocketCAN, SLCAN, bxCAN and the simulated bus stand behind it. Frames that arrive are handed to the application by
 * the port's owner, from its receive interrupt or its loop.
 */
#ifndef JOULEPATH_HAL_CAN_H
#define JOULEPATH_HAL_CAN_H

#include <stdint.h>

#include <joulepath/status.h>

#define JP_CAN_LENGTH_MAX 8U

/** Flags of an id: a 29-bit id, and a remote frame. Frames of the application have neither. */
#define JP_CAN_EXTENDED 0x80000000U
#define JP_CAN_REMOTE   0x40000000U

struct jp_can_frame {
    uint32_t id;    /**< with flags */
    uint8_t length; /**< 0…8 */
    uint8_t data[JP_CAN_LENGTH_MAX];
};

enum jp_can_state {
    JP_CAN_ON,
    JP_CAN_BUS_OFF, /**< the controller has left the bus after too many errors, and comes back by itself */
    JP_CAN_DOWN     /**< there is no bus: the interface is missing or switched off */
};

struct jp_can_port {
    void *context; /**< handed to each function */

    /** Queues one frame, without blocking. JP_ERR_BUSY: no room. JP_ERR_HARDWARE: bus-off or down. */
    enum jp_status (*send)(void *context, const struct jp_can_frame *frame);

    enum jp_can_state (*state)(void *context);
};

#endif
