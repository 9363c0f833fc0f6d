/**
 * An operator that sends a robot over a map to a goal, or on a round between places: hands it the map and what a sensor
 * sees otherwise, and lets it drive, in the frames of joulepath.dbc.
 *
 *   idle ─▶ standing up ─▶ sending ─▶ asking ─▶ driving ─▶ done
 *                │            │          │         │
 *                └────────────┴──────────┴─────────┴─────▶ failed
 *
 * Zero-initialised it is idle and silent. From the first task on it sends OperatorCommand every 100 ms: Navigate while
 * driving, else Stand. What gets lost of the map or of the changes is sent again from there. A status counts when two
 * in a row say the same. No clock and no allocation: equal calls send equal frames. Each call takes constant time; none
 * is for two contexts at once.
 */
#ifndef JOULEPATH_HAL_APP_NAVIGATION_OPERATOR_H
#define JOULEPATH_HAL_APP_NAVIGATION_OPERATOR_H

#include "hal/app/navigation.h"
#include "hal/app/operator_bus.h"
#include "hal/app/round_sender.h"
#include "hal/can/jp_can.h"
#include "hal/can/operator_link.h"

#ifdef __cplusplus
extern "C" {
#endif

/** CellChanges that wait to be sent or to be acknowledged. */
#define JP_CHANGES_WAITING 128U

enum jp_navigation_phase {
    JP_NAVIGATION_IDLE,
    JP_NAVIGATION_STANDING_UP, /**< until the robot balances */
    JP_NAVIGATION_SENDING,     /**< until the map is there */
    JP_NAVIGATION_ASKING,      /**< until goal or round is taken */
    JP_NAVIGATION_DRIVING,
    JP_NAVIGATION_DONE,
    JP_NAVIGATION_FAILED
};

/** Why a task has failed. */
enum jp_navigation_failure {
    JP_NAVIGATION_NO_FAILURE,
    JP_NAVIGATION_SILENCE,  /**< for 1 s the ECU has told nothing of itself, or of a navigator */
    JP_NAVIGATION_STAND_UP, /**< the robot does not balance within 10 s */
    JP_NAVIGATION_FALLEN,
    JP_NAVIGATION_FAULT,
    JP_NAVIGATION_MAP,  /**< the map is refused: map.reason */
    JP_NAVIGATION_LOST, /**< the map did not arrive in 120 s */
    JP_NAVIGATION_GOAL, /**< the goal is refused: navigator.answer */
    JP_NAVIGATION_NO_START,
    JP_NAVIGATION_RESTART,     /**< the ECU has no map any more, or another goal */
    JP_NAVIGATION_UNREACHABLE, /**< proved: no way leads there */
    JP_NAVIGATION_GAVE_UP,     /**< navigator.reason */
    JP_NAVIGATION_STOPPED,     /**< somebody told it to stand, or it heard no commands */
    JP_NAVIGATION_CAME_HOME, /**< what was left would not have brought it home from there, or the goal cannot be had */
    JP_NAVIGATION_NO_WAY_HOME, /**< it did not leave, or could not come home */
    JP_NAVIGATION_ROUND,       /**< the round is refused: round.reason, field and stop */
    JP_NAVIGATION_ROUND_ENDED, /**< it has given the round up: round.reason */
    JP_NAVIGATION_FAILURES
};

struct jp_map_stream {
    const uint8_t *bytes; /**< jp_map_encode() */
    uint16_t length;
    uint8_t id; /**< 1…15 */
};

/** Changes on their way. */
struct jp_change_queue {
    struct jp_cell_changes items[JP_CHANGES_WAITING];
    uint8_t head;         /* the oldest that is not acknowledged */
    uint8_t count;        /* that wait */
    uint8_t sent;         /* of those */
    uint8_t acknowledged; /* counter */
    uint8_t counter;      /* of the last that was sent */
    uint32_t quiet_ms;    /* since one was acknowledged, or sent again */
};

/** The members without a comment are private. */
struct jp_navigation_operator {
    enum jp_navigation_phase phase;     /**< of the task */
    enum jp_navigation_failure failure; /**< of a phase JP_NAVIGATION_FAILED */
    struct jp_can_ecu_status_t ecu;     /**< last heard, as the next six */
    struct jp_can_map_status_t map;
    struct jp_can_navigation_status_t navigator;
    struct jp_can_home_status_t home;
    struct jp_can_home_battery_t battery;
    struct jp_can_round_status_t round;
    struct jp_can_round_battery_t round_battery;

    struct jp_map_stream stream;
    uint32_t crc;
    struct jp_map_goal goal; /* or the round of its id */
    bool is_round;
    struct jp_round_bytes round_bytes;
    struct jp_round_sender sender;
    struct jp_change_queue changes;
    struct jp_operator_ear ecu_ear;
    struct jp_operator_ear map_ear;
    bool ticked; /* last_tick_ms holds */
    uint32_t last_tick_ms;
    uint32_t in_phase_ms;
    bool commanding; /* OperatorCommand is sent */
    uint32_t since_command_ms;
    uint32_t since_data_ms;
    uint32_t since_request_ms; /* offer or goal */
    uint32_t next_frame;       /* of the map */
    uint32_t frames_before;    /* that the status before had told */
    bool begun;                /* the navigator has been under way to the goal */
    uint16_t offers;
    uint8_t command_counter;
    uint8_t offer_counter;
    uint8_t data_counter;
    uint8_t goal_counter;
};

/** Sends the map if the robot has another one, and drives to the goal, whose id and map are chosen here. What `stream`
 *  shows must stay. JP_ERR_ARGUMENT: a null pointer, or an id or length out of range. */
enum jp_status jp_navigation_operator_go(struct jp_navigation_operator *self, const struct jp_map_stream *stream,
                                         const struct jp_map_goal *goal);

/** The same with a round, whose id is chosen here; it is driven until it ends or is stopped. What `stream` and `round`
 *  show must stay. JP_ERR_ARGUMENT: also stops out of range. */
enum jp_status jp_navigation_operator_patrol(struct jp_navigation_operator *self, const struct jp_map_stream *stream,
                                             const struct jp_round_bytes *round);

/** A sensor sees on a cell what the map does not show. JP_ERR_BUSY: too many wait; tell it later. */
enum jp_status jp_navigation_operator_see(struct jp_navigation_operator *self, uint16_t x, uint16_t y,
                                          enum jp_cell cell);

/** Forgets the task: the robot brakes to a balanced stand. Stays silent if nothing was asked yet. */
void jp_navigation_operator_stop(struct jp_navigation_operator *self);

/** Takes a frame; those of others are ignored. */
void jp_navigation_operator_accept(struct jp_navigation_operator *self, const struct jp_can_frame *frame);

/** Sends what is due at this time, which wraps, in ms; at least every 2 ms while it sends a map. */
void jp_navigation_operator_tick(struct jp_navigation_operator *self, uint32_t time_ms, const struct jp_can_port *port);

/** For people: why it failed and what to do. Never null. */
const char *jp_navigation_failure_text(enum jp_navigation_failure failure);

#ifdef __cplusplus
}
#endif

#endif
