/** What is learned of bias and scale was true before: the pose follows (skid_odometry.h). Private to the core. */
#ifndef JOULEPATH_SKID_STEER_SKID_PAST_H
#define JOULEPATH_SKID_STEER_SKID_PAST_H

#include <joulepath/skid_odometry.h>

/** m, Q32: 2π · sensitivity · change, whose formats together have `shift` bits more than Q24. */
int64_t jp_skid_past_error(int32_t sensitivity, int32_t change, unsigned shift);

/** Bits that sensitivities and changes have more than Q24. */
#define JP_SKID_BIAS_BITS  24U
#define JP_SKID_SCALE_BITS 22U

/** The pose moves by what the last step taught; then that step, too, belongs to the past. Constant time; for the
 *  control ISR. */
void jp_skid_past_correct(struct jp_skid_odometry *odometry);

#endif
