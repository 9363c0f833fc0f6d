/** Several CAN links as one: what arrives on one of them is passed on to the others, as on one bus. */
#ifndef JOULEPATH_SIM_BUS_CAN_RELAY_H
#define JOULEPATH_SIM_BUS_CAN_RELAY_H

#include <stddef.h>

#include "hal/linux/can_link.h"

#define CAN_RELAY_LINKS 4

struct can_relay {
    struct jp_can_link links[CAN_RELAY_LINKS];
    size_t count;
};

/** False when there are CAN_RELAY_LINKS already. */
bool can_relay_add(struct can_relay *relay, const struct jp_can_link *link);

/** The links as one. Its state is the best of theirs. */
struct jp_can_link can_relay_link(struct can_relay *relay);

#endif
