#include "hal/app/lockstep.h"

#include "hal/can/jp_can.h"

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    struct jp_lockstep *lockstep = context;

    return lockstep->bus_off ? JP_ERR_HARDWARE : lockstep->config.bus.send(lockstep->config.bus.context, frame);
}

static enum jp_can_state state(void *context)
{
    struct jp_lockstep *lockstep = context;

    return lockstep->bus_off ? JP_CAN_BUS_OFF : lockstep->config.bus.state(lockstep->config.bus.context);
}

static enum jp_status boot(struct jp_lockstep *lockstep, const char **field)
{
    const struct jp_can_port port = {.context = lockstep, .send = send, .state = state};

    return lockstep->config.boot(lockstep->config.context, &lockstep->ecu, &port, field);
}

enum jp_status jp_lockstep_start(struct jp_lockstep *lockstep, const struct jp_lockstep_config *config,
                                 const char **field)
{
    if (lockstep == NULL || config == NULL || config->boot == NULL || config->tick == NULL ||
        config->retained == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *lockstep = (struct jp_lockstep){.config = *config, .running = true};
    return boot(lockstep, field);
}

static void answer(struct jp_lockstep *lockstep, uint32_t tick)
{
    struct jp_can_frame frame = {.id = JP_CAN_SIM_DONE_FRAME_ID, .length = JP_CAN_SIM_DONE_LENGTH};
    const struct jp_can_sim_done_t signals = {.tick = tick};

    (void)jp_can_sim_done_pack(frame.data, &signals, sizeof frame.data);
    (void)lockstep->config.bus.send(lockstep->config.bus.context, &frame);
}

static void take_time(struct jp_lockstep *lockstep, const struct jp_can_sim_time_t *time)
{
    const bool was_running = lockstep->running;
    const char *field;

    lockstep->bus_off = time->bus_off != 0U;
    lockstep->running = time->power != 0U && time->reset == 0U;
    if (time->power == 0U) {
        *lockstep->config.retained = (struct jp_retained){0};
    }
    if (lockstep->running && !was_running) {
        (void)boot(lockstep, &field);
    }
    if (lockstep->running) {
        jp_ecu_work(&lockstep->ecu);
        lockstep->config.tick(&lockstep->ecu);
    }
}

/** A tick that was already done is only answered again. */
static void take_tick(struct jp_lockstep *lockstep, const struct jp_can_sim_time_t *time)
{
    const bool asked_again = lockstep->answered && time->tick == lockstep->last_tick;
    const bool leaves_answer = lockstep->other_answers && lockstep->running && !lockstep->ecu.internal.owns_bridges;

    if (!asked_again) {
        take_time(lockstep, time);
    }
    lockstep->answered = true;
    lockstep->last_tick = time->tick;
    lockstep->other_answers = false;
    if (asked_again || !leaves_answer) {
        answer(lockstep, time->tick);
    }
}

bool jp_lockstep_accept(struct jp_lockstep *lockstep, const struct jp_can_frame *frame)
{
    struct jp_can_sim_time_t time;

    if (frame->id == JP_CAN_SIM_TIME_FRAME_ID && frame->length == JP_CAN_SIM_TIME_LENGTH) {
        (void)jp_can_sim_time_unpack(&time, frame->data, frame->length);
        take_tick(lockstep, &time);
        return false;
    }
    lockstep->other_answers = lockstep->other_answers || frame->id == JP_CAN_SIM_DONE_FRAME_ID;
    return lockstep->running && !lockstep->bus_off && jp_ecu_accept(&lockstep->ecu, frame);
}
