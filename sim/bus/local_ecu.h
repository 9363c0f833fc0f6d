/** An ECU in this process, on a bus of its own: it does its work while the other end waits. */
#ifndef JOULEPATH_SIM_BUS_LOCAL_ECU_H
#define JOULEPATH_SIM_BUS_LOCAL_ECU_H

#include "sim/bus/can_bus.h"
#include "sim/bus/ecu_node.h"

struct local_ecu {
    struct can_bus bus;
    struct can_bus_end *end;
    struct ecu_node node;
};

/** Boots; *link is the other end. Prints one line on stderr and returns false when the configuration or model is
 *  refused. It must not be moved after it. */
bool local_ecu_start(struct local_ecu *ecu, const struct robot_entry *entry, const struct jp_energy_model *model,
                     struct jp_can_link *link);

/** The same of a robot that its sides steer. */
bool local_ecu_start_skid(struct local_ecu *ecu, const struct skid_robot_entry *entry, struct jp_can_link *link);

/** The same of a robot with four steered wheels. */
bool local_ecu_start_patrol(struct local_ecu *ecu, const struct patrol_robot_entry *entry, struct jp_can_link *link);

#endif
