/** What the application of a controller holds: ecu.h works on it, telemetry.h tells of it. */
#ifndef JOULEPATH_HAL_APP_ECU_STATE_H
#define JOULEPATH_HAL_APP_ECU_STATE_H

#include <joulepath/pilot.h>

#include "hal/app/navigation.h"
#include "hal/app/retained.h"
#include "hal/can/operator_link.h"
#include "hal/can/route_link.h"
#include "hal/can/sample_link.h"
#include "hal/hal.h"
#include "hal/storage/parameters.h"
#include "hal/storage/post_mortem.h"

/** Frames of the operator that wait for jp_ecu_work(). */
#define JP_ECU_QUEUE 64U

/** Counts since the start, saturating. The tick and the background have one each. */
struct jp_ecu_counts {
    uint8_t crc_errors;
    uint8_t sequence_errors;
    uint8_t malformed;
    uint8_t rejected;
};

/** Why the motors stay off although Stand was commanded: values of StandRefusal in joulepath.dbc. */
enum jp_refusal {
    JP_REFUSAL_NONE,
    JP_REFUSAL_NOT_UPRIGHT, /**< leans beyond the tilt limit, or no plausible sample came yet */
    JP_REFUSAL_FALLEN,      /**< Off first */
    JP_REFUSAL_FAULT,       /**< Off first */
    JP_REFUSAL_CONFLICT     /**< another controller is on the bus */
};

/** The leg that the pilot tells of, for the tick to be sent: no other one is planned before that. */
struct jp_ecu_plan {
    uint8_t frames_left; /**< to be sent; the background writes and plans while it is 0 */
    uint8_t segment;     /**< its number */
};

/** What was learned, which the background hands to the tick to be sent. */
struct jp_ecu_learned {
    uint8_t frames_left; /**< as in struct jp_ecu_plan */
    jp_q16 friction;
    jp_q16 friction_deviation;
    jp_q16 payload;
    jp_q16 payload_deviation;
    uint32_t version;
    uint32_t changes;
    uint32_t outliers;
    uint32_t left_out;
    enum jp_cause cause;
    enum jp_evidence evidence;
};

/** Private. */
struct jp_ecu_internal {
    struct jp_hal hal;
    enum jp_status written;
    struct jp_can_port port;
    struct jp_retained *retained;
    const struct jp_reset_report *reset_report; /**< NULL: not known */

    /* Of the tick. */
    struct jp_sample_link samples;
    uint8_t motor_counter;
    uint16_t unsent; /**< ticks in a row whose MotorCommand the bus did not take */
    bool was_bus_off;
    uint16_t conflict_ticks; /**< for which another controller still counts as present */
    bool has_board;          /**< sensors and bridges are the board's own */
    bool owns_bridges;       /**< has switched them on since the start */
    uint16_t segments_reported;
    uint8_t parameter;      /**< of the energy model, sent next */
    uint8_t schedule_ms;    /**< millisecond of the telemetry's schedule that comes next */
    uint32_t schedule_wait; /**< until then, 1/1000 tick */

    /* Of the background. */
    struct jp_operator_link operator_link;
    struct jp_route_link routes;
    struct jp_navigation *navigation;    /**< NULL: it has none */
    uint8_t refusal;                     /**< enum jp_refusal of the last Stand of a robot whose motors are off */
    bool told_to_stand;                  /**< the last valid OperatorCommand since the last work is a Stand */
    bool has_route;                      /**< the pilot has the route, or has ended it unnoticed */
    uint32_t worked_tick;                /**< up to which time has passed for it */
    const struct jp_energy_model *model; /**< that the telemetry tells */
    struct jp_energy_model models[2];    /**< one of them, as learned when the last route began */
    uint32_t segments_told;              /**< in the last report of what was learned */
    uint32_t told_tick;                  /**< of that report */

    /* From the tick to the background and back. */
    struct jp_can_frame queue[JP_ECU_QUEUE];
    uint8_t queue_head; /**< written by jp_ecu_accept() */
    uint8_t queue_tail; /**< written by jp_ecu_work() */
    struct jp_ecu_plan plan;
    struct jp_ecu_learned learned;
};

/** The members but `internal` may be read: those of the tick a word at a time from any context, those of the background
 *  from its context. */
struct jp_ecu {
    struct jp_robot robot; /**< that it controls */
    uint32_t resets;       /**< in motion, that were ridden out */

    /* Of the tick. */
    uint32_t tick; /**< since the start, wrapping */
    struct jp_ecu_counts sample_counts;
    uint8_t bus_offs;        /**< saturating, as all counts */
    uint8_t conflicts;       /**< frames of another controller */
    uint16_t unknown_frames; /**< of no message of joulepath.dbc */
    uint16_t send_errors;    /**< frames that the bus did not take */

    /* Of the background. */
    uint8_t operator_timeouts;
    bool learns;
    struct jp_ecu_counts operator_counts;
    enum jp_stored stored; /**< what of the stored state is in use, or why not */
    struct jp_pilot pilot;

    struct jp_ecu_internal internal;
};

#endif
