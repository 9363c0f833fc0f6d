/**
 * Routes and goals that arrive in frames: RouteOffer, then its Waypoints; or Goal.
 *
 * A route counts only whole: as many waypoints as offered, none repeated or left out, and the right CRC-32 over all.
 * The route that is driven stays untouched while the next one is received.
 */
#ifndef JOULEPATH_HAL_CAN_ROUTE_LINK_H
#define JOULEPATH_HAL_CAN_ROUTE_LINK_H

#include "hal/can/messages.h"

#ifdef __cplusplus
extern "C" {
#endif

#define JP_ROUTE_LENGTH_MAX 32U

/** Silence between the frames of a route after which it is given up, ms. */
#define JP_ROUTE_TIMEOUT_MS 1000U

/** RouteId of the last Goal. */
#define JP_ROUTE_GOAL 0U

/** Values of State in RouteStatus. */
enum jp_route_state {
    JP_ROUTE_NONE,
    JP_ROUTE_RECEIVING,
    JP_ROUTE_READY,
    JP_ROUTE_DRIVING,
    JP_ROUTE_DONE,
    JP_ROUTE_REJECTED,
    JP_ROUTE_STOPPED
};

/** Values of Reason in RouteStatus. */
enum jp_route_reason {
    JP_REASON_NONE,
    JP_REASON_LENGTH,
    JP_REASON_SEQUENCE,
    JP_REASON_ROUTE_CRC,
    JP_REASON_PLAN,
    JP_REASON_COMMAND,
    JP_REASON_TIMEOUT,
    JP_REASON_SWITCHED_OFF
};

/** What the frames of a route tell. */
struct jp_route_message {
    uint8_t id;
    uint8_t length;
    struct jp_point points[JP_ROUTE_LENGTH_MAX];
};

struct jp_route_link {
    struct jp_e2e_receiver offer_receiver;
    struct jp_e2e_receiver waypoint_receiver;
    struct jp_e2e_receiver goal_receiver;
    struct jp_route_message offered;
    struct jp_route_message driven;
    uint8_t received;     /**< waypoints of the offered route */
    uint32_t silence;     /**< ticks since its last frame */
    uint32_t timeout;     /**< ticks */
    uint32_t crc;         /**< of those */
    uint32_t offered_crc; /**< that the whole must have */
    enum jp_route_state state;
    enum jp_route_reason reason;
};

/** No route. tick_rate 100…10 000 Hz. */
void jp_route_link_start(struct jp_route_link *link, uint32_t tick_rate);

/** `ticks` have passed: a route whose frames fail to come is rejected. */
void jp_route_link_pass(struct jp_route_link *link, uint32_t ticks);

/** Take frames of the right length. JP_E2E_OK although the route is rejected: then state and reason say so.
 *  Constant time. */
enum jp_e2e_result jp_route_link_accept_offer(struct jp_route_link *link, const struct jp_can_frame *frame);
enum jp_e2e_result jp_route_link_accept_waypoint(struct jp_route_link *link, const struct jp_can_frame *frame);
enum jp_e2e_result jp_route_link_accept_goal(struct jp_route_link *link, const struct jp_can_frame *frame);

/** Hands over the ready route of this id, which is then driven; NULL: it is not ready. It stays in place until the next
 *  call that succeeds. */
const struct jp_route_message *jp_route_link_take(struct jp_route_link *link, uint8_t id);

/** A goal that was reached may be given again. */
void jp_route_link_forget_goal(struct jp_route_link *link);

/** The driven route has ended; ignored when none is driven. */
void jp_route_link_end(struct jp_route_link *link, enum jp_route_state state, enum jp_route_reason reason);

#ifdef __cplusplus
}
#endif

#endif
