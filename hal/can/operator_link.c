#include "hal/can/operator_link.h"

#include "hal/can/jp_can.h"

void jp_operator_link_start(struct jp_operator_link *link, uint32_t tick_rate)
{
    *link = (struct jp_operator_link){.state = JP_OPERATOR_NONE, .timeout = tick_rate * JP_OPERATOR_TIMEOUT_MS / 1000U};
}

/** Counts equal commands that follow each other without a gap, `before` being the counter of the last one. */
static void confirm(struct jp_operator_link *link, uint8_t before, enum jp_operator_mode mode, uint8_t route)
{
    const bool follows = link->receiver.counter == ((before + 1U) & 0x0FU);

    if (!follows || link->heard != mode || link->heard_route != route) {
        link->confirmations = 0;
    }
    if (link->confirmations < JP_OPERATOR_CONFIRMATIONS) {
        link->confirmations++;
    }
    link->heard = mode;
    link->heard_route = route;
}

/** Whether the robot may move in a mode. */
static bool is_moving(enum jp_operator_mode mode)
{
    return mode == JP_MODE_DRIVE || mode == JP_MODE_NAVIGATE;
}

static void obey(struct jp_operator_link *link)
{
    const bool confirmed = link->confirmations >= JP_OPERATOR_CONFIRMATIONS;

    if (link->heard == JP_MODE_STAND) {
        link->mode = JP_MODE_STAND;
        link->state = JP_OPERATOR_ALIVE;
    } else if (link->heard == JP_MODE_OFF && confirmed) {
        link->mode = JP_MODE_OFF;
        link->state = JP_OPERATOR_ALIVE;
    } else if (is_moving(link->heard) && confirmed && link->state == JP_OPERATOR_ALIVE && link->mode != JP_MODE_OFF) {
        link->mode = link->heard;
        link->route = link->heard_route;
    }
}

/** Out of sequence: an operator's own old command, or that of another node. Only a stop is safe to take from it. */
static void obey_stop(struct jp_operator_link *link, const struct jp_can_operator_command_t *signals)
{
    if (signals->mode == JP_MODE_STAND) {
        link->confirmations = 0;
        link->mode = is_moving(link->mode) ? JP_MODE_STAND : link->mode;
    }
}

enum jp_operator_result jp_operator_link_accept(struct jp_operator_link *link, const struct jp_can_frame *frame)
{
    struct jp_can_operator_command_t signals;
    const uint8_t before = link->receiver.counter;
    enum jp_e2e_result result = jp_e2e_check(&link->receiver, JP_DATA_ID_OPERATOR_COMMAND, frame->data, frame->length);

    if (result == JP_E2E_FIRST) {
        return JP_OPERATOR_OK;
    }
    if (result == JP_E2E_CRC) {
        return JP_OPERATOR_CRC;
    }
    (void)jp_can_operator_command_unpack(&signals, frame->data, frame->length);
    if (result != JP_E2E_OK) {
        obey_stop(link, &signals);
        return JP_OPERATOR_SEQUENCE;
    }
    if (!jp_can_operator_command_mode_is_in_range(signals.mode)) {
        link->confirmations = 0;
        return JP_OPERATOR_MALFORMED;
    }
    link->silence = 0;
    confirm(link, before, (enum jp_operator_mode)signals.mode, signals.route_id);
    obey(link);
    return JP_OPERATOR_OK;
}

bool jp_operator_link_pass(struct jp_operator_link *link, uint32_t ticks)
{
    if (link->state != JP_OPERATOR_ALIVE) {
        return false;
    }
    link->silence += ticks;
    if (link->silence < link->timeout) {
        return false;
    }
    link->state = JP_OPERATOR_LOST;
    link->confirmations = 0;
    if (is_moving(link->mode)) {
        link->mode = JP_MODE_STAND;
    }
    return true;
}
