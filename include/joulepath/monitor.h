/**
 * Plausibility of the sensors and the limit of tilt.
 *
 * While a reading is out of range, or jumps farther than physics allows, the last good frame is used; after
 * `confirm_ticks` it is a fault. But an impact, as of a wheel on an edge or of one that lands, is felt by the whole
 * IMU: when the specific force changes by more than 1 g in a tick or leaves its range, jumps of the rates and forces
 * out of range are believed from the next tick on, until there was no impact for `residual_ticks`, and two fewer of
 * them. An IMU that goes on like that is a fault then. An IMU is frozen when one of its channels repeats the same bits
 * for `freeze_ticks`. A frame that is held because none was measured tells nothing of the sensors: it makes none
 * frozen, and no implausible one plausible. An encoder that stops, slips or runs away is a fault when the residual of
 * the motor current, i − (u − kb ω)/Rm, exceeds its limit for `residual_ticks`.
 */
#ifndef JOULEPATH_MONITOR_H
#define JOULEPATH_MONITOR_H

#include <stdbool.h>

#include <joulepath/sensors.h>
#include <joulepath/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Bits of a fault word. */
enum jp_fault {
    JP_FAULT_IMU_RANGE = 1 << 0,
    JP_FAULT_IMU_JUMP = 1 << 1,
    JP_FAULT_IMU_FROZEN = 1 << 2,
    JP_FAULT_ENCODER_JUMP = 1 << 3,
    JP_FAULT_ENCODER_LEFT = 1 << 4,  /**< the left encoder contradicts the left current */
    JP_FAULT_ENCODER_RIGHT = 1 << 5, /**< the right encoder contradicts the right current */
    JP_FAULT_CURRENT_RANGE = 1 << 6,
    JP_FAULT_BUS_VOLTAGE = 1 << 7,
    JP_FAULT_HARDWARE = 1 << 8,       /**< the HAL reported an error */
    JP_FAULT_OVERSPEED = 1 << 9,      /**< the wheels run away, as when the gyro is wrong */
    JP_FAULT_STALLED_LEFT = 1 << 10,  /**< the left motor takes its greatest current and does not turn */
    JP_FAULT_STALLED_RIGHT = 1 << 11, /**< the same of the right one */
    JP_FAULT_WHEEL_IN_AIR = 1 << 12,  /**< a side turns without carrying anything while the other one does */
    JP_FAULT_WHEELS_SPIN = 1 << 13,   /**< the wheels turn the robot, and the gyro says otherwise */
    JP_FAULT_SLOPE = 1 << 14          /**< the ground is steeper than the robot may drive */
};

/** Pitch rate, yaw rate, acceleration along x and z. */
#define JP_IMU_CHANNELS 4

struct jp_monitor_config {
    jp_q24 tilt_limit;               /**< |ψ| beyond it is a fall, turn; 0.01…0.25 */
    jp_turns_per_s gyro_limit;       /**< |rate| beyond it is out of range, turn/s; above 0 */
    jp_turns_per_s gyro_jump;        /**< change a tick beyond it is implausible, turn/s; above 0 */
    jp_q24 accel_limit;              /**< |specific force| beyond it is out of range, g; above 1 */
    uint32_t encoder_jump;           /**< counts a tick beyond it are implausible; above 0 */
    jp_q16 current_limit;            /**< |i| beyond it is out of range, A; above 0, times Rm at most 32 767 V */
    jp_q16 voltage_min;              /**< bus voltage, V; above 0 */
    jp_q16 voltage_max;              /**< V; above voltage_min, at most 1 000 */
    jp_q16 motor_resistance;         /**< Rm, Ω; at least 0.01 */
    jp_q16 back_emf;                 /**< kb at the wheel, V per turn/s; above 0, below 256 */
    jp_q16 half_track;               /**< W/(2R), turns of a wheel for one of the body; above 0, at most 64 */
    jp_turns_per_s wheel_rate_limit; /**< |mean wheel rate| beyond it is a runaway, turn/s; above 0 */
    jp_q16 current_residual;         /**< |i − (u − kb ω)/Rm| beyond it contradicts, A; above 0 */
    uint16_t confirm_ticks;          /**< readings until range, jump and runaway become faults; at least 1 */
    uint16_t freeze_ticks; /**< equal readings of an IMU channel until frozen; 0 is off (a simulated ideal IMU) */
    /** Contradicting ticks until an encoder fault; ticks without an impact until impacts are over; and two more than
     * the implausible readings of the IMU that impacts explain; at least 1. */
    uint16_t residual_ticks;
};

struct jp_monitor {
    struct jp_sensors good; /**< last plausible frame, the one to use, once started */
    uint16_t suspected;     /**< enum jp_fault bits of the last frame, confirmed or not; not frozen */
    uint16_t implausible_ticks;
    uint16_t explained_ticks; /**< implausible readings of the IMU that impacts have explained, while `shaken` */
    uint16_t calm_ticks;      /**< without an impact */
    uint16_t frozen_ticks[JP_IMU_CHANNELS];
    uint16_t residual_ticks[2];
    uint16_t overspeed_ticks;
    bool shaken; /**< by impacts */
    bool started;
    uint32_t dropped_frames; /**< since the start, wrapping: implausible or not read, the last good one served */
    jp_q16 residual_limit;   /**< V, from the configuration */
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. Not
 *  for ISRs. */
enum jp_status jp_monitor_check(const struct jp_monitor_config *config, const char **field);

/** Starts with no good frame and no fault. The configuration must have passed its check. */
void jp_monitor_start(struct jp_monitor *monitor, const struct jp_monitor_config *config);

/** Checks one frame and takes it as the `good` one unless it is implausible or `read` is a failure. JP_HELD: nothing
 * was measured, and the frame goes on from the good one. Returns the confirmed faults, 0 for none. Constant time; for
 * the control ISR. */
uint16_t jp_monitor_sensors(struct jp_monitor *monitor, const struct jp_monitor_config *config, enum jp_status read,
                            const struct jp_sensors *sensors);

/** Compares the currents of the good frame with the voltages that drove them and the rates that the encoders show: mean
 *  of the wheels relative to the body, and yaw; turn/s. Returns the confirmed encoder and overspeed faults, 0 for none.
 *  Constant time; for the control ISR. */
uint16_t jp_monitor_motors(struct jp_monitor *monitor, const struct jp_monitor_config *config,
                           const struct jp_voltages *voltages, jp_q24 wheel_rate, jp_q24 yaw_rate);

#ifdef __cplusplus
}
#endif

#endif
