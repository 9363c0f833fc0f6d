/**
 * bxCAN as a bus (hal/can/can.h): CAN1, 1 Mbit/s, standard data frames.
 *
 * Frames leave in the order in which they were sent, over a queue and the three mailboxes; after a lost arbitration or
 * an error the controller repeats a frame by itself. On bus-off what waits is dropped (commands must not be late by a
 * second), and the controller comes back by itself after 128 times 11 recessive bits.
 *
 * send(), state() and the three handlers must not interrupt each other: one interrupt priority for all.
 */
#ifndef JOULEPATH_HAL_STM32F4_CAN_CONTROLLER_H
#define JOULEPATH_HAL_STM32F4_CAN_CONTROLLER_H

#include <stdbool.h>

#include "hal/can/can.h"

/** Frames that wait for a mailbox: more than a tick sends. A power of two. */
#define JP_CAN_QUEUE 32U

/** Takes a frame that came; in the receive interrupt. */
typedef void (*jp_can_receiver)(void *context, const struct jp_can_frame *frame);

struct jp_can_controller {
    bool present;
    jp_can_receiver receive;
    void *context; /**< handed to it */
    struct jp_can_frame queue[JP_CAN_QUEUE];
    uint8_t first;     /**< of the queue */
    uint8_t waiting;   /**< frames in it */
    uint16_t overruns; /**< times that frames were lost because three waited to be received, saturating */
    uint16_t bus_offs; /**< saturating */
    uint16_t dropped;  /**< frames that a bus-off made obsolete, saturating */
};

/**
 * Starts the controller; its clock must be the 42 MHz that board.h's bit timing is for, from the crystal. False: there
 * is none, or the bus does not let it on (11 recessive bits) within 10 ms: send() then fails and state() is
 * JP_CAN_DOWN. Not for ISRs.
 */
bool jp_can_controller_start(struct jp_can_controller *can, jp_can_receiver receive, void *context);

/** The controller as a bus. send(): JP_ERR_ARGUMENT for other than standard data frames. Constant time. */
struct jp_can_port jp_can_controller_port(struct jp_can_controller *can);

/** Of CAN1_RX0's interrupt: takes one frame; the interrupt stays pending while more wait. */
void jp_can_controller_on_receive(struct jp_can_controller *can);

/** Of CAN1_TX's interrupt: at most 3 mailboxes are filled. */
void jp_can_controller_on_transmit(struct jp_can_controller *can);

/** Of CAN1_SCE's interrupt: bus-off. At most JP_CAN_QUEUE frames are dropped. */
void jp_can_controller_on_error(struct jp_can_controller *can);

#endif
