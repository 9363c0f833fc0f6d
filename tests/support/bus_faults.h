/** What goes wrong on the bus between a robot and its controller, for the random missions of every kind of robot. */
#ifndef JOULEPATH_TESTS_SUPPORT_BUS_FAULTS_H
#define JOULEPATH_TESTS_SUPPORT_BUS_FAULTS_H

#include "sim/bus/plant_node.h"
#include "tests/support/can_fault.h"

/** Of the frames, that are lost, late, swapped, repeated or corrupt. */
#define BUS_FAULT_SHARE_MAX 0.15

/** Each campaign draws from those that its robots and its plant can have. */
enum bus_fault_kind {
    BUS_FAULT_LOSS,
    BUS_FAULT_REPEAT,
    BUS_FAULT_DELAY,
    BUS_FAULT_FLIP,
    BUS_FAULT_SWAP,
    BUS_FAULT_BLACKOUT, /**< all frames are lost */
    BUS_FAULT_BUS_OFF,
    BUS_FAULT_ECU_RESET,
    BUS_FAULT_PLANT_PAUSE,
    BUS_FAULT_SILENCE, /**< of the operator */
    BUS_FAULT_STRANGE, /**< frames of a stranger: any content, the ids of this bus among others */
    BUS_FAULT_FREEZE,  /**< a sensor keeps its value */
    BUS_FAULT_SENSOR,  /**< a channel freezes, jumps, or reads something else; for ever */
    BUS_FAULT_STALL,   /**< a side jams, for ever */
    BUS_FAULT_AIR,     /**< a side loses the ground, for ever */
    BUS_FAULT_KINDS
};

const char *bus_fault_name(enum bus_fault_kind kind);

/** All frames stay away, so it must be short. */
bool bus_fault_is_outage(enum bus_fault_kind kind);

/** Lets it act on the frames of a link in these ticks, the last one exclusive; what does not is left out. */
void bus_fault_add(struct can_fault_link *link, enum bus_fault_kind kind, double share, uint64_t from, uint64_t until);

/** A stranger's frame to both ends: the id mostly one of this bus, now and then a remote or an extended one; anything
 *  as content. */
void bus_fault_send_strange(struct can_fault_link *link, struct plant_node *plant, struct random *random);

#endif
