/** The steering that leads a robot back to the path of the trajectory that it drives. Control of wheels and heading
 *  alone does not: who turns a little late turns at another place. Private to the core. */
#ifndef JOULEPATH_BALANCER_PATH_ERROR_H
#define JOULEPATH_BALANCER_PATH_ERROR_H

#include <joulepath/robot.h>

/** On the path. Constant time; for the control ISR. */
void jp_path_error_start(struct jp_path_error *error);

/**
 * Two ticks. The error grows by
 *
 *   across' = 2π (θ̇ δ − φ̇ ahead)     along' = 2π φ̇ across     ahead = along + the wheels' lead over the reference
 *
 * with δ the heading's error, θ̇ as measured and φ̇ of the trajectory. The reference's heading turns towards the aim,
 * which is the nearer to the path the further the robot is from it, and its wheels roll back what they are ahead of the
 * path. Constant time; for the control ISR.
 */
void jp_path_error_correct(struct jp_path_error *error, const struct jp_trajectory_config *config,
                           const struct jp_set_point *set_point, const struct jp_motion_state *motion,
                           struct jp_reference *reference);

#endif
