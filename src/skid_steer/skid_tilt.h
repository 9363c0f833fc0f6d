/** The tilt of the ground, by accelerometer and gyros: a Kalman filter of skid_odometry.h. Private to the core. */
#ifndef JOULEPATH_SKID_STEER_SKID_TILT_H
#define JOULEPATH_SKID_STEER_SKID_TILT_H

#include <joulepath/skid_odometry.h>

/** Largest bias of the pitch gyro in a step, 2⁻⁴⁰ turn: a robot that is tipped over by hand shows more. */
#define JP_SKID_PITCH_BIAS_MAX (INT32_MAX / 2)

/** Starts on the grade that a stand reads, g. */
void jp_skid_tilt_start(struct jp_skid_tilt *tilt, const struct jp_skid_odometry_config *config, jp_q24 grade);

/** The robot turned and moved by a step. Constant time; for the control ISR, as what follows. */
void jp_skid_tilt_move(struct jp_skid_tilt *tilt, const struct jp_skid_step *step);

/** It stood, which shows the bias of the pitch gyro. */
void jp_skid_tilt_stand(struct jp_skid_tilt *tilt, const struct jp_skid_step *step);

/** Learns grades and offset from the accelerometer without the robot's own acceleration. */
void jp_skid_tilt_learn(struct jp_skid_tilt *tilt, const struct jp_skid_step *step);

#endif
