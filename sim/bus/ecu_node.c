#include "sim/bus/ecu_node.h"

#include "sim/base/error.h"
#include "sim/files/parameters_file.h"

static enum jp_status learn(struct ecu_node *node, const char **field)
{
    const struct robot_entry *entry = node->entry;
    const bool of_battery = node->model == entry->energy_battery;
    const struct jp_ecu_learning learning = {
        .learning = of_battery ? entry->learning_battery : entry->learning,
        .of_battery = of_battery,
        .stored = node->stored,
        .state = &node->parameters.energy,
    };

    if (learning.learning == NULL || (!of_battery && node->model != entry->energy)) {
        return JP_OK;
    }
    return jp_ecu_balancer_learn(&node->robot, &learning, field);
}

static enum jp_status navigate(struct ecu_node *node, struct jp_ecu *ecu, const char **field)
{
    const struct robot_entry *entry = node->entry;
    struct jp_vehicle vehicle;

    if (entry->navigation == NULL || entry->lattice == NULL) {
        return JP_OK;
    }
    const struct jp_navigation_config config =
        jp_navigation_config_of(entry->lattice, entry->navigation, &node->ground, &node->block);
    enum jp_status status = jp_balancer_vehicle_init(&node->vehicle, &node->robot.pilot, &vehicle);

    if (status == JP_OK) {
        status = jp_navigation_init(&node->navigation, &config, &vehicle, node->model->unit_exponent, field);
        jp_ecu_navigate(ecu, &node->navigation);
    }
    return status;
}

static enum jp_status boot(void *context, struct jp_ecu *ecu, const struct jp_can_port *port, const char **field)
{
    struct ecu_node *node = context;
    struct jp_ecu_robot robot;
    enum jp_status status = jp_ecu_balancer_init(&node->robot, node->entry->config, node->model, &robot, field);

    if (status == JP_OK) {
        status = jp_ecu_init(ecu, &robot, port, node->lockstep.config.retained);
    }
    if (status == JP_OK) {
        status = learn(node, field);
    }
    return status == JP_OK ? navigate(node, ecu, field) : status;
}

/** A place that cannot be written to shows now, not when there is something to keep. */
static bool open_parameters(struct ecu_node *node)
{
    const uint32_t identity = jp_robot_identity(node->entry->config);

    return parameters_file_load(node->path, identity, &node->parameters, &node->stored) &&
           (node->stored != JP_STORED_NOTHING || parameters_file_save(node->path, identity, &node->parameters));
}

bool ecu_node_init(struct ecu_node *node, const struct robot_entry *entry, const struct jp_energy_model *model,
                   const struct jp_can_port *bus, struct jp_retained *retained, const char *parameters)
{
    const struct jp_lockstep_config config = {.boot = boot,
                                              .context = node,
                                              .tick = jp_ecu_tick,
                                              .bus = *bus,
                                              .retained = retained == NULL ? &node->own_record : retained};
    const char *field = "";

    node->entry = entry;
    node->model = model;
    node->stored = JP_STORED_NOTHING;
    node->own_record = (struct jp_retained){0};
    node->path = parameters;
    node->ran = false;
    jp_parameters_default(&node->parameters);
    if (parameters != NULL && !open_parameters(node)) {
        return false;
    }
    if (jp_lockstep_start(&node->lockstep, &config, &field) != JP_OK) {
        error_line("%s: %s is out of range; make its tables anew: make robot ROBOT=%s", entry->name, field,
                   entry->name);
        return false;
    }
    return true;
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
    node->stored = JP_STORED_TAKEN;
    return node->path == NULL || parameters_file_save(node->path, jp_robot_identity(node->entry->config), &learned);
}

bool ecu_node_watch(struct ecu_node *node)
{
    const struct jp_ecu *ecu = &node->lockstep.ecu;
    const bool switched_off = jp_ecu_state_now(ecu) == JP_ECU_IDLE && node->ran;

    node->ran = jp_ecu_runs(ecu);
    return !switched_off || keep(node);
}

bool ecu_node_end(struct ecu_node *node)
{
    return !node->ran || keep(node);
}
