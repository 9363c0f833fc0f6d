#include "ecu_node.h"

#include "error.h"

bool ecu_node_init(struct ecu_node *node, const struct robot_entry *entry, const struct jp_energy_model *model,
                   const struct jp_can_port *bus, struct jp_retained *retained)
{
    struct jp_retained *const record = retained == NULL ? &node->own_record : retained;
    const char *field = "";

    node->own_record = (struct jp_retained){0};
    if (jp_lockstep_start(&node->lockstep, entry->config, model, bus, record, jp_ecu_tick, &field) != JP_OK) {
        error_line("%s: %s is out of range; run make gains ROBOT=%s", entry->name, field, entry->name);
        return false;
    }
    return true;
}
