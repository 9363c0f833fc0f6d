/**
 * An operator on the bus: stands the robot up, hands it a route and lets it drive, in the frames of joulepath.dbc.
 *
 *   idle ─▶ standing up ─▶ uploading ─▶ driving ─▶ done
 *                │             │           │
 *                └─────────────┴───────────┴─────▶ failed
 *
 * A new route or goal leads from every state to standing up, or to uploading while the robot drives: it goes on without
 * a halt. Zero-initialised the operator is idle and silent, so that a robot at rest stays so and another operator is
 * not disturbed. From the first task on it sends OperatorCommand every 100 ms: Drive while driving, else Stand. An
 * upload that goes wrong is repeated under another id. A status counts when two in a row say the same. No clock and no
 * allocation: equal calls send equal frames.
 */
#ifndef JOULEPATH_SIM_OPERATOR_H
#define JOULEPATH_SIM_OPERATOR_H

#include "../hal/can/jp_can.h"
#include "../hal/can/operator_link.h"
#include "../hal/can/route_link.h"

enum operator_state {
    OPERATOR_IDLE,
    OPERATOR_STANDING_UP, /**< until the robot balances */
    OPERATOR_UPLOADING,   /**< until the route is ready */
    OPERATOR_DRIVING,
    OPERATOR_DONE,
    OPERATOR_FAILED
};

/** Something that the ECU sends again and again. */
struct operator_ear {
    uint32_t silence_ms;
    bool heard; /**< not long ago */
};

struct bus_operator {
    enum operator_state state;
    const char *reason;                    /**< of the failure */
    struct jp_can_ecu_status_t ecu;        /**< last heard */
    struct jp_can_route_status_t progress; /**< last heard */
    struct jp_route task;                  /**< with the id of this attempt */

    bool ticked;      /**< last_tick_ms holds */
    bool commanding;  /**< OperatorCommand is sent */
    bool begun;       /**< the ECU has said that it drives the task */
    uint8_t old_task; /**< id of the route that is driven until the new one is ready; 0: none */
    uint8_t attempts; /**< of uploading the task */
    uint8_t sent;     /**< frames of this attempt: the offer, then the waypoints */
    struct operator_ear ecu_ear;
    struct operator_ear progress_ear;
    uint32_t last_tick_ms;
    uint32_t in_state_ms;
    uint32_t since_command_ms;
    uint32_t since_upload_ms; /**< since the last frame of the upload */
    uint8_t command_counter;
    uint8_t offer_counter;
    uint8_t waypoint_counter;
};

/** Drives through the points, in place of what was asked before. False, and nothing changes: not 1…JP_ROUTE_LENGTH_MAX
 *  points, or one beyond ±512 m. */
bool operator_route(struct bus_operator *self, const struct jp_point *points, size_t count);

/** As a route of one point. */
bool operator_goal(struct bus_operator *self, const struct jp_point *goal);

/** Forgets the task: the robot brakes to a balanced stand. Stays silent if nothing was asked yet. */
void operator_stop(struct bus_operator *self);

/** Takes a frame from the bus; all but EcuStatus and RouteStatus are ignored. */
void operator_accept(struct bus_operator *self, const struct jp_can_frame *frame);

/** Sends what is due, at most one frame; one that the port does not take is tried again. To be called once a
 *  millisecond; time_ms may begin anywhere and wrap. */
void operator_tick(struct bus_operator *self, uint32_t time_ms, const struct jp_can_port *port);

/** Why the state is OPERATOR_FAILED, else NULL. */
const char *operator_reason(const struct bus_operator *self);

#endif
