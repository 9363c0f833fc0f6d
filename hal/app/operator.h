/**
 * An operator on the bus: stands the robot up, hands it a route and lets it drive, in the frames of joulepath.dbc.
 *
 *   idle ─▶ standing up ─▶ uploading ─▶ driving ─▶ done
 *                │             │           │
 *                └─────────────┴───────────┴─────▶ failed
 *
 * A new route or goal leads from every phase to standing up, or to uploading while the robot drives: it goes on without
 * a halt. Zero-initialised the operator is idle and silent, so that a robot at rest stays so and another operator is
 * not disturbed. From the first task on it sends OperatorCommand every 100 ms: Drive while driving, else Stand. An
 * upload that goes wrong is repeated under another id. A status counts when two in a row say the same. No clock and no
 * allocation: equal calls send equal frames. Each call takes constant time but for the points of a route; none is for
 * two contexts at once.
 */
#ifndef JOULEPATH_HAL_APP_OPERATOR_H
#define JOULEPATH_HAL_APP_OPERATOR_H

#include "hal/app/operator_bus.h"
#include "hal/can/jp_can.h"
#include "hal/can/operator_link.h"
#include "hal/can/route_link.h"

#ifdef __cplusplus
extern "C" {
#endif

enum jp_operator_phase {
    JP_OPERATOR_IDLE,
    JP_OPERATOR_STANDING_UP, /**< until the robot balances */
    JP_OPERATOR_UPLOADING,   /**< until the route is ready */
    JP_OPERATOR_DRIVING,
    JP_OPERATOR_DONE,
    JP_OPERATOR_FAILED
};

/** Why a task has failed. */
enum jp_operator_failure {
    JP_FAILURE_NONE,
    JP_FAILURE_SILENCE,  /**< no EcuStatus or no RouteStatus for 1 s */
    JP_FAILURE_STAND_UP, /**< the robot does not balance within 10 s */
    JP_FAILURE_FALLEN,
    JP_FAILURE_FAULT,
    JP_FAILURE_UPLOAD,   /**< five attempts did not arrive whole */
    JP_FAILURE_LENGTH,   /**< the ECU takes no route of this length */
    JP_FAILURE_NO_START, /**< the ECU does not begin to drive within 5 s */
    JP_FAILURE_RESTART,  /**< the ECU knows no route any more */
    JP_FAILURE_REPLACED, /**< the ECU drives the route of another operator */
    JP_FAILURE_PLAN,     /**< the ECU could plan no segment of the route */
    JP_FAILURE_COMMAND,  /**< the robot was told to stand */
    JP_FAILURE_TIMEOUT,  /**< the robot heard no commands for 500 ms */
    JP_FAILURE_SWITCHED_OFF,
    JP_FAILURE_STOPPED, /**< the route has ended for a reason that is none of these */
    JP_FAILURES
};

/** The members without a comment are private. */
struct jp_operator {
    enum jp_operator_phase phase;          /**< of the task */
    enum jp_operator_failure failure;      /**< JP_FAILURE_NONE unless the phase is JP_OPERATOR_FAILED */
    struct jp_route_message task;          /**< with the id of this attempt */
    struct jp_can_ecu_status_t ecu;        /**< last heard */
    struct jp_can_route_status_t progress; /**< last heard */

    struct jp_operator_ear ecu_ear;
    struct jp_operator_ear progress_ear;
    bool ticked; /* last_tick_ms holds */
    uint32_t last_tick_ms;
    uint32_t in_phase_ms;
    bool commanding; /* OperatorCommand is sent */
    uint32_t since_command_ms;
    bool begun;               /* the ECU has said that it drives the task */
    uint8_t old_task;         /* id of the route that is driven until the new one is ready; 0: none */
    uint8_t attempts;         /* of uploading the task */
    uint8_t sent;             /* frames of this attempt: the offer, then the waypoints */
    uint32_t since_upload_ms; /* since the last frame of the upload */
    uint8_t command_counter;
    uint8_t offer_counter;
    uint8_t waypoint_counter;
};

/** Drives through the points, in place of what was asked before. JP_ERR_ARGUMENT, and nothing changes: a null pointer,
 *  not 1…JP_ROUTE_LENGTH_MAX points, or one beyond ±512 m. */
enum jp_status jp_operator_route(struct jp_operator *self, const struct jp_point *points, size_t count);

/** As a route of one point. */
enum jp_status jp_operator_goal(struct jp_operator *self, const struct jp_point *goal);

/** Forgets the task: the robot brakes to a balanced stand. Stays silent if nothing was asked yet. */
void jp_operator_stop(struct jp_operator *self);

/** Takes a frame from the bus; all but EcuStatus and RouteStatus are ignored. */
void jp_operator_accept(struct jp_operator *self, const struct jp_can_frame *frame);

/** Sends what is due, at most one frame; one that the port does not take is tried again. To be called once a
 *  millisecond; time_ms may begin anywhere and wrap. */
void jp_operator_tick(struct jp_operator *self, uint32_t time_ms, const struct jp_can_port *port);

/** A failure in words and what to do about it; NULL for JP_FAILURE_NONE. */
const char *jp_operator_failure_text(enum jp_operator_failure failure);

#ifdef __cplusplus
}
#endif

#endif
