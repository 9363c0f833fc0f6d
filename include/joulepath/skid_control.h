/**
 * Speed and turn rate of a skid-steered or differential-drive robot by the voltages of its two motors.
 *
 *   wheel rates   ω = (v ∓ w B/(2χ))/(2πr), left −, right +; χ: the steering ratio, turn rate over that of wheels that
 * do not slip (inverse of eq. 1 of Zhang et al., skid_steer.h) load          i = a v̇ + c sin(slope) ∓ (b ẇ + t w/(|w| +
 * q |v| + w0)) + rolling, A: the linear form of skid_steer.h's forces, with its turning moment; where the wheels brake
 * the load, i times η² voltage       u = K ω + R i + kp (ω − ω measured) + ki ∫ (ω − ω measured) dt limits        |u −
 * K ω measured| <= R imax, then |u| <= bus voltage; a voltage that a limit holds back is not integrated further, so the
 * way that is missing then stays missing
 *
 * The integral is the angle by which the wheels are behind: exact, as the encoders count. The measured rate is that of
 * a tracking loop that goes along with the reference.
 */
#ifndef JOULEPATH_SKID_CONTROL_H
#define JOULEPATH_SKID_CONTROL_H

#include <joulepath/sensors.h>
#include <joulepath/skid_sides.h>
#include <joulepath/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Constants of one robot; made by tools/design/skid_robot.py. Currents are those of a side's motor. */
struct jp_skid_control_config {
    uint32_t tick_rate;        /**< calls a second; 100…10 000 */
    jp_phase wheel_per_count;  /**< angle of a wheel for one count, 2⁻⁵⁶ turn; above 0, at most a turn */
    jp_q16 tracking_gain;      /**< share of the angle error taken a tick; above 0, at most 1 */
    jp_q16 tracking_rate_gain; /**< rate taken from the angle error, 1/s; above 0, at most tick_rate */
    jp_q24 turns_per_metre;    /**< 1/(2πr), turn/m; 0.03…32 */
    jp_q24 turns_per_radian;   /**< B/(4πr), turns of a wheel for one radian of the body; 0.001…4 */
    jp_q16 back_emf;           /**< K, V per turn/s; above 0, below 256 */
    jp_q16 resistance;         /**< R, Ω; 0.001…100 */
    jp_q16 current_limit;      /**< imax, A; above 0, R imax at most 1 000 V */
    jp_q16 rolling;            /**< rolling resistance and dry friction of a side, A; 0…2 047 */
    jp_turns_per_s creep;      /**< ω up to which they grow with it, turn/s; above 0 */
    jp_q16 climbing;           /**< c, A; 0…2 047 */
    jp_q16 acceleration;       /**< a, A per m/s²; 0…2 047 */
    jp_q16 turn_acceleration;  /**< b, A per rad/s²; 0…2 047 */
    jp_q16 turning;            /**< t, A; 0…2 047; 0: it turns freely, as a differential drive */
    jp_q24 turning_decrease;   /**< q, rad/m; 0…8 */
    jp_q24 turning_creep;      /**< w0, rad/s; 0.0001…1 */
    jp_q24 braking;            /**< η²; 0…1 */
    jp_q16 proportional;       /**< kp, V per turn/s; 0…2 047 */
    jp_q16 integral;           /**< ki, V per turn; above 0 */
};

/** What the robot shall do in a tick. */
struct jp_skid_set_point {
    jp_q24 speed;               /**< v, m/s; |v| <= 8 */
    jp_radians_per_s turn_rate; /**< w, rad/s; |w| <= 8 */
    jp_q24 acceleration;        /**< v̇, m/s² */
    jp_q24 turn_acceleration;   /**< ẇ, rad/s² */
    jp_q24 rise;                /**< sine of the slope ahead, uphill positive; |rise| <= 1 */
};

/** One side. */
struct jp_skid_side {
    uint32_t encoder;         /**< counts, as last read */
    jp_turns_per_s rate;      /**< ω measured, tracked */
    jp_turns_per_s reference; /**< ω */
    jp_q16 load;              /**< i, A */
    jp_phase behind;          /**< of the reference, 2⁻⁵⁶ turn */
    jp_phase rolled;          /**< in the last tick, 2⁻⁵⁶ turn */
    jp_phase untracked;       /**< what the rate does not explain of the counts, 2⁻⁵⁶ turn */
};

struct jp_skid_control {
    struct jp_skid_side sides[JP_SKID_SIDES];
    jp_q24 spread;          /**< B/(4πrχ), turn of a wheel per radian of the body */
    jp_q24 unsteering;      /**< 1/χ */
    int32_t phase_per_rate; /**< angle of one tick at a rate of 2⁻²⁴ turn/s */
    jp_q16 current_voltage; /**< R imax, V */
    jp_q16 rolling_slope;   /**< A per turn/s */
    jp_q24 behind_limit;    /**< where the integral alone takes R imax, turn */
};

/** The steering ratio is taken within these. */
#define JP_SKID_STEERING_MIN JP_Q24(0.25)
#define JP_SKID_STEERING_MAX JP_Q24(1.5)

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. Not
 *  for ISRs. */
enum jp_status jp_skid_control_check(const struct jp_skid_control_config *config, const char **field);

/** Prepares for a steering ratio; the robot is at rest. The configuration must have passed its check. Three 64-bit
 *  divisions. */
void jp_skid_control_start(struct jp_skid_control *control, const struct jp_skid_control_config *config,
                           jp_q24 steering);

/** Begins to count, at rest, from these counts on. Constant time; for the control ISR. */
void jp_skid_control_count_from(struct jp_skid_control *control, uint32_t encoder_left, uint32_t encoder_right);

/** The wheels are where they shall be, and at rest they shall stay. Constant time; for the control ISR. */
void jp_skid_control_forget(struct jp_skid_control *control);

/** Each tick, whether the motors run or not: rates of the wheels by the encoders. Constant time; for the control ISR.
 */
void jp_skid_control_measure(struct jp_skid_control *control, const struct jp_skid_control_config *config,
                             uint32_t encoder_left, uint32_t encoder_right);

/** Follows a steering ratio that is being learned: a Newton step towards its inverse, which a ratio that changes by
 * less than a third has after four calls. Constant time; for the control ISR. */
void jp_skid_control_steer(struct jp_skid_control *control, const struct jp_skid_control_config *config,
                           jp_q24 steering);

/** After jp_skid_control_measure(): the voltages, within the current limit and ±limit (the bus voltage, V; 0…1 000).
 *  One 32-bit division; constant time; for the control ISR. */
void jp_skid_control_update(struct jp_skid_control *control, const struct jp_skid_control_config *config,
                            const struct jp_skid_set_point *set_point, jp_q16 limit, struct jp_voltages *voltages);

/** What the motion takes by itself, K ω + R i, within ±limit: for wheels of which nothing is known. One 32-bit
 * division; constant time; for the control ISR. */
void jp_skid_control_blindly(struct jp_skid_control *control, const struct jp_skid_control_config *config,
                             const struct jp_skid_set_point *set_point, jp_q16 limit, struct jp_voltages *voltages);

#ifdef __cplusplus
}
#endif

#endif
