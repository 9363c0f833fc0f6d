/**
 * The wheels of a robot with four steered wheels, and its supply, at the far end of a CAN bus: WheelTarget,
 * WheelFeedback and SupplySensors, which stand for struct jp_four_wheel_actuation and struct jp_four_wheel_sensors.
 *
 * Values beyond a signal's range saturate. What is lost the robot rides out by itself (four_wheel_robot.h). Constant
 * time; for the receive interrupt and the control tick, which do not interrupt each other.
 */
#ifndef JOULEPATH_HAL_CAN_WHEEL_LINK_H
#define JOULEPATH_HAL_CAN_WHEEL_LINK_H

#include <joulepath/e2e.h>
#include <joulepath/four_wheel_robot.h>

#include "hal/can/can.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Frames of a sample, in the order in which they are sent: those of the wheels, and SupplySensors. */
#define JP_WHEEL_SAMPLE_FRAMES ((unsigned)JP_WHEELS + 1U)

/** Frames of one Counter. Private. */
struct jp_wheel_group {
    struct jp_e2e_receiver receivers[JP_WHEELS + 1];
    uint8_t counter;
    uint8_t parts; /* bit for each that came */
};

/** Targets as they arrive at the drives; zero-initialised at the start. */
struct jp_wheel_targets {
    struct jp_wheel_group group;
    struct jp_four_wheel_actuation parts;
    uint8_t enabled; /* bit for each wheel */
};

/** Samples as they arrive at the controller; zero-initialised at the start. */
struct jp_wheel_link {
    struct jp_wheel_group group;
    struct jp_four_wheel_sensors parts;
    struct jp_four_wheel_sensors sample; /**< the last whole one */
    bool is_fresh;                       /**< it was not read yet */
    bool has_started;                    /**< there was one */
    uint16_t lost;                       /**< ticks without a sample since the first one, saturating */
};

/** WheelTarget of each wheel. *counter is that of the last. */
void jp_wheel_targets_pack(struct jp_can_frame frames[JP_WHEELS], uint8_t *counter,
                           const struct jp_four_wheel_actuation *actuation);

/** Takes a WheelTarget of the right length. *is_whole: those of all wheels have come; only then *actuation is written.
 */
enum jp_e2e_result jp_wheel_targets_accept(struct jp_wheel_targets *targets, const struct jp_can_frame *frame,
                                           struct jp_four_wheel_actuation *actuation, bool *is_whole);

/** A sample. *counter is that of the last. */
void jp_wheel_sample_pack(struct jp_can_frame frames[JP_WHEEL_SAMPLE_FRAMES], uint8_t *counter,
                          const struct jp_four_wheel_sensors *sensors);

/** Takes a WheelFeedback or SupplySensors of the right length. */
enum jp_e2e_result jp_wheel_link_accept(struct jp_wheel_link *link, const struct jp_can_frame *frame);

/** The sample of this tick. JP_ERR_HARDWARE: none has come since the last call. */
enum jp_status jp_wheel_link_read(struct jp_wheel_link *link, struct jp_four_wheel_sensors *sensors);

#ifdef __cplusplus
}
#endif

#endif
