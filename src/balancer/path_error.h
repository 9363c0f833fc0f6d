/** The steering that leads a robot back to the path of the trajectory that it drives. Control of wheels and heading
 *  alone does not: who turns a little late turns at another place. Private to the core. */
#ifndef JOULEPATH_BALANCER_PATH_ERROR_H
#define JOULEPATH_BALANCER_PATH_ERROR_H

#include <joulepath/robot.h>

/** On the path. Constant time; for the control ISR. */
void jp_path_error_start(struct jp_path_error *error);

/** A leg begins whose middle is driven at this rate of the wheels. Constant time; for the control ISR. */
static inline void jp_path_error_begin_leg(struct jp_path_error *error, jp_turns_per_s cruise)
{
    error->cruise = cruise;
}

/**
 * Two ticks. The error grows by
 *
 *   across' = θ̇ sin δ − 2π φ̇ ahead     along' = 2π φ̇ across − θ̇ (1 − cos δ)
 *   ahead = along + the wheels' lead over the reference
 *
 * with δ the heading's error, θ̇ as measured and φ̇ of the trajectory. The reference's heading turns towards the aim,
 * which is the nearer to the path the further the robot is from it, and its wheels roll back what they are ahead of the
 * path. Where the path bends, the heading leads by what it turns until where the robot is,
 *
 *   lead → φ̇ ahead / θ̇     with θ̇ of the leg's middle: where a robot starts or stands there is no path ahead
 *
 * Constant time; for the control ISR.
 */
void jp_path_error_correct(struct jp_path_error *error, const struct jp_trajectory_config *config,
                           const struct jp_set_point *set_point, const struct jp_motion_state *motion,
                           struct jp_reference *reference);

#endif
