#include "tests/support/bus_faults.h"

#include "hal/can/jp_can.h"

#define DELAY_MAX 5U /* ticks */
#define FLIP_MAX  4U /* bits; corrupting more is what a stranger's frames do */

const char *bus_fault_name(enum bus_fault_kind kind)
{
    static const char *const names[BUS_FAULT_KINDS] = {
        [BUS_FAULT_LOSS] = "loss",
        [BUS_FAULT_REPEAT] = "repetition",
        [BUS_FAULT_DELAY] = "delay",
        [BUS_FAULT_FLIP] = "bit flips",
        [BUS_FAULT_SWAP] = "reordering",
        [BUS_FAULT_BLACKOUT] = "blackout",
        [BUS_FAULT_BUS_OFF] = "bus-off",
        [BUS_FAULT_ECU_RESET] = "ECU reset",
        [BUS_FAULT_PLANT_PAUSE] = "plant pause",
        [BUS_FAULT_SILENCE] = "operator silent",
        [BUS_FAULT_STRANGE] = "strange frames",
        [BUS_FAULT_FREEZE] = "sensor freeze",
        [BUS_FAULT_SENSOR] = "sensor",
        [BUS_FAULT_STALL] = "stalled side",
        [BUS_FAULT_AIR] = "side in the air",
    };

    return names[kind];
}

bool bus_fault_is_outage(enum bus_fault_kind kind)
{
    return kind == BUS_FAULT_BLACKOUT || kind == BUS_FAULT_BUS_OFF || kind == BUS_FAULT_ECU_RESET ||
           kind == BUS_FAULT_PLANT_PAUSE;
}

static enum can_fault_kind of_frames(enum bus_fault_kind kind)
{
    switch (kind) {
    case BUS_FAULT_REPEAT:
        return CAN_FAULT_REPEAT;
    case BUS_FAULT_DELAY:
        return CAN_FAULT_DELAY;
    case BUS_FAULT_FLIP:
        return CAN_FAULT_FLIP;
    case BUS_FAULT_SWAP:
        return CAN_FAULT_SWAP;
    default:
        return CAN_FAULT_LOSS;
    }
}

void bus_fault_add(struct can_fault_link *link, enum bus_fault_kind kind, double share, uint64_t from, uint64_t until)
{
    if (kind > BUS_FAULT_BLACKOUT) {
        return;
    }
    (void)can_fault_link_add(link, &(struct can_fault){.kind = of_frames(kind),
                                                       .direction = CAN_FAULT_BOTH,
                                                       .share = kind == BUS_FAULT_BLACKOUT ? 1 : share,
                                                       .strength = kind == BUS_FAULT_DELAY ? DELAY_MAX : FLIP_MAX,
                                                       .from = from,
                                                       .until = until});
}

void bus_fault_send_strange(struct can_fault_link *link, struct plant_node *plant, struct random *random)
{
    const struct jp_can_port *port = &link->inner.port;
    struct jp_can_frame frame = {.length = (uint8_t)random_uniform(random, 0, JP_CAN_LENGTH_MAX + 1)};
    const double choice = random_uniform(random, 0, 1);

    frame.id = (uint32_t)random_uniform(random, 0, choice < 0.3 ? 0x7F0 : 0x30);
    frame.id += choice < 0.3 ? 0 : choice < 0.7 ? JP_CAN_OPERATOR_COMMAND_FRAME_ID : 0;
    frame.id |= choice > 0.95 ? JP_CAN_REMOTE : choice > 0.9 ? JP_CAN_EXTENDED : 0;
    if (random_uniform(random, 0, 1) < 0.5) {
        frame.length =
            frame.id == JP_CAN_OPERATOR_COMMAND_FRAME_ID ? JP_CAN_OPERATOR_COMMAND_LENGTH : JP_CAN_LENGTH_MAX;
    }
    for (unsigned i = 0; i < frame.length; i++) {
        frame.data[i] = (uint8_t)random_uniform(random, 0, 256);
    }
    (void)port->send(port->context, &frame);
    (void)plant_node_accept(plant, &frame);
}
