/**
 * Four wheels, each steered and driven on its own, about one instantaneous centre of rotation (double Ackermann).
 *
 * Wheel i stands at (xi, yi) = (±wheelbase/2, ±track/2) from the centre of the chassis. While the chassis moves at
 * (vx, vy, w) the wheel's contact moves at (vx − w yi, vy + w xi): its direction is the steering angle, its length the
 * wheel's speed. A wheel turned by half a turn and reversed does the same; of the two angles the one nearer to the
 * present angle is taken. The direction of a contact slower than JP_WHEEL_HOLD_SPEED is not steered to: its wheel keeps
 * its angle, and its speed is the component along it.
 *
 * Slip is the root mean square of the four contacts' slip velocities. Slip up to JP_SLIP_QUANTUM, which rounding alone
 * can cause for wheels up to 16 m/s, is given as 0; tests/property/prop_four_wheel.c measures it.
 *
 * Integers only, the same bits on every core. All functions are bounded and may be called from an ISR; those that take
 * a configuration expect one that passed jp_four_wheel_check().
 */
#ifndef JOULEPATH_FOUR_WHEEL_H
#define JOULEPATH_FOUR_WHEEL_H

#include <joulepath/status.h>
#include <joulepath/twist.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_WHEEL_HOLD_SPEED ((jp_q24)4096) /**< 2⁻¹² m/s */
#define JP_SLIP_QUANTUM     ((jp_q24)4)    /**< 2⁻²² m/s */

/** A wheel whose angle is farther from its goal is steered at a standstill before it drives. */
#define JP_STEERING_DRIVE_ERROR JP_ANGLE_DEGREES(30)

/** Indices of the wheels. */
enum { JP_FRONT_LEFT, JP_FRONT_RIGHT, JP_REAR_LEFT, JP_REAR_RIGHT, JP_WHEELS };

struct jp_four_wheel_config {
    jp_q24 wheelbase;       /**< axle to axle, m; 0.05…4 */
    jp_q24 track;           /**< left to right contact, m; 0.05…4 */
    int32_t steering_limit; /**< of each wheel to either side, 2⁻³² turn; at least atan(wheelbase/track), so that the
                                 chassis can turn in place, at most JP_ANGLE_DEGREES(120) */
    int32_t steering_step; /**< largest change in a tick, 2⁻³² turn; JP_ANGLE_DEGREES(0.05)…JP_ANGLE_DEGREES(120) */
    jp_q24 speed_max;      /**< of a wheel, m/s; 0.01…16 */
    jp_q24 speed_step;     /**< largest change of a wheel's speed in a tick, m/s; JP_WHEEL_HOLD_SPEED…16 m/s */
};

/** State or set-point of the wheels: angle counterclockwise from straight ahead, 2⁻³² turn, and speed along it, m/s. */
struct jp_wheels {
    int32_t angle[JP_WHEELS];
    jp_q24 speed[JP_WHEELS];
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_four_wheel_check(const struct jp_four_wheel_config *config, const char **field);

/** Least turn radius, m, from which on no wheel exceeds its steering limit, for vy = 0; rounded up. 0: every radius is
 *  possible, as the limit is a quarter turn or more. One 64-bit division. */
jp_q24 jp_four_wheel_radius_min(const struct jp_four_wheel_config *config);

/**
 * The twist of the two-wheel model with the front steering angle δ in 2⁻³² turn: turn rate 2 v tan(δ)/wheelbase, vy =
 * 0. JP_ERR_ARGUMENT: a null pointer, |speed| > 16 m/s, or |δ| is a quarter turn or more; *twist is not written.
 * JP_ERR_OVERFLOW: the turn rate is 128 rad/s or more; it is saturated. One 64-bit division.
 */
enum jp_status jp_four_wheel_twist(const struct jp_four_wheel_config *config, jp_q24 speed, int32_t angle,
                                   struct jp_twist *twist);

/**
 * Inverse kinematics: the wheels' angles and speeds for a twist, from their present ones (`wheels` is in and out).
 * An angle beyond the limit by so little that the contact moves by at most JP_SLIP_QUANTUM/2 becomes the limit.
 * JP_ERR_INFEASIBLE: both angles of a wheel are beyond the limit, or its speed is above speed_max.
 * JP_ERR_ARGUMENT: a null pointer, |x| or |y| > 16 m/s, or |turn rate| > 16 rad/s.
 * `wheels` then stays as it was. Work: four directions and four square roots.
 */
enum jp_status jp_four_wheel_inverse(const struct jp_four_wheel_config *config, const struct jp_twist *twist,
                                     struct jp_wheels *wheels);

/**
 * Forward kinematics: the twist that fits the wheels best (least squares over the eight components of the contacts) and
 * the residual slip, m/s. Speeds saturate at ±16 m/s, a component of slip at 8 m/s, and the turn rate at ±128 rad/s.
 * Cannot fail; pointers are not checked. Work: five sines and five cosines, an arctangent, two 64-bit divisions and a
 * square root.
 */
void jp_four_wheel_forward(const struct jp_four_wheel_config *config, const struct jp_wheels *wheels,
                           struct jp_twist *twist, jp_q24 *slip);

/** What the wheels do in a tick. */
enum jp_steering {
    JP_STEERING_ALIGNED,   /**< all wheels are as the twist asks */
    JP_STEERING_LIMITED,   /**< steering or speed is at its rate limit */
    JP_STEERING_STANDSTILL /**< braking, or held at a standstill: the wheels must turn first, or the twist is refused */
};

/**
 * One tick towards a twist: angles by at most steering_step, speeds by at most speed_step.
 *
 * The velocities of the four contacts change by the same share of their difference to the goal, so that they stay those
 * of one twist and no wheel is dragged: only rounding and wheels below JP_WHEEL_HOLD_SPEED add slip. When the angle of
 * a wheel is more than JP_STEERING_DRIVE_ERROR from its goal, or a wheel must reverse at another angle, all wheels
 * brake in proportion to a standstill, then steer, then drive.
 *
 * A constant feasible twist is reached, from any wheels, within 420°/steering_step + 10 speed_max/speed_step + 16
 * ticks, and is kept. A twist of 0 stops the wheels within speed_max/speed_step + 1 ticks at the angles they have.
 *
 * Status as jp_four_wheel_inverse(). After a failure the tick is that of a twist of 0 and *steering is
 * JP_STEERING_STANDSTILL; with a null pointer nothing is done.
 */
enum jp_status jp_four_wheel_tick(const struct jp_four_wheel_config *config, const struct jp_twist *twist,
                                  struct jp_wheels *wheels, enum jp_steering *steering);

#ifdef __cplusplus
}
#endif

#endif
