/**
 * The controller of a robot whose operator is on CAN, and its sensors and bridges on CAN too or the board's own: the
 * application of the firmware.
 *
 *   jp_ecu_accept()  each frame that arrives: from the receive interrupt, at the priority of the tick
 *   jp_ecu_tick()    at the control rate: sample in, MotorCommand out, telemetry that is due
 *   jp_ecu_work()    from the background loop: commands, routes, maps, planning
 *
 * Up to JP_SAMPLE_HOLD_MS without samples or without the bus are ridden out. A reset is too: what the record in
 * retained memory holds is taken up at the first sample, and the robot brakes to a stand.
 */
#ifndef JOULEPATH_HAL_APP_ECU_H
#define JOULEPATH_HAL_APP_ECU_H

#include "hal/app/ecu_state.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Prepares the application of a robot that was just prepared: ecu_balancer.h. What the pointers show must stay, but for
 * *robot and *port; retained is memory that start-up does not clear, NULL if there is none. JP_ERR_ARGUMENT: a pointer
 * is null. Not for ISRs.
 */
enum jp_status jp_ecu_init(struct jp_ecu *ecu, const struct jp_ecu_robot *robot, const struct jp_can_port *port,
                           struct jp_retained *retained);

/** Sensors and bridges are the board's own, not on the bus. Right after jp_ecu_init(); what board->context shows must
 *  stay. */
void jp_ecu_use_board(struct jp_ecu *ecu, const struct jp_hal *board);

/** The report is sent again and again. Right after jp_ecu_init(); it must stay. */
void jp_ecu_report_reset(struct jp_ecu *ecu, const struct jp_reset_report *report);

/** The ECU also drives to goals on a map: the navigator was prepared for its robot. Right after jp_ecu_init(); it must
 *  stay. */
void jp_ecu_navigate(struct jp_ecu *ecu, struct jp_navigation *navigation);

/** The ECU follows what its cells have left: the battery was prepared. Right after jp_ecu_init(); it must stay. */
void jp_ecu_use_battery(struct jp_ecu *ecu, struct jp_ecu_battery *battery);

/** What was learned, to be stored; NULL: it does not learn. For the background. */
const struct jp_learned_state *jp_ecu_learned_state(const struct jp_ecu *ecu);

/** Of a robot that learns, as LearnerStatus tells it. For the background. */
void jp_ecu_read_lessons(const struct jp_ecu *ecu, struct jp_ecu_lessons *lessons);

/** What the robot does; from any context. */
enum jp_ecu_state jp_ecu_state_now(const struct jp_ecu *ecu);

/** The motors run. From any context. */
bool jp_ecu_runs(const struct jp_ecu *ecu);

/** Ticks a second. */
static inline uint32_t jp_ecu_tick_rate(const struct jp_ecu *ecu)
{
    return ecu->internal.robot.tick_rate;
}

/** Right after jp_ecu_init(): the counts from which the encoders go on; 0 where nothing is known of them. */
static inline uint32_t jp_ecu_first_count_left(const struct jp_ecu *ecu)
{
    return ecu->internal.samples.left.base;
}

static inline uint32_t jp_ecu_first_count_right(const struct jp_ecu *ecu)
{
    return ecu->internal.samples.right.base;
}

/** Takes one frame. Returns true when a sample is complete, so that the tick may begin. Constant time. */
bool jp_ecu_accept(struct jp_ecu *ecu, const struct jp_can_frame *frame);

/** One control tick. Constant time; at most those of one command, and JP_TELEMETRY_FRAMES_MAX, are sent. For the
 * control ISR. */
void jp_ecu_tick(struct jp_ecu *ecu);

/** One slice of background work. At most JP_ECU_QUEUE frames, and one slice of the pilot's or of jp_navigation_work().
 *  Not for ISRs. */
void jp_ecu_work(struct jp_ecu *ecu);

#ifdef __cplusplus
}
#endif

#endif
