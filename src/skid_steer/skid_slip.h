/** How far the robot slips under the forces on its wheels (skid_odometry.h), and how its ground grips. Private to the
 *  core. */
#ifndef JOULEPATH_SKID_STEER_SKID_SLIP_H
#define JOULEPATH_SKID_STEER_SKID_SLIP_H

#include <joulepath/skid_odometry.h>

/** `acceleration`: 1/(Δt² g), 1/m, Q8. */
void jp_skid_slip_start(struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config, int32_t acceleration);

/** Sets what the robot goes forward and sideways in a step. Constant time; for the control ISR, as what follows. */
void jp_skid_slip_move(struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config,
                       const struct jp_skid_tilt *tilt, struct jp_skid_step *step);

/** Sets its turn by the wheels, and how sure that is: a robot that is pushed aside skids less, one that is pushed along
 * skids more. */
void jp_skid_slip_push(const struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config,
                       struct jp_skid_step *step);

/** Learns from the motors' currents how the ground grips, where the robot slipped by turning rather than by its way. */
void jp_skid_slip_learn(struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config,
                        const struct jp_skid_step *step);

#endif
