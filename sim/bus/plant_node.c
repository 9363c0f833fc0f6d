#include "sim/bus/plant_node.h"

#include <math.h>

#include "hal/can/jp_can.h"

#define BATTERY_PERIOD_MS 100U
#define SECONDS_AN_HOUR   3600.0

void plant_node_init(struct plant_node *node, const struct robot_file *robot, uint64_t seed)
{
    *node = (struct plant_node){.sample_counter = 0};
    world_init(&node->world, robot, seed);
    plant_hold(&node->world.plant, 0);
}

static double clamp(double value, double low, double high)
{
    return fmin(fmax(value, low), high);
}

double plant_node_power(const struct plant_node *node)
{
    const struct world *world = &node->world;
    const struct plant_input *input = &world->input;

    return input->voltage_left * plant_current_left(&world->plant, input) +
           input->voltage_right * plant_current_right(&world->plant, input) + world->robot.electronics.power_w;
}

static void send_battery(const struct plant_node *node, const struct jp_can_port *port)
{
    const struct world *world = &node->world;
    const double capacity = world->robot.supply.capacity_wh;
    const double left = clamp(capacity - node->drawn_j / SECONDS_AN_HOUR, 0, capacity);
    const struct jp_can_battery_status_t signals = {
        .voltage = (uint16_t)lround(clamp(world->bus_voltage * 0x1p7, 0, UINT16_MAX)),
        .current = (int16_t)lround(clamp(plant_node_power(node) / world->bus_voltage * 0x1p8, INT16_MIN, INT16_MAX)),
        .state_of_charge = (uint16_t)lround(left / capacity * 0x1p15),
        .energy_left = (uint16_t)lround(clamp(left * 0x1p6, 0, UINT16_MAX)),
    };
    struct jp_can_frame frame = {.id = JP_CAN_BATTERY_STATUS_FRAME_ID, .length = JP_CAN_BATTERY_STATUS_LENGTH};

    (void)jp_can_battery_status_pack(frame.data, &signals, sizeof frame.data);
    (void)port->send(port->context, &frame);
}

void plant_node_sense(struct plant_node *node, const struct jp_can_port *port)
{
    const uint64_t battery_ticks = (uint64_t)node->world.robot.control.rate_hz * BATTERY_PERIOD_MS / 1000U;
    struct jp_can_frame frames[JP_SAMPLE_PARTS];
    struct jp_sensors sensors;

    if (world_read(&node->world, &sensors)) {
        jp_message_from_sensors(frames, &node->sample_counter, &sensors);
        for (unsigned i = 0; i < JP_SAMPLE_PARTS; i++) {
            (void)port->send(port->context, &frames[i]);
        }
    }
    if (node->world.tick % battery_ticks == 0) {
        send_battery(node, port);
    }
}

bool plant_node_accept(struct plant_node *node, const struct jp_can_frame *frame)
{
    if (frame->id != JP_CAN_MOTOR_COMMAND_FRAME_ID) {
        return false;
    }
    if (frame->length != JP_CAN_MOTOR_COMMAND_LENGTH) {
        node->malformed++;
        return false;
    }
    switch (jp_message_to_actuation(&node->receiver, frame, &node->actuation)) {
    case JP_E2E_OK:
        node->commanded = true;
        return true;
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
    node->silence = node->commanded ? 0 : node->silence + 1;
    node->commanded = false;
    if (node->silence == PLANT_HOLD_TICKS + 1U && node->actuation.enabled != 0U) {
        node->silences++;
    }
    if (node->silence > PLANT_HOLD_TICKS) {
        node->actuation = (struct jp_actuation){0};
    }
}

void plant_node_step(struct plant_node *node)
{
    struct world *world = &node->world;

    watch_silence(node);
    (void)world_write(world, &node->actuation);
    if (world->plant.held && node->actuation.enabled != 0U) {
        plant_release(&world->plant);
    }
    world_step(world);
    node->drawn_j += plant_node_power(node) * world_tick_seconds(world);
}
