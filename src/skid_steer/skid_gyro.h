/** The gyro against the wheels: a Kalman filter of skid_odometry.h that learns bias, scale and steering ratio. Private
 *  to the core. */
#ifndef JOULEPATH_SKID_STEER_SKID_GYRO_H
#define JOULEPATH_SKID_STEER_SKID_GYRO_H

#include <joulepath/skid_odometry.h>

/** The scale as it is known, with its deviation. */
void jp_skid_gyro_start(struct jp_skid_gyro *gyro, const struct jp_skid_odometry_config *config,
                        const struct jp_gyro_scale *known);

/** As the configuration has it. */
struct jp_gyro_scale jp_skid_gyro_scale_by_file(const struct jp_skid_odometry_config *config);

/** Learns bias and ratio from what the gyro shows beside the wheels. Constant time; for the control ISR, as what
 *  follows. */
void jp_skid_gyro_learn(struct jp_skid_gyro *gyro, const struct jp_skid_step *step, bool is_moving);

/** γ as it is known now, Q30. */
int32_t jp_skid_gyro_scale_error(const struct jp_skid_gyro *gyro);

/** The part of r that is the gyro's becomes its scale; returns what is left, ρ. */
jp_q24 jp_skid_gyro_rescale(struct jp_skid_gyro *gyro);

#endif
