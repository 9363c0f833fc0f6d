#include "sim/bus/plant_node.h"

#include <math.h>

#include "hal/can/jp_can.h"
#include "sim/base/fingerprint.h"
#include "sim/skid_steer/skid_hal_sim.h"

#define BATTERY_PERIOD_MS 100U
#define SECONDS_AN_HOUR   3600.0

void plant_node_init(struct plant_node *node, const struct robot_file *robot, uint64_t seed)
{
    *node = (struct plant_node){.kind = PLANT_BALANCER};
    world_init(&node->world, robot, seed);
    plant_hold(&node->world.plant, 0);
    node->power_w = robot->electronics.power_w;
}

void plant_node_init_skid(struct plant_node *node, const struct skid_steer_model *model,
                          const struct skid_ground *ground, const struct planar_pose *pose, uint64_t seed)
{
    *node = (struct plant_node){.kind = PLANT_SKID};
    skid_world_init(&node->skid, model, ground, pose, seed);
}

void plant_node_init_patrol(struct plant_node *node, struct patrol_body *body)
{
    *node = (struct plant_node){.kind = PLANT_PATROL, .patrol = body};
}

double plant_node_rate(const struct plant_node *node)
{
    if (node->kind == PLANT_PATROL) {
        return FOUR_WHEEL_RATE_HZ;
    }
    return node->kind == PLANT_SKID ? node->skid.plant.model.control.rate_hz : node->world.robot.control.rate_hz;
}

uint64_t plant_node_tick(const struct plant_node *node)
{
    if (node->kind == PLANT_PATROL) {
        return node->patrol->tick;
    }
    return node->kind == PLANT_SKID ? node->skid.tick : node->world.tick;
}

static void look_at_balancer(const struct world *world, struct plant_truth *truth)
{
    const struct plant *plant = &world->plant;

    *truth = (struct plant_truth){.x = plant->x,
                                  .y = plant->y,
                                  .heading = plant->state.yaw,
                                  .speed = plant->state.wheel_rate * world->robot.wheel.radius_m,
                                  .turn_rate = plant->state.yaw_rate,
                                  .pitch = plant->state.pitch,
                                  .current_left = plant_current_left(plant, &world->input),
                                  .current_right = plant_current_right(plant, &world->input)};
}

static void look_at_skid(const struct skid_plant *plant, struct plant_truth *truth)
{
    const struct planar_pose pose = skid_plant_pose(plant);

    *truth = (struct plant_truth){.x = pose.x,
                                  .y = pose.y,
                                  .heading = pose.heading,
                                  .speed = plant->state.forward,
                                  .turn_rate = plant->state.turn_rate,
                                  .current_left = plant->attitude.current[SKID_LEFT],
                                  .current_right = plant->attitude.current[SKID_RIGHT]};
}

static void look_at_patrol(const struct four_wheel_plant *plant, struct plant_truth *truth)
{
    const struct four_wheel_state *state = &plant->state;

    *truth = (struct plant_truth){.x = state->pose.x,
                                  .y = state->pose.y,
                                  .heading = state->pose.heading,
                                  .speed = state->forward,
                                  .turn_rate = state->turn_rate};
}

void plant_node_look(const struct plant_node *node, struct plant_truth *truth)
{
    if (node->kind == PLANT_PATROL) {
        look_at_patrol(&node->patrol->plant, truth);
    } else if (node->kind == PLANT_SKID) {
        look_at_skid(&node->skid.plant, truth);
    } else {
        look_at_balancer(&node->world, truth);
    }
}

void plant_node_fingerprint(const struct plant_node *node, uint64_t *fingerprint)
{
    const struct plant *plant = &node->world.plant;

    if (node->kind == PLANT_PATROL) {
        fingerprint_add(fingerprint, &node->patrol->plant.state, sizeof node->patrol->plant.state);
        return;
    }
    if (node->kind == PLANT_SKID) {
        fingerprint_add(fingerprint, &node->skid.plant.state, sizeof node->skid.plant.state);
        return;
    }
    fingerprint_add(fingerprint, &plant->x, sizeof plant->x);
    fingerprint_add(fingerprint, &plant->y, sizeof plant->y);
    fingerprint_add(fingerprint, &plant->state, sizeof plant->state);
    fingerprint_add(fingerprint, &plant->ledger, sizeof plant->ledger);
}

static double clamp(double value, double low, double high)
{
    return fmin(fmax(value, low), high);
}

static void send_battery(const struct plant_node *node, const struct jp_can_port *port)
{
    const struct world *world = &node->world;
    const double capacity = world->robot.supply.capacity_wh;
    const double left = clamp(capacity - node->drawn_j / SECONDS_AN_HOUR, 0, capacity);
    const struct jp_can_battery_status_t signals = {
        .voltage = (uint16_t)lround(clamp(world->bus_voltage * 0x1p7, 0, UINT16_MAX)),
        .current = (int16_t)lround(clamp(node->power_w / world->bus_voltage * 0x1p8, INT16_MIN, INT16_MAX)),
        .state_of_charge = (uint16_t)lround(left / capacity * 0x1p15),
        .energy_left = (uint16_t)lround(clamp(left * 0x1p6, 0, UINT16_MAX)),
    };
    struct jp_can_frame frame = {.id = JP_CAN_BATTERY_STATUS_FRAME_ID, .length = JP_CAN_BATTERY_STATUS_LENGTH};

    (void)jp_can_battery_status_pack(frame.data, &signals, sizeof frame.data);
    (void)port->send(port->context, &frame);
}

