#include "src/skid_steer/skid_tilt.h"
#include "src/base/compiler.h"

#include "src/base/reciprocal.h"
#include "src/skid_steer/skid_arithmetic.h"

#define AHEAD  JP_SKID_TILT_AHEAD
#define LEFT   JP_SKID_TILT_LEFT
#define OFFSET JP_SKID_TILT_OFFSET

/* The grade ahead changes by 1/64 of what the one to the left does, for the pitch gyro tells. */
#define AHEAD_FADING_SHIFT 6U

/* What wheels and accelerometer tell of an acceleration differs by as much, and fades by 1/8 in a step: treads yield
 * late. */
#define UNREST_SHIFT 3U

/* The bias of the pitch gyro takes 1/64 of what it shows in a step at rest. */
#define PITCH_SHARE_SHIFT 6U

void jp_skid_tilt_start(struct jp_skid_tilt *tilt, const struct jp_skid_odometry_config *config, jp_q24 grade)
{
    const int64_t noise = jp_skid_over(config->accel_noise, 15U, config->tilt_deviation);
    const int64_t offset = jp_skid_over(config->accel_offset, 15U, config->tilt_deviation);
    const int64_t change = jp_skid_over(config->tilt_change, 8U, config->tilt_deviation);
    const int64_t rate = (int64_t)config->tick_rate;
    const int64_t ticks = (int64_t)config->step_ticks;
    const int32_t offset_variance = jp_clamp32(jp_saturate32(offset * offset), 1, JP_SKID_ONE);

    *tilt = (struct jp_skid_tilt){
        .state = {grade},
        .variance = {JP_SKID_ONE, JP_SKID_ONE, offset_variance},
        .accel_variance = (int32_t)jp_skid_variance(noise * noise, INT32_MAX),
        .reciprocal = jp_divide((int64_t)1 << 39, config->tilt_deviation),
        .fading = jp_saturate32(change * change / 4),
        .acceleration = jp_saturate32(rate * rate * JP_Q24_ONE / (ticks * ticks * JP_Q16(9.80665))),
    };
}

/* x without the share that is forgotten, Q30. */
static int32_t faded(int32_t x, int32_t fading)
{
    return x - jp_share(x, fading, 30);
}

/* A part of one grade goes to the other. */
static JP_INLINE_FOR_SPEED void shear(struct jp_skid_tilt *tilt, unsigned from, int32_t turn)
{
    const unsigned to = (unsigned)LEFT - from;
    const int32_t covariance = jp_add(tilt->grade_covariance, jp_skid_part(tilt->variance[from], turn));
    const int32_t both = jp_add(tilt->grade_covariance, covariance);

    tilt->state[to] = jp_add(tilt->state[to], jp_skid_part(tilt->state[from], turn));
    tilt->variance[to] = jp_add(tilt->variance[to], jp_skid_part(both, turn));
    tilt->grade_covariance = covariance;
    tilt->offset_covariance[to] =
        jp_add(tilt->offset_covariance[to], jp_skid_part(tilt->offset_covariance[from], turn));
}

/* The grade to the left is forgotten as the ground goes by. */
static void fade(struct jp_skid_tilt *tilt, int32_t fading)
{
    tilt->state[LEFT] = faded(tilt->state[LEFT], fading / 2);
    tilt->variance[LEFT] = jp_add(faded(tilt->variance[LEFT], fading), fading);
    tilt->grade_covariance = faded(tilt->grade_covariance, fading / 2);
    tilt->offset_covariance[LEFT] = faded(tilt->offset_covariance[LEFT], fading / 2);
    tilt->variance[AHEAD] = jp_add(tilt->variance[AHEAD], fading >> AHEAD_FADING_SHIFT);
}

