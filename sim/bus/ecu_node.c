#include "sim/bus/ecu_node.h"

#include "sim/base/error.h"
#include "sim/files/parameters_file.h"

/** From which on what is left is told to suffice. */
#define CONFIDENCE (JP_Q31_MAX / 1000 * 999)

/** What the robot's firmware knows of its cells; NULL: nothing. */
static enum jp_status use_battery(struct ecu_node *node, struct jp_ecu *ecu, const struct jp_battery_config *config,
                                  int32_t unit_exponent, const char **field)
{
    enum jp_status status = JP_OK;

    node->battery = (struct jp_ecu_battery){.has_started = false};
    if (config != NULL) {
        status = jp_ecu_battery_init(&node->battery, config, unit_exponent, field);
        jp_ecu_use_battery(ecu, &node->battery);
    }
    return status;
}

/* A balancer. */

static enum jp_status learn(struct ecu_node *node, const char **field)
{
    struct ecu_node_balancer *balancer = &node->balancer;
    const struct robot_entry *entry = balancer->entry;
    const bool of_battery = balancer->model == entry->energy_battery;
    const struct jp_ecu_learning learning = {
        .learning = of_battery ? entry->learning_battery : entry->learning,
        .of_battery = of_battery,
        .stored = node->stored,
        .state = &node->parameters.energy,
    };

    if (learning.learning == NULL || (!of_battery && balancer->model != entry->energy)) {
        return JP_OK;
    }
    return jp_ecu_balancer_learn(&balancer->robot, &learning, field);
}

/** It navigates where there are tables for that. */
static enum jp_status navigate(struct ecu_node *node, struct jp_ecu *ecu, const struct jp_lattice *lattice,
                               const struct jp_navigator_body *body, const struct jp_vehicle *vehicle,
                               int32_t unit_exponent, const char **field)
{
    struct jp_navigation_config config = jp_navigation_config_of(lattice, body, &node->ground, &node->block);

    node->home = jp_navigation_home_of(&node->home_memory, &node->battery,
                                       node->confidence != 0 ? node->confidence : CONFIDENCE);
    node->home.turns_back = node->confidence != 0;
    config.home = &node->home;
    const enum jp_status status = jp_navigation_init(&node->navigation, &config, vehicle, unit_exponent, field);

    jp_ecu_navigate(ecu, &node->navigation);
    return status;
}

static enum jp_status navigate_balancer(struct ecu_node *node, struct jp_ecu *ecu, const char **field)
{
    struct ecu_node_balancer *balancer = &node->balancer;
    const struct robot_entry *entry = balancer->entry;
    struct jp_vehicle vehicle;

    if (entry->navigation == NULL || entry->lattice == NULL) {
        return JP_OK;
    }
    /* What its motors alone take says nothing of its battery. */
    const enum jp_status status =
        use_battery(node, ecu, balancer->model == entry->energy_battery ? entry->battery : NULL,
                    balancer->model->unit_exponent, field);

    if (status != JP_OK) {
        return status;
    }
    (void)jp_balancer_vehicle_init(&balancer->vehicle, &balancer->robot.pilot, &vehicle);
    return navigate(node, ecu, entry->lattice, entry->navigation, &vehicle, balancer->model->unit_exponent, field);
}

static enum jp_status boot_balancer(void *context, struct jp_ecu *ecu, const struct jp_can_port *port,
                                    const char **field)
{
    struct ecu_node *node = context;
    struct ecu_node_balancer *balancer = &node->balancer;
    struct jp_ecu_robot robot;
    enum jp_status status =
        jp_ecu_balancer_init(&balancer->robot, balancer->entry->config, balancer->model, &robot, field);

    if (status == JP_OK) {
        status = jp_ecu_init(ecu, &robot, port, node->lockstep.config.retained);
    }
    if (status == JP_OK) {
        status = learn(node, field);
    }
    return status == JP_OK ? navigate_balancer(node, ecu, field) : status;
}

/* A robot that its sides steer. */

static enum jp_status navigate_skid(struct ecu_node *node, struct jp_ecu *ecu, const char **field)
{
    struct ecu_node_skid *skid = &node->skid;
    const struct skid_robot_entry *entry = skid->entry;
    struct jp_vehicle vehicle;

    if (entry->navigation == NULL) {
        return JP_OK;
    }
    const enum jp_status status = use_battery(node, ecu, entry->battery, entry->energy->unit_exponent, field);

    if (status != JP_OK) {
        return status;
    }
    (void)jp_skid_vehicle_init(&skid->vehicle, &skid->robot.pilot, &vehicle);
    return navigate(node, ecu, entry->navigation_lattice, entry->navigation, &vehicle, entry->energy->unit_exponent,
                    field);
}

static enum jp_status boot_skid(void *context, struct jp_ecu *ecu, const struct jp_can_port *port, const char **field)
{
    struct ecu_node *node = context;
    struct ecu_node_skid *skid = &node->skid;
    const struct jp_navigator_body *body = skid->entry->navigation;
    const struct jp_ecu_skid_config config = {.robot = skid->entry->config,
                                              .energy = skid->entry->energy,
                                              .learning = skid->entry->learning,
                                              .limits = skid->entry->limits,
                                              .corner = skid->entry->limits->width / 2,
                                              .goal_corner =
                                                  body == NULL ? 0 : body->margin * (JP_Q24_ONE / JP_Q16_ONE),
                                              .stored = node->stored,
                                              .state = &node->parameters.energy,
                                              .scale = &node->parameters.gyro_scale};
    struct jp_ecu_robot robot;
    enum jp_status status = jp_ecu_skid_init(&skid->robot, &config, &robot, field);

