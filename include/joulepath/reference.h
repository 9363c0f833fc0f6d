/**
 * Reference of the controller: r = [v, w, φ + σ] (paper eq. 2), integrated to angles and shaped.
 *
 * The target steps with each segment. A critically damped second-order filter follows it,
 *
 *   θ̈r = (θt − θr)/τ² + 2 (θ̇t − θ̇r)/τ
 *
 * and likewise for yaw: without lag in steady motion, without a step in rate or angle. The filter is linear, so the
 * energy of a segment stays the quadratic form of energy.h. τ = 0 passes the steps through, as the paper does.
 *
 * A change of direction is the exception: the target first rests at speed 0 for `rest_ticks`, counted from the end of
 * the old speed, so that no sequence of steps forward and back excites the pitch until the robot falls. The energy
 * model does not include this rest.
 */
#ifndef JOULEPATH_REFERENCE_H
#define JOULEPATH_REFERENCE_H

#include <stdbool.h>

#include <joulepath/energy.h>
#include <joulepath/fixed.h>
#include <joulepath/status.h>
#include <joulepath/trajectory.h>

#ifdef __cplusplus
extern "C" {
#endif

struct jp_reference_config {
    uint32_t tick_rate;      /**< calls a second; 100…10 000 */
    jp_q24 turns_per_metre;  /**< 1/(2πR), turn/m; 0.1…16 */
    jp_q16 travel_bandwidth; /**< 1/τ, rad/s; 0 (no shaping) or 0.016…100, at most tick_rate/4 */
    jp_q16 yaw_bandwidth;    /**< 1/τ, rad/s; 0 (no shaping) or 0.016…100, at most tick_rate/4 */
    uint32_t rest_ticks;     /**< at speed 0 between forward and back; 0…10 000 000 */
};

/** One axis: the target, and the shaped set-point that the controller follows. */
struct jp_reference_axis {
    jp_phase target;
    jp_turns_per_s target_rate; /**< turn/s */
    jp_phase angle;
    jp_turns_per_s rate; /**< turn/s */
};

/** A step of the target. */
struct jp_reference_step {
    jp_turns_per_s wheel_rate; /**< turn/s */
    jp_turns_per_s yaw_rate;   /**< turn/s */
    jp_q24 turn;               /**< turn */
};

struct jp_reference {
    struct jp_reference_axis wheel; /**< θ */
    struct jp_reference_axis yaw;   /**< φ */
    int32_t phase_per_rate;         /**< angle of one tick at a rate of 2⁻²⁴ turn/s: jp_phase_per_rate() */
    jp_turns_per_s waiting_rate;    /**< of the wheels, turn/s: begins after the rest; 0: none waits */
    jp_q24 pitch;                   /**< of a trajectory, turn; 0 otherwise, as the four below */
    jp_q24 pitch_rate;              /**< turn/s */
    jp_turns_per_s yaw_lead;        /**< with which yaw turns beside its set-point's rate, turn/s */
    jp_q16 common;                  /**< voltage that the motion needs, (ur + ul)/2, V */
    jp_q16 difference;              /**< (ur − ul)/2, V */
    uint32_t rest_left;             /**< ticks until the direction may change */
    bool forward;                   /**< direction of the last speed that was not 0 */
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. Not
 *  for ISRs. */
enum jp_status jp_reference_check(const struct jp_reference_config *config, const char **field);

/** Starts at rest at the given angles. Constant time; for the control ISR. */
void jp_reference_start(struct jp_reference *reference, const struct jp_reference_config *config, jp_phase wheel,
                        jp_phase yaw);

/** After jp_reference_start(), when the robot moves at these rates (turn/s): the shaped reference slows down from them
 * and comes to rest where it started, as after a step to rest. Without shaping nothing changes. Constant time; for the
 *  control ISR. */
void jp_reference_coast(struct jp_reference *reference, const struct jp_reference_config *config, jp_q24 wheel_rate,
                        jp_q24 yaw_rate);

/** The step of the target to this motion (|v| <= 8 m/s, |w| <= 8 rad/s) with the heading turned by `turn` rad. Cannot
 *  fail; constant time. */
struct jp_reference_step jp_reference_step_to(const struct jp_reference_config *config, const struct jp_motion *motion,
                                              jp_q24 turn);

/** Steps the target: at once or, against the last direction, after the rest. Constant time; for the control ISR. */
void jp_reference_apply(struct jp_reference *reference, const struct jp_reference_step *step);

/** One tick. Cannot fail; constant time; for the control ISR. */
void jp_reference_update(struct jp_reference *reference, const struct jp_reference_config *config);

/** One tick along a trajectory, in place of jp_reference_update(): the controller follows the set-point as it is, with
 *  the angles integrated from its rates. Constant time; for the control ISR. */
void jp_reference_track(struct jp_reference *reference, const struct jp_set_point *set_point);

/** The trajectory is over: no pitch and no voltage of it is left. To be called before jp_reference_update(). Constant
 * time; for the control ISR. */
void jp_reference_leave_track(struct jp_reference *reference);

#ifdef __cplusplus
}
#endif

#endif
