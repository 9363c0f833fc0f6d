#include "sim/bus/local_ecu.h"

static void work(void *context)
{
    struct local_ecu *ecu = context;
    const struct jp_can_link link = can_bus_link(ecu->end);
    struct jp_can_frame frame;

    while (link.receive(link.port.context, &frame)) {
        (void)jp_lockstep_accept(&ecu->node.lockstep, &frame);
    }
}

/** Its own end of the bus; *link is the other one. */
static struct jp_can_link attach(struct local_ecu *ecu, struct jp_can_link *link)
{
    struct can_bus_end *other;

    can_bus_init(&ecu->bus);
    other = can_bus_attach(&ecu->bus);
    ecu->end = can_bus_attach(&ecu->bus);
    other->others = work;
    other->context = ecu;
    *link = can_bus_link(other);
    return can_bus_link(ecu->end);
}

bool local_ecu_start(struct local_ecu *ecu, const struct robot_entry *entry, const struct jp_energy_model *model,
                     struct jp_can_link *link)
{
    const struct jp_can_link own = attach(ecu, link);

    return ecu_node_init(&ecu->node, entry, model, &own.port, NULL, NULL);
}

bool local_ecu_start_skid(struct local_ecu *ecu, const struct skid_robot_entry *entry, struct jp_can_link *link)
{
    const struct jp_can_link own = attach(ecu, link);

    return ecu_node_init_skid(&ecu->node, entry, &own.port, NULL, NULL);
}

bool local_ecu_start_patrol(struct local_ecu *ecu, const struct patrol_robot_entry *entry, struct jp_can_link *link)
{
    const struct jp_can_link own = attach(ecu, link);

    return ecu_node_init_patrol(&ecu->node, entry, &own.port, NULL, NULL);
}
