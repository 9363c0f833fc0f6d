/**
 * The controller of a robot whose operator is on CAN, and its sensors and bridges on CAN too or the board's own: the
 * application of the firmware.
 *
 *   jp_ecu_accept()  each frame that arrives: from the receive interrupt, at the priority of the tick
 *   jp_ecu_tick()    at the control rate: sample in, MotorCommand out, telemetry that is due
 *   jp_ecu_work()    from the background loop: commands, routes, planning
 *
 * Up to JP_SAMPLE_HOLD_TICKS without samples or without the bus are ridden out. A reset is too: what the record in
 * retained memory holds is taken up at the first sample, and the robot brakes to a balanced stand.
 */
#ifndef JOULEPATH_HAL_CAN_ECU_H
#define JOULEPATH_HAL_CAN_ECU_H

#include <joulepath/drive_watch.h>

#include "../hal.h"
#include "../parameters.h"
#include "../post_mortem.h"
#include "operator_link.h"
#include "retained.h"
#include "route_link.h"
#include "sample_link.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Frames of the operator that wait for jp_ecu_work(). */
#define JP_ECU_QUEUE 64U

/** Counts since the start, saturating. The tick and the background have one each. */
struct jp_ecu_counts {
    uint8_t crc_errors;
    uint8_t sequence_errors;
    uint8_t malformed;
    uint8_t rejected;
};

/** A planned segment that the background hands to the tick to be sent. */
struct jp_ecu_plan {
    uint8_t frames_left; /**< to be sent; the background writes the rest while it is 0 */
    uint8_t segment;
    struct jp_segment planned;
};

/** What a robot learns with, and from where it goes on. */
struct jp_ecu_learning {
    const struct jp_horizon *horizon; /**< NULL: only segments of T >= Ts are learned from */
    const struct jp_learning *learning;
    bool of_battery;                      /**< model, horizon and learning are of jp_meter.battery */
    enum jp_stored stored;                /**< what jp_parameters_start() found */
    const struct jp_learned_state *state; /**< taken with JP_STORED_TAKEN */
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

struct jp_ecu {
    struct jp_robot robot;
    struct jp_hal hal;
    enum jp_status written;
    struct jp_can_port port;
    struct jp_retained *retained;
    const struct jp_reset_report *reset_report; /**< NULL: not known */
    uint32_t resets;
    bool has_board; /**< sensors and bridges are the board's own */

    /* Of the tick. */
    struct jp_sample_link samples;
    struct jp_ecu_counts sample_counts;
    uint8_t bus_offs;
    uint8_t conflicts;
    uint16_t unknown_frames;
    uint16_t send_errors;
    uint8_t motor_counter;
    uint16_t unsent; /**< ticks in a row whose MotorCommand the bus did not take */
    bool was_bus_off;
    uint16_t conflict_ticks; /**< for which another controller still counts as present */
    bool owns_bridges;       /**< has switched them on since the start */
    uint32_t tick;           /**< since the start, wrapping */
    uint16_t segments_reported;
    uint8_t parameter;      /**< of the energy model, sent next */
    uint8_t schedule_ms;    /**< millisecond of the telemetry's schedule that comes next */
    uint32_t schedule_wait; /**< until then, 1/1000 tick */

    /* Of the background. */
    struct jp_operator_link operator_link;
    struct jp_route_link routes;
    struct jp_ecu_counts operator_counts;
    uint8_t operator_timeouts;
    uint32_t worked_tick; /**< up to which time has passed for it */
    bool commanded;       /**< a valid OperatorCommand came since the last work */
    bool drove;           /**< the robot has begun to drive the route */
    bool learns;
    enum jp_stored stored; /**< what of the stored state is in use, or why not */
    struct jp_learner learner;
    struct jp_drive_watch watch;
    struct jp_energy_model model; /**< as learned when the last route began; the robot plans with it */
    uint32_t segments_told;       /**< in the last report of what was learned */
    uint32_t told_tick;           /**< of that report */

    /* From the tick to the background and back. */
    struct jp_can_frame queue[JP_ECU_QUEUE];
    uint8_t queue_head; /**< written by jp_ecu_accept() */
    uint8_t queue_tail; /**< written by jp_ecu_work() */
    struct jp_ecu_plan plan;
    struct jp_ecu_learned learned;
};

/**
 * Prepares the application. What the pointers show must stay; retained is memory that start-up does not clear, NULL if
 * there is none. JP_ERR_ARGUMENT, JP_ERR_CONFIG: as jp_robot_init(). Not for ISRs.
 */
enum jp_status jp_ecu_init(struct jp_ecu *ecu, const struct jp_robot_config *config,
                           const struct jp_energy_model *model, const struct jp_can_port *port,
                           struct jp_retained *retained, const char **field);

/** Sensors and bridges are the board's own, not on the bus. Right after jp_ecu_init(); what board->context shows must
 *  stay. */
void jp_ecu_use_board(struct jp_ecu *ecu, const struct jp_hal *board);

/** The report is sent again and again. Right after jp_ecu_init(); it must stay. */
void jp_ecu_report_reset(struct jp_ecu *ecu, const struct jp_reset_report *report);

/**
 * The ECU learns the energy model from what it drives, and plans each route with what it knows when the route begins.
 * Right after jp_ecu_init(); what the pointers show must stay, but for the state, which is copied. JP_ERR_CONFIG:
 * *field names the first field of horizon or learning out of range; JP_ERR_ARGUMENT: learning is null. Then it does not
 * learn.
 */
enum jp_status jp_ecu_learn(struct jp_ecu *ecu, const struct jp_ecu_learning *learning, const char **field);

/** What was learned, to be stored; NULL: it does not learn. For the background. */
const struct jp_learned_state *jp_ecu_learned_state(const struct jp_ecu *ecu);

/** Takes one frame. Returns true when a sample is complete, so that the tick may begin. Constant time. */
bool jp_ecu_accept(struct jp_ecu *ecu, const struct jp_can_frame *frame);

/** One control tick. Constant time; at most 1 + JP_TELEMETRY_FRAMES_MAX frames are sent. For the control ISR. */
void jp_ecu_tick(struct jp_ecu *ecu);

/** One slice of background work. At most JP_ECU_QUEUE frames, one jp_drive_watch_update() and one jp_robot_work(). Not
 *  for ISRs. */
void jp_ecu_work(struct jp_ecu *ecu);

#ifdef __cplusplus
}
#endif

#endif
