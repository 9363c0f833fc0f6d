/**
 * Motion of the robot from encoders and IMU.
 *
 * The encoders sit on the body, so the wheels' angle in the world is encoder + pitch (θ = θ_enc + ψ). Wheel and yaw
 * angle are wrapping phases; their rates come from tracking loops over the counts. Pitch is the integrated gyro, drawn
 * slowly to the accelerometer's vertical (complementary filter), which also estimates the gyro's bias.
 */
#ifndef JOULEPATH_ESTIMATOR_H
#define JOULEPATH_ESTIMATOR_H

#include <joulepath/sensors.h>
#include <joulepath/status.h>

#ifdef __cplusplus
extern "C" {
#endif

struct jp_estimator_config {
    uint32_t tick_rate;        /**< calls a second; 100…10 000 */
    jp_phase wheel_per_count;  /**< mean wheel angle for one count of (left + right): half a count; 2⁻⁵⁶ turn */
    jp_phase yaw_per_count;    /**< body yaw for one count of (right − left); 2⁻⁵⁶ turn */
    jp_q16 tracking_gain;      /**< share of the angle error taken a tick; above 0, at most 1 */
    jp_q16 tracking_rate_gain; /**< rate taken from the angle error, 1/s; above 0, at most tick_rate. 1 and tick_rate
                                    make the plain difference of successive counts */
    jp_q31 tilt_gain;          /**< share of the accelerometer's tilt error taken a tick; 0 trusts the gyro alone */
    jp_q31 bias_gain;          /**< share of the tilt error taken as gyro bias (turn/s from turn) a tick; 0 is off */
};

/** Measured motion. Angles in turns, rates in turns a second. */
struct jp_motion_state {
    jp_phase wheel;    /**< θ, mean wheel angle in the world */
    jp_phase yaw;      /**< φ, left turn positive */
    jp_q24 pitch;      /**< ψ, forward positive; ±½ turn */
    jp_q24 wheel_rate; /**< θ̇ */
    jp_q24 yaw_rate;   /**< φ̇ */
    jp_q24 pitch_rate; /**< ψ̇ */
};

struct jp_tracking_loop {
    jp_phase angle;
    jp_q24 rate;
};

struct jp_estimator {
    uint32_t encoder_left;
    uint32_t encoder_right;
    jp_phase wheel_encoder; /**< measured θ − ψ */
    jp_phase yaw_encoder;   /**< measured φ */
    struct jp_tracking_loop wheel;
    struct jp_tracking_loop yaw;
    jp_phase pitch;         /**< ψ */
    int64_t gyro_bias;      /**< 2⁻⁵⁶ turn/s */
    int32_t phase_per_rate; /**< angle of one tick at a rate of 2⁻²⁴ turn/s: jp_phase_per_rate() */
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. Not
 *  for ISRs. */
enum jp_status jp_estimator_check(const struct jp_estimator_config *config, const char **field);

/** Starts at wheel angle and yaw 0 with the pitch that the accelerometer shows; the robot must be at rest. Cannot fail.
 *  One atan2; for the control ISR. */
void jp_estimator_start(struct jp_estimator *estimator, const struct jp_estimator_config *config,
                        const struct jp_sensors *sensors);

/** Continues in motion after a gap in which the robot rolled on: `estimator` is that of before the gap. Distance and
 *  heading are right however long the gap was; pitch and all rates are those of before, so it must be short. Cannot
 * fail. Constant time; for the control ISR. */
void jp_estimator_resume(struct jp_estimator *estimator, const struct jp_estimator_config *config,
                         const struct jp_sensors *sensors, struct jp_motion_state *state);

/** One tick. Cannot fail; constant time; for the control ISR. */
void jp_estimator_update(struct jp_estimator *estimator, const struct jp_estimator_config *config,
                         const struct jp_sensors *sensors, struct jp_motion_state *state);

#ifdef __cplusplus
}
#endif

#endif
