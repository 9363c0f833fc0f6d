/**
 * The firmware's application on a host: what power, reset line and CAN controller are to it on a board. In lockstep
 * SimTime is its timer, and says whether it has power, is held in reset, and its controller is on the bus.
 */
#ifndef JOULEPATH_SIM_ECU_NODE_H
#define JOULEPATH_SIM_ECU_NODE_H

#include "../hal/can/ecu.h"
#include "../hal/linux/can_link.h"
#include "robots.h"

struct ecu_node {
    struct jp_ecu ecu;
    const struct robot_entry *entry;
    const struct jp_energy_model *model;
    struct jp_can_port bus;        /**< as it is */
    struct jp_retained own_record; /**< where no other is given */
    struct jp_retained *retained;
    bool running; /**< has power and is not held in reset */
    bool bus_off;
    bool answered; /**< in lockstep: last_tick holds */
    uint32_t last_tick;
    bool other_answers; /**< another ECU has answered the last tick */
};

/** Boots. retained NULL: a record of its own, empty. Prints one line on stderr and returns false when the configuration
 * or model is refused. A node must not be moved after it. */
bool ecu_node_init(struct ecu_node *node, const struct robot_entry *entry, const struct jp_energy_model *model,
                   const struct jp_can_port *bus, struct jp_retained *retained);

/** Takes a frame. In lockstep SimTime runs a tick, which SimDone ends. Beside another ECU that answers, one that does
 * not drive the bridges leaves the answer to it: the tick is done when the one that drives them is. True when a sample
 * is complete. */
bool ecu_node_accept(struct ecu_node *node, const struct jp_can_frame *frame);

/** One tick: background work, then control. */
void ecu_node_tick(struct ecu_node *node);

#endif