void jp_skid_tilt_move(struct jp_skid_tilt *tilt, const struct jp_skid_step *step)
{
    const int32_t nodding = jp_sub(step->gyro_pitch, tilt->pitch_bias >> 8);
    const int32_t turn = jp_multiply_shift(step->turn, JP_SKID_TWO_PI, 32);
    const int64_t passed = jp_absolute64(jp_multiply(step->way, tilt->fading)) >> 16;

    /* Two shears turn the grades and keep the covariance one, however fast the robot turns. */
    shear(tilt, (unsigned)LEFT, turn);
    shear(tilt, (unsigned)AHEAD, -turn);
    fade(tilt, passed > JP_SKID_ONE ? JP_SKID_ONE : (int32_t)passed);
    tilt->state[AHEAD] = jp_sub(tilt->state[AHEAD], jp_multiply_shift(nodding, JP_SKID_TWO_PI, 32));
}

void jp_skid_tilt_stand(struct jp_skid_tilt *tilt, const struct jp_skid_step *step)
{
    const int64_t shown = (int64_t)step->gyro_pitch * 256;

    const int32_t change = jp_saturate32((shown - tilt->pitch_bias) >> PITCH_SHARE_SHIFT);

    tilt->pitch_bias = jp_clamp32(jp_add(tilt->pitch_bias, change), -JP_SKID_PITCH_BIAS_MAX, JP_SKID_PITCH_BIAS_MAX);
}

/* What a surprise tells of each, with the covariances of state and measurement, Q30, and that of the measurement. */
static void correct(struct jp_skid_tilt *tilt, jp_q24 surprise, const int32_t *of, int64_t variance)
{
    const struct jp_reciprocal reciprocal = jp_reciprocal_of(jp_skid_variance(variance, JP_SKID_VARIANCE_MAX));
    jp_q24 to[JP_SKID_TILT_STATES];

    for (unsigned i = 0; i < (unsigned)JP_SKID_TILT_STATES; i++) {
        to[i] = jp_share_of(of[i], &reciprocal);
        tilt->state[i] = jp_clamp32(jp_add(tilt->state[i], jp_skid_part(surprise, to[i])), -JP_Q24_ONE, JP_Q24_ONE);
        tilt->variance[i] = jp_skid_at_least_one(jp_sub(tilt->variance[i], jp_skid_part(of[i], to[i])));
    }
    for (unsigned i = 0; i < (unsigned)OFFSET; i++) {
        tilt->offset_covariance[i] = jp_sub(tilt->offset_covariance[i], jp_skid_part(of[OFFSET], to[i]));
    }
    tilt->grade_covariance = jp_sub(tilt->grade_covariance, jp_skid_part(of[LEFT], to[AHEAD]));
}

void jp_skid_tilt_learn(struct jp_skid_tilt *tilt, const struct jp_skid_step *step)
{
    const int32_t change = jp_sub(step->forward, step->forward_before);
    const jp_q24 acceleration = jp_multiply_shift(change, tilt->acceleration, 16);
    const jp_q24 expected = jp_add(jp_add(tilt->state[AHEAD], tilt->state[OFFSET]), acceleration);
    const int32_t of[] = {
        jp_add(tilt->variance[AHEAD], tilt->offset_covariance[AHEAD]),
        jp_add(tilt->grade_covariance, tilt->offset_covariance[LEFT]),
        jp_add(tilt->variance[OFFSET], tilt->offset_covariance[AHEAD]),
    };
    const jp_q24 fading = tilt->unrest - (tilt->unrest >> UNREST_SHIFT);
    const jp_q24 accelerated = jp_skid_size(acceleration);

    tilt->unrest = accelerated > fading ? accelerated : fading;

    const int32_t doubt = jp_skid_part(tilt->unrest, tilt->reciprocal); /* Q15 */
    const int64_t variance = (int64_t)of[AHEAD] + of[OFFSET] + tilt->accel_variance + jp_multiply(doubt, doubt);

    correct(tilt, jp_sub(step->force, expected), of, variance);
}
