/** What the application of a controller holds: ecu.h works on it, telemetry.h tells of it. */
#ifndef JOULEPATH_HAL_APP_ECU_STATE_H
#define JOULEPATH_HAL_APP_ECU_STATE_H

#include "hal/app/ecu_battery.h"
#include "hal/app/ecu_robot.h"
#include "hal/app/navigation.h"
#include "hal/can/operator_link.h"
#include "hal/can/route_link.h"
#include "hal/can/sample_link.h"
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

/** Frames that the background writes while there are none left, and the tick sends, the last one first. */
#define JP_ECU_REPORT_FRAMES 3U

struct jp_ecu_report {
    struct jp_can_frame frames[JP_ECU_REPORT_FRAMES];
    uint8_t left;
};

/** Private. */
struct jp_ecu_internal {
    struct jp_ecu_robot robot; /**< that it controls */
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
    bool owns_bridges;       /**< has run its robot since the start */
    uint8_t parameter;       /**< of the energy model, sent next */
    uint8_t schedule_ms;     /**< millisecond of the telemetry's schedule that comes next */
    uint32_t schedule_wait;  /**< until then, 1/1000 tick */

    /* Of the background. */
    struct jp_operator_link operator_link;
    struct jp_route_link routes;
    struct jp_navigation *navigation; /**< NULL: it has none */
    struct jp_ecu_battery *battery;   /**< NULL: it knows nothing of it */
    uint8_t refusal;                  /**< enum jp_refusal of the last Stand of a robot whose motors are off */
    bool lacks_samples;               /**< shall stand, and has waited for the first one long enough */
    bool told_to_stand;               /**< the last valid OperatorCommand since the last work is a Stand */
    bool has_route;                   /**< the robot has the route, or has ended it unnoticed */
    uint32_t worked_tick;             /**< up to which time has passed for it */
    uint32_t segments_told;           /**< in the last report of what was learned */
    uint32_t told_tick;               /**< of that report */

    /* From the tick to the background and back. */
    struct jp_can_frame queue[JP_ECU_QUEUE];
    uint8_t queue_head;        /**< written by jp_ecu_accept() */
    uint8_t queue_tail;        /**< written by jp_ecu_work() */
    struct jp_ecu_report plan; /**< of a segment; no other one is planned before it was sent */
    struct jp_ecu_report learned;
};

/** The members but `internal` may be read: those of the tick a word at a time from any context, those of the background
 *  from its context. */
struct jp_ecu {
    uint32_t resets; /**< in motion, that were ridden out */

    /* Of the tick. */
    uint32_t tick; /**< since the start, wrapping */
    struct jp_ecu_counts sample_counts;
    uint8_t bus_offs;        /**< saturating, as all counts */
    uint8_t conflicts;       /**< frames of another controller */
    uint16_t unknown_frames; /**< of no message of joulepath.dbc */
    uint16_t send_errors;    /**< frames that the bus did not take */

    /* Of the background. */
    uint8_t operator_timeouts;
    struct jp_ecu_counts operator_counts;

    struct jp_ecu_internal internal;
};

/** Ticks without a sample since the first one, saturating; from any context. */
static inline uint16_t jp_ecu_lost_samples(const struct jp_ecu *ecu)
{
    const struct jp_ecu_robot *robot = &ecu->internal.robot;

    return robot->kind->lost_samples != NULL ? robot->kind->lost_samples(robot->self) : ecu->internal.samples.lost;
}

#endif
