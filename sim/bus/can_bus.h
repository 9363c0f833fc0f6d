/**
 * A CAN bus inside one process: every frame sent at one end is received, in order, at all others. An end whose queue is
 * full loses what comes, as a controller does. Not for several threads.
 */
#ifndef JOULEPATH_SIM_BUS_CAN_BUS_H
#define JOULEPATH_SIM_BUS_CAN_BUS_H

#include <stddef.h>

#include "hal/linux/can_link.h"

#define CAN_BUS_ENDS  4
#define CAN_BUS_QUEUE 256

struct can_bus;

struct can_bus_end {
    struct can_bus *bus;
    struct jp_can_frame queue[CAN_BUS_QUEUE];
    size_t head;
    size_t count;
    /** What others on the bus do while this end waits; NULL: nothing. */
    void (*others)(void *context);
    void *context;
};

struct can_bus {
    struct can_bus_end ends[CAN_BUS_ENDS];
    size_t end_count;
};

/** No ends. A bus must not be moved once it has one. */
void can_bus_init(struct can_bus *bus);

/** A new end; at most CAN_BUS_ENDS. */
struct can_bus_end *can_bus_attach(struct can_bus *bus);

/** The end as a link. Waiting runs `others` once and never sleeps. */
struct jp_can_link can_bus_link(struct can_bus_end *end);

#endif
