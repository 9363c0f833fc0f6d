#include "ecu_node.h"

#include "../hal/can/jp_can.h"
#include "error.h"

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    struct ecu_node *node = context;

    return node->bus_off ? JP_ERR_HARDWARE : node->bus.send(node->bus.context, frame);
}

static enum jp_can_state state(void *context)
{
    struct ecu_node *node = context;

    return node->bus_off ? JP_CAN_BUS_OFF : node->bus.state(node->bus.context);
}

static bool boot(struct ecu_node *node)
{
    const struct jp_can_port port = {.context = node, .send = send, .state = state};
    const char *field = "";

    if (jp_ecu_init(&node->ecu, node->entry->config, node->model, &port, node->retained, &field) != JP_OK) {
        error_line("%s: %s is out of range; run make gains ROBOT=%s", node->entry->name, field, node->entry->name);
        return false;
    }
    return true;
}

bool ecu_node_init(struct ecu_node *node, const struct robot_entry *entry, const struct jp_energy_model *model,
                   const struct jp_can_port *bus, struct jp_retained *retained)
{
    *node = (struct ecu_node){.entry = entry, .model = model, .bus = *bus, .retained = retained, .running = true};
    if (retained == NULL) {
        node->retained = &node->own_record;
    }
    return boot(node);
}

void ecu_node_tick(struct ecu_node *node)
{
    jp_ecu_work(&node->ecu);
    jp_ecu_tick(&node->ecu);
}

static void answer(struct ecu_node *node, uint32_t tick)
{
    struct jp_can_frame frame = {.id = JP_CAN_SIM_DONE_FRAME_ID, .length = JP_CAN_SIM_DONE_LENGTH};
    const struct jp_can_sim_done_t signals = {.tick = tick};

    (void)jp_can_sim_done_pack(frame.data, &signals, sizeof frame.data);
    (void)node->bus.send(node->bus.context, &frame);
}

static void take_time(struct ecu_node *node, const struct jp_can_sim_time_t *time)
{
    const bool was_running = node->running;

    node->bus_off = time->bus_off != 0U;
    node->running = time->power != 0U && time->reset == 0U;
    if (time->power == 0U) {
        *node->retained = (struct jp_retained){0};
    }
    /* The configuration was accepted at the first start, so this one succeeds. */
    if (node->running && !was_running) {
        (void)boot(node);
    }
    if (node->running) {
        ecu_node_tick(node);
    }
}

/** A tick that was already done is only answered again. */
static void take_tick(struct ecu_node *node, const struct jp_can_sim_time_t *time)
{
    const bool asked_again = node->answered && time->tick == node->last_tick;
    const bool leaves_answer = node->other_answers && node->running && !node->ecu.owns_bridges;

    if (!asked_again) {
        take_time(node, time);
    }
    node->answered = true;
    node->last_tick = time->tick;
    node->other_answers = false;
    if (asked_again || !leaves_answer) {
        answer(node, time->tick);
    }
}

bool ecu_node_accept(struct ecu_node *node, const struct jp_can_frame *frame)
{
    struct jp_can_sim_time_t time;

    if (frame->id == JP_CAN_SIM_TIME_FRAME_ID && frame->length == JP_CAN_SIM_TIME_LENGTH) {
        (void)jp_can_sim_time_unpack(&time, frame->data, frame->length);
        take_tick(node, &time);
        return false;
    }
    node->other_answers = node->other_answers || frame->id == JP_CAN_SIM_DONE_FRAME_ID;
    return node->running && !node->bus_off && jp_ecu_accept(&node->ecu, frame);
}
