#include "hal/can/route_link.h"

#include "hal/can/jp_can.h"

void jp_route_link_start(struct jp_route_link *link, uint32_t tick_rate)
{
    *link = (struct jp_route_link){.state = JP_ROUTE_NONE, .timeout = tick_rate * JP_ROUTE_TIMEOUT_MS / 1000U};
}

static void reject(struct jp_route_link *link, enum jp_route_reason reason)
{
    link->state = JP_ROUTE_REJECTED;
    link->reason = reason;
}

void jp_route_link_pass(struct jp_route_link *link, uint32_t ticks)
{
    if (link->state != JP_ROUTE_RECEIVING) {
        return;
    }
    link->silence += ticks;
    if (link->silence >= link->timeout) {
        reject(link, JP_REASON_TIMEOUT);
    }
}

static bool is_offered(const struct jp_route_link *link, const struct jp_can_route_offer_t *signals)
{
    return link->offered.id == signals->route_id && link->offered.length == signals->length &&
           link->offered_crc == signals->route_crc;
}

enum jp_e2e_result jp_route_link_accept_offer(struct jp_route_link *link, const struct jp_can_frame *frame)
{
    struct jp_can_route_offer_t signals;
    enum jp_e2e_result result = jp_e2e_check(&link->offer_receiver, JP_DATA_ID_ROUTE_OFFER, frame->data, frame->length);

    if (result == JP_E2E_CRC) {
        return result;
    }
    (void)jp_can_route_offer_unpack(&signals, frame->data, frame->length);
    /* The whole route has its own check, so another offer need not follow the one before: its sender may be new. */
    if (result == JP_E2E_REPEATED && is_offered(link, &signals)) {
        return result;
    }
    link->offered.id = signals.route_id;
    link->offered.length = signals.length;
    link->offered_crc = signals.route_crc;
    link->received = 0;
    link->silence = 0;
    link->crc = JP_ROUTE_CRC_START;
    link->waypoint_receiver = (struct jp_e2e_receiver){.synchronised = false};
    if (!jp_can_route_offer_route_id_is_in_range(signals.route_id) ||
        !jp_can_route_offer_length_is_in_range(signals.length)) {
        reject(link, JP_REASON_LENGTH);
        return JP_E2E_OK;
    }
    link->state = JP_ROUTE_RECEIVING;
    link->reason = JP_REASON_NONE;
    return JP_E2E_OK;
}

static void append(struct jp_route_link *link, const struct jp_point *point)
{
    link->silence = 0;
    link->offered.points[link->received++] = *point;
    link->crc = jp_route_crc(link->crc, point);
    if (link->received < link->offered.length) {
        return;
    }
    if (link->crc != link->offered_crc) {
        reject(link, JP_REASON_ROUTE_CRC);
        return;
    }
    link->state = JP_ROUTE_READY;
}

enum jp_e2e_result jp_route_link_accept_waypoint(struct jp_route_link *link, const struct jp_can_frame *frame)
{
    struct jp_can_waypoint_t signals;
    enum jp_e2e_result result = jp_e2e_check(&link->waypoint_receiver, JP_DATA_ID_WAYPOINT, frame->data, frame->length);

    if (result == JP_E2E_CRC || result == JP_E2E_REPEATED || link->state != JP_ROUTE_RECEIVING) {
        return result;
    }
    if (result == JP_E2E_SEQUENCE || (result == JP_E2E_OK && link->waypoint_receiver.gap > 0U)) {
        reject(link, JP_REASON_SEQUENCE);
        return JP_E2E_SEQUENCE;
    }
    (void)jp_can_waypoint_unpack(&signals, frame->data, frame->length);
    append(link, &(struct jp_point){.x = signals.x, .y = signals.y});
    return JP_E2E_OK;
}

static bool is_driving_to(const struct jp_route_link *link, const struct jp_point *point)
{
    const bool known = link->state == JP_ROUTE_DRIVING || link->state == JP_ROUTE_DONE;

    return known && link->driven.id == JP_ROUTE_GOAL && link->driven.points[0].x == point->x &&
           link->driven.points[0].y == point->y;
}

enum jp_e2e_result jp_route_link_accept_goal(struct jp_route_link *link, const struct jp_can_frame *frame)
{
    struct jp_can_goal_t signals;
    enum jp_e2e_result result = jp_e2e_check(&link->goal_receiver, JP_DATA_ID_GOAL, frame->data, frame->length);

    if (result != JP_E2E_OK) {
        return result;
    }
    (void)jp_can_goal_unpack(&signals, frame->data, frame->length);

    const struct jp_point point = {.x = signals.x, .y = signals.y};

    if (!is_driving_to(link, &point)) {
        link->offered = (struct jp_route_message){.id = JP_ROUTE_GOAL, .length = 1, .points = {point}};
        link->received = 1;
        link->state = JP_ROUTE_READY;
        link->reason = JP_REASON_NONE;
    }
    return JP_E2E_OK;
}

const struct jp_route_message *jp_route_link_take(struct jp_route_link *link, uint8_t id)
{
    if (link->state != JP_ROUTE_READY || link->offered.id != id) {
        return NULL;
    }
    link->driven = link->offered;
    link->state = JP_ROUTE_DRIVING;
    return &link->driven;
}

void jp_route_link_forget_goal(struct jp_route_link *link)
{
    if (link->state == JP_ROUTE_DONE && link->driven.id == JP_ROUTE_GOAL) {
        link->state = JP_ROUTE_NONE;
    }
}

void jp_route_link_end(struct jp_route_link *link, enum jp_route_state state, enum jp_route_reason reason)
{
    if (link->state == JP_ROUTE_DRIVING) {
        link->state = state;
        link->reason = reason;
    }
}