    if (status == JP_OK) {
        status = jp_ecu_init(ecu, &robot, port, node->lockstep.config.retained);
    }
    return status == JP_OK ? navigate_skid(node, ecu, field) : status;
}

/* A robot with four steered wheels. */

static enum jp_status boot_patrol(void *context, struct jp_ecu *ecu, const struct jp_can_port *port, const char **field)
{
    struct ecu_node *node = context;
    struct ecu_node_patrol *patrol = &node->patrol;
    const struct jp_map_room room = jp_patrol_map_room(&patrol->map);
    const struct jp_patrol_pilot_config pilot = {.patrol = patrol->entry->patrol,
                                                 .localiser = patrol->entry->localiser,
                                                 .scanner = patrol->entry->scanner,
                                                 .energy = patrol->entry->energy,
                                                 .learning = patrol->entry->learning,
                                                 .points_max = JP_PATROL_POINTS_MAX,
                                                 .turns_max = JP_PATROL_TURNS_MAX};
    const struct jp_ecu_patrol_config config = {.robot = patrol->entry->config,
                                                .pilot = &pilot,
                                                .block = patrol->block.words,
                                                .size = sizeof patrol->block.words,
                                                .stored = node->stored,
                                                .state = &node->parameters.energy};
    struct jp_ecu_robot robot;
    enum jp_status status = jp_ecu_patrol_init(&patrol->robot, &config, &robot, field);

    if (status == JP_OK) {
        status = jp_ecu_init(ecu, &robot, port, node->lockstep.config.retained);
    }
    if (status == JP_OK) {
        const struct jp_wayfinder finder = jp_ecu_patrol_round_wayfinder(&patrol->round, &patrol->robot);

        status = jp_navigation_init_with(&node->navigation, &finder, &room);
        jp_ecu_navigate(ecu, &node->navigation);
    }
    return status;
}

/* Of any kind. */

/** A place that cannot be written to shows now, not when there is something to keep. */
static bool open_parameters(struct ecu_node *node)
{
    return parameters_file_load(node->path, node->identity, &node->parameters, &node->stored) &&
           (node->stored != JP_STORED_NOTHING || parameters_file_save(node->path, node->identity, &node->parameters));
}

static bool start(struct ecu_node *node, const struct jp_lockstep_config *config, const char *parameters)
{
    const char *field = "";

    node->stored = JP_STORED_NOTHING;
    node->path = parameters;
    node->confidence = 0;
    node->ran = false;
    jp_parameters_default(&node->parameters);
    if (parameters != NULL && !open_parameters(node)) {
        return false;
    }
    if (jp_lockstep_start(&node->lockstep, config, &field) != JP_OK) {
        error_line("%s: %s is out of range; make its tables anew: make robot ROBOT=%s", node->name, field, node->name);
        return false;
    }
    return true;
}

static struct jp_lockstep_config lockstep_of(struct ecu_node *node, const struct jp_can_port *bus,
                                             struct jp_retained *retained)
{
    node->own_record = (struct jp_retained){0};
    return (struct jp_lockstep_config){.boot = node->patrol.entry != NULL ? boot_patrol
                                               : node->skid.entry != NULL ? boot_skid
                                                                          : boot_balancer,
                                       .context = node,
                                       .tick = jp_ecu_tick,
                                       .bus = *bus,
                                       .retained = retained == NULL ? &node->own_record : retained};
}

bool ecu_node_init(struct ecu_node *node, const struct robot_entry *entry, const struct jp_energy_model *model,
                   const struct jp_can_port *bus, struct jp_retained *retained, const char *parameters)
{
    node->name = entry->name;
    node->identity = jp_robot_identity(entry->config);
    node->balancer.entry = entry;
    node->balancer.model = model;
    node->skid.entry = NULL;
    node->patrol.entry = NULL;

    const struct jp_lockstep_config config = lockstep_of(node, bus, retained);

    return start(node, &config, parameters);
}

bool ecu_node_init_skid(struct ecu_node *node, const struct skid_robot_entry *entry, const struct jp_can_port *bus,
                        struct jp_retained *retained, const char *parameters)
{
    node->name = entry->name;
    node->identity = jp_skid_robot_identity(entry->config);
    node->balancer.entry = NULL;
    node->skid.entry = entry;
    node->patrol.entry = NULL;

    const struct jp_lockstep_config config = lockstep_of(node, bus, retained);

    return start(node, &config, parameters);
}

bool ecu_node_init_patrol(struct ecu_node *node, const struct patrol_robot_entry *entry, const struct jp_can_port *bus,
                          struct jp_retained *retained, const char *parameters)
{
    node->name = entry->name;
    node->identity = jp_four_wheel_robot_identity(entry->config);
    node->balancer.entry = NULL;
    node->skid.entry = NULL;
    node->patrol.entry = entry;

    const struct jp_lockstep_config config = lockstep_of(node, bus, retained);

    return start(node, &config, parameters);
}

static bool keep(struct ecu_node *node)
{
    const struct jp_learned_state *state = jp_ecu_learned_state(&node->lockstep.ecu);
    struct jp_parameters learned = node->parameters;

    if (state == NULL) {
        return true;
    }
    learned.energy = *state;
    if (node->skid.entry != NULL) {
        learned.gyro_scale = jp_ecu_skid_gyro_scale(&node->skid.robot);
    }
    if (!jp_parameters_differ(&learned, &node->parameters)) {
        return true;
    }
    node->parameters = learned;
    node->stored = JP_STORED_TAKEN;
    return node->path == NULL || parameters_file_save(node->path, node->identity, &learned);
}

void ecu_node_turn_back(struct ecu_node *node, jp_q31 confidence)
{
    node->confidence = confidence;
    node->home.confidence = confidence;
    node->home.turns_back = true;
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
