/**
 * The controller of a robot whose operator is on CAN, and its sensors and bridges on CAN too or the board's own: the
 * application of the firmware.
 *
 *   jp_ecu_accept()  each frame that arrives: from the receive interrupt, at the priority of the tick
 *   jp_ecu_tick()    at the control rate: sample in, MotorCommand out, telemetry that is due
 *   jp_ecu_work()    from the background loop: commands, routes, maps, planning
 *
 * Up to JP_SAMPLE_HOLD_TICKS without samples or without the bus are ridden out. A reset is too: what the record in
 * retained memory holds is taken up at the first sample, and the robot brakes to a balanced stand.
 */
#ifndef JOULEPATH_HAL_APP_ECU_H
#define JOULEPATH_HAL_APP_ECU_H

#include "hal/app/ecu_state.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What a robot learns with, and from where it goes on. */
struct jp_ecu_learning {
    const struct jp_learning *learning;
    bool of_battery;                      /**< model and learning are of jp_meter.battery */
    enum jp_stored stored;                /**< what jp_parameters_start() found */
    const struct jp_learned_state *state; /**< taken with JP_STORED_TAKEN, else it may be null */
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
 * *field names the first field of learning out of range; JP_ERR_ARGUMENT: a pointer is null that may not be.
 * Then it does not learn.
 */
enum jp_status jp_ecu_learn(struct jp_ecu *ecu, const struct jp_ecu_learning *learning, const char **field);

/** The ECU also drives to goals on a map: the navigator was prepared with &ecu->pilot. Right after jp_ecu_learn(), or
 *  jp_ecu_init() if it does not learn; it must stay. */
void jp_ecu_navigate(struct jp_ecu *ecu, struct jp_navigation *navigation);

/** What was learned, to be stored; NULL: it does not learn. For the background. */
const struct jp_learned_state *jp_ecu_learned_state(const struct jp_ecu *ecu);

/** The energy model as its telemetry tells it: the built-in one or, once it learns, the learned one of the last route.
 * From any context. */
static inline const struct jp_energy_model *jp_ecu_model(const struct jp_ecu *ecu)
{
    return __atomic_load_n(&ecu->internal.model, __ATOMIC_ACQUIRE);
}

/** Ticks without a sample since the first one, saturating; from any context. */
static inline uint16_t jp_ecu_lost_samples(const struct jp_ecu *ecu)
{
    return ecu->internal.samples.lost;
}

/** Takes one frame. Returns true when a sample is complete, so that the tick may begin. Constant time. */
bool jp_ecu_accept(struct jp_ecu *ecu, const struct jp_can_frame *frame);

/** One control tick. Constant time; at most 1 + JP_TELEMETRY_FRAMES_MAX frames are sent. For the control ISR. */
void jp_ecu_tick(struct jp_ecu *ecu);

/** One slice of background work. At most JP_ECU_QUEUE frames, and one jp_pilot_work() or jp_navigation_work(). Not for
 *  ISRs. */
void jp_ecu_work(struct jp_ecu *ecu);

#ifdef __cplusplus
}
#endif

#endif