static bool read_skid(struct plant_node *node, struct jp_sensors *sensors)
{
    const struct jp_hal hal = skid_hal_sim(&node->skid);

    if (world_faults_fail(&node->faults, WORLD_HAL_READ, node->skid.tick)) {
        return false;
    }
    (void)hal.read(hal.context, sensors);
    world_faults_apply(&node->faults, node->skid.tick, sensors);
    return true;
}

static bool read_sensors(struct plant_node *node, struct jp_sensors *sensors)
{
    return node->kind == PLANT_SKID ? read_skid(node, sensors) : world_read(&node->world, sensors);
}

void plant_node_sense(struct plant_node *node, const struct jp_can_port *port)
{
    const uint64_t battery_ticks = (uint64_t)plant_node_rate(node) * BATTERY_PERIOD_MS / 1000U;
    struct jp_can_frame frames[JP_SAMPLE_PARTS];
    struct jp_sensors sensors;

    if (node->kind == PLANT_PATROL) {
        patrol_body_sense(node->patrol, port);
        return;
    }
    if (read_sensors(node, &sensors)) {
        jp_message_from_sensors(frames, &node->sample_counter, &sensors);
        for (unsigned i = 0; i < JP_SAMPLE_PARTS; i++) {
            (void)port->send(port->context, &frames[i]);
        }
    }
    if (node->kind == PLANT_BALANCER && node->world.tick % battery_ticks == 0) {
        send_battery(node, port);
    }
}

static enum jp_e2e_result accept_motors(struct plant_node *node, const struct jp_can_frame *frame, bool *is_whole)
{
    const enum jp_e2e_result result = jp_message_to_actuation(&node->receiver, frame, &node->actuation);

    *is_whole = result == JP_E2E_OK;
    return result;
}

static enum jp_e2e_result accept_wheels(struct plant_node *node, const struct jp_can_frame *frame, bool *is_whole)
{
    const enum jp_e2e_result result = patrol_body_accept(node->patrol, frame, is_whole);

    if (*is_whole) {
        node->actuation.enabled = node->patrol->actuation.enabled;
    }
    return result;
}

bool plant_node_accept(struct plant_node *node, const struct jp_can_frame *frame)
{
    static const struct {
        uint32_t id;
        uint8_t length;
    } commands[] = {{JP_CAN_MOTOR_COMMAND_FRAME_ID, JP_CAN_MOTOR_COMMAND_LENGTH},
                    {JP_CAN_WHEEL_TARGET_FRAME_ID, JP_CAN_WHEEL_TARGET_LENGTH}};
    const bool has_wheels = node->kind == PLANT_PATROL;
    bool is_whole;

    if (frame->id != commands[has_wheels].id) {
        return false;
    }
    if (frame->length != commands[has_wheels].length) {
        node->malformed++;
        return false;
    }
    switch (has_wheels ? accept_wheels(node, frame, &is_whole) : accept_motors(node, frame, &is_whole)) {
    case JP_E2E_OK:
        node->commanded = node->commanded || is_whole;
        return is_whole;
    case JP_E2E_CRC:
        node->crc_errors++;
        return false;
    case JP_E2E_REPEATED:
    case JP_E2E_SEQUENCE:
        node->sequence_errors++;
        return false;
    case JP_E2E_FIRST:
    default:
        return false;
    }
}

static void watch_silence(struct plant_node *node)
{
    const uint32_t hold_ticks = (uint32_t)(plant_node_rate(node) * PLANT_HOLD_MS / 1000);

    node->silence = node->commanded ? 0 : node->silence + 1;
    node->commanded = false;
    if (node->silence == hold_ticks + 1U && node->actuation.enabled != 0U) {
        node->silences++;
    }
    if (node->silence > hold_ticks) {
        node->actuation = (struct jp_actuation){0};
    }
}

static void step_balancer(struct plant_node *node)
{
    struct world *world = &node->world;
    const struct plant_input *input = &world->input;

    (void)world_write(world, &node->actuation);
    if (world->plant.held && node->actuation.enabled != 0U) {
        plant_release(&world->plant);
    }
    world_step(world);
    node->power_w = input->voltage_left * plant_current_left(&world->plant, input) +
                    input->voltage_right * plant_current_right(&world->plant, input) + world->robot.electronics.power_w;
    node->drawn_j += node->power_w * world_tick_seconds(world);
}

static void step_skid(struct plant_node *node)
{
    const struct skid_ledger *ledger = &node->skid.plant.state.ledger;
    const double before = node->drawn_j;

    node->skid.actuation = node->actuation;
    if (world_faults_fail(&node->faults, WORLD_HAL_WRITE, node->skid.tick)) {
        node->skid.actuation = (struct jp_actuation){0};
    }
    skid_world_step(&node->skid);
    node->drawn_j = ledger->battery - ledger->supply;
    node->power_w = (node->drawn_j - before) / skid_world_tick_seconds(&node->skid);
}

static void step_patrol(struct plant_node *node)
{
    const double before = node->drawn_j;

    node->patrol->actuation.enabled = node->actuation.enabled;
    patrol_body_step(node->patrol);
    node->drawn_j = node->patrol->plant.ledger.battery;
    node->power_w = (node->drawn_j - before) * FOUR_WHEEL_RATE_HZ;
}

void plant_node_step(struct plant_node *node)
{
    watch_silence(node);
    if (node->kind == PLANT_PATROL) {
        step_patrol(node);
    } else if (node->kind == PLANT_SKID) {
        step_skid(node);
    } else {
        step_balancer(node);
    }
}
