/** The firmware's application on a host: what power and memory are to it on a board. */
#ifndef JOULEPATH_SIM_ECU_NODE_H
#define JOULEPATH_SIM_ECU_NODE_H

#include "../hal/can/lockstep.h"
#include "../hal/linux/can_link.h"
#include "robots.h"

struct ecu_node {
    struct jp_lockstep lockstep;
    struct jp_retained own_record; /**< where no other is given */
};

/** Boots. retained NULL: a record of its own, empty. Prints one line on stderr and returns false when the configuration
 *  or model is refused. A node must not be moved after it. */
bool ecu_node_init(struct ecu_node *node, const struct robot_entry *entry, const struct jp_energy_model *model,
                   const struct jp_can_port *bus, struct jp_retained *retained);

#endif
