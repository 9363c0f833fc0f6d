#include "sim/bus/ecu_node.h"

#include "sim/base/error.h"
#include "sim/files/parameters_file.h"

static bool boot(struct ecu_node *node, const struct robot_entry *entry, const struct jp_energy_model *model,
                 const struct jp_can_port *bus, struct jp_retained *retained)
{
    struct jp_retained *const record = retained == NULL ? &node->own_record : retained;
    const char *field = "";

    if (jp_lockstep_start(&node->lockstep, entry->config, model, bus, record, jp_ecu_tick, &field) != JP_OK) {
        error_line("%s: %s is out of range; run make gains ROBOT=%s", entry->name, field, entry->name);
        return false;
    }
    return true;
}

static bool learn(struct ecu_node *node, const struct robot_entry *entry, const struct jp_energy_model *model,
                  enum jp_stored stored)
{
    const bool of_battery = model == entry->energy_battery;
    const struct jp_ecu_learning learning = {
        .learning = of_battery ? entry->learning_battery : entry->learning,
        .of_battery = of_battery,
        .stored = stored,
        .state = &node->parameters.energy,
    };
    const char *field = "";

    if (learning.learning == NULL || (!of_battery && model != entry->energy)) {
        return true;
    }
    if (jp_lockstep_learn(&node->lockstep, &learning, &field) != JP_OK) {
        error_line("%s: %s is out of range; run make learning ROBOT=%s", entry->name, field, entry->name);
        return false;
    }
    return true;
}

static bool navigate(struct ecu_node *node, const struct robot_entry *entry)
{
    const char *field = "";

    if (entry->navigation == NULL || entry->lattice == NULL) {
        return true;
    }
    const struct jp_navigation_config config =
        jp_navigation_config_of(entry->lattice, entry->navigation, &node->ground, &node->block);

    if (jp_lockstep_navigate(&node->lockstep, &node->navigation, &config, &field) != JP_OK) {
        error_line("%s: %s is out of range; run make lattice ROBOT=%s", entry->name, field, entry->name);
        return false;
    }
    return true;
}

/** A place that cannot be written to shows now, not when there is something to keep. */
static bool open_parameters(struct ecu_node *node, const struct jp_robot_config *config, enum jp_stored *stored)
{
    return parameters_file_load(node->path, config, &node->parameters, stored) &&
           (*stored != JP_STORED_NOTHING || parameters_file_save(node->path, config, &node->parameters));
}

bool ecu_node_init(struct ecu_node *node, const struct robot_entry *entry, const struct jp_energy_model *model,
                   const struct jp_can_port *bus, struct jp_retained *retained, const char *parameters)
{
    enum jp_stored stored = JP_STORED_NOTHING;

    node->own_record = (struct jp_retained){0};
    node->path = parameters;
    node->ran = false;
    jp_parameters_default(&node->parameters);
    if (parameters != NULL && !open_parameters(node, entry->config, &stored)) {
        return false;
    }
    return boot(node, entry, model, bus, retained) && learn(node, entry, model, stored) && navigate(node, entry);
}

static bool keep(struct ecu_node *node)
{
    const struct jp_learned_state *state = jp_ecu_learned_state(&node->lockstep.ecu);
    struct jp_parameters learned = node->parameters;

    if (state == NULL) {
        return true;
    }
    learned.energy = *state;
    if (!jp_parameters_differ(&learned, &node->parameters)) {
        return true;
    }
    node->parameters = learned;
    node->lockstep.learning.stored = JP_STORED_TAKEN;
    return node->path == NULL || parameters_file_save(node->path, node->lockstep.config, &learned);
}

static enum jp_robot_state state_of(const struct ecu_node *node)
{
    return jp_robot_state_now(&node->lockstep.ecu.robot);
}

bool ecu_node_watch(struct ecu_node *node)
{
    const enum jp_robot_state state = state_of(node);
    const bool switched_off = state == JP_ROBOT_IDLE && node->ran;

    node->ran = state == JP_ROBOT_BALANCING || state == JP_ROBOT_DRIVING;
    return !switched_off || keep(node);
}

bool ecu_node_end(struct ecu_node *node)
{
    return !node->ran || keep(node);
}
