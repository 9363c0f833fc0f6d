#include "src/skid_steer/skid_past.h"
#include "src/base/compiler.h"

#include "src/skid_steer/skid_arithmetic.h"

#define TWO_PI_Q16 JP_Q16(6.283185307179586)

/* Of steps in motion: those of 2¹⁷ steps ago count 1/e, because the bias wanders. */
#define STEPS_FADING_SHIFT 17U
#define STEPS_ONE          256 /* Q8 */

int64_t jp_skid_past_error(int32_t sensitivity, int32_t change, unsigned shift)
{
    return jp_multiply(jp_multiply_shift(sensitivity, change, shift), TWO_PI_Q16) >> 8;
}

static JP_INLINE_FOR_SPEED int64_t correction(int32_t of_bias, int32_t of_scale, const struct jp_skid_gyro *gyro)
{
    return jp_skid_past_error(of_bias, gyro->bias_change, JP_SKID_BIAS_BITS) +
           jp_skid_past_error(of_scale, gyro->scale_change, JP_SKID_SCALE_BITS);
}

/* The pose of the next step depends on bias and scale as the heading does. */
static void follow(struct jp_skid_past *past, const struct jp_skid_step *step, int32_t steps)
{
    past->bias_x = jp_add(past->bias_x, jp_multiply_shift(step->way_y, steps, 24));
    past->bias_y = jp_sub(past->bias_y, jp_multiply_shift(step->way_x, steps, 24));
    past->scale_x = jp_sub(past->scale_x, jp_multiply_shift(step->way_y, past->turned, 40));
    past->scale_y = jp_add(past->scale_y, jp_multiply_shift(step->way_x, past->turned, 40));
    past->steps += STEPS_ONE - (past->steps >> STEPS_FADING_SHIFT);
    past->way = jp_add(past->way, jp_round_shift(jp_skid_size(step->way), 16));
    past->turn = jp_add(past->turn, jp_round_shift(jp_skid_size(step->turn), 16));
}

void jp_skid_past_correct(struct jp_skid_odometry *odometry)
{
    struct jp_skid_past *past = &odometry->internal.past;
    const struct jp_skid_gyro *gyro = &odometry->internal.gyro;
    const int32_t steps = past->steps / STEPS_ONE;

    odometry->x += correction(past->bias_x, past->scale_x, gyro);
    odometry->y += correction(past->bias_y, past->scale_y, gyro);
    odometry->heading += (jp_phase)jp_multiply(past->turned, gyro->scale_change) * 4U -
                         (jp_phase)jp_multiply(steps, gyro->bias_change) * (jp_phase)JP_Q16_ONE;
    if (odometry->internal.is_moving) {
        follow(past, &odometry->internal.step, steps);
    }
}
