#include "src/skid_steer/skid_gyro.h"
#include "src/base/compiler.h"

#include "src/base/reciprocal.h"
#include "src/skid_steer/skid_arithmetic.h"

#define RADIANS_INVERSE_Q16 JP_Q16(0.15915494309189535)

/* Least deviation of the bias in a step, 2⁻³² turn. */
#define UNIT_MIN 16

/* The wheels' turn in a step, in deviations, Q16, is limited to ±32. */
#define WEIGHTED_BITS 22

/* r returns to its prior deviation within 512 turns, because grounds differ: 2³⁰ over 512 · 2³². */
#define RATIO_GROWTH_SHIFT 11U

/* Least r that is believed, Q30. */
#define RATIO_MIN (JP_SKID_ONE / 16)

/* Of what the wheels show of a turn, over bias_unit² in Q30, at most, and what pushes the robot makes of its deviation,
 * Q4. */
#define TURN_VARIANCE_MAX ((int64_t)1 << 40)
#define UNSURE_ONE        16
#define UNSURE_MAX        256

/* ---- Start ---- */

/* x · step / s, rounded down. */
static int64_t in_a_step(const struct jp_skid_odometry_config *config, int64_t x)
{
    const int64_t ticks = (int64_t)config->step_ticks;
    const int64_t rate = (int64_t)config->tick_rate;

    return x * ticks / rate;
}

struct jp_gyro_scale jp_skid_gyro_scale_by_file(const struct jp_skid_odometry_config *config)
{
    return (struct jp_gyro_scale){.error = 0, .deviation = config->scale_deviation * 64};
}

/* 1/(1 + error), Q30. */
static int32_t reciprocal_scale(int32_t error)
{
    return JP_SKID_ONE - error + jp_share(error, error, 30);
}

void jp_skid_gyro_start(struct jp_skid_gyro *gyro, const struct jp_skid_odometry_config *config,
                        const struct jp_gyro_scale *known)
{
    const jp_q24 scale_deviation = known->deviation / 64;
    const int32_t ratio = config->ratio * 64;                                             /* Q30 */
    const int64_t scale = ((int64_t)scale_deviation * config->ratio) >> 24;               /* of r, Q24 */
    const int64_t both = jp_skid_square(config->ratio_deviation) + jp_skid_square(scale); /* Q48 */
    const int32_t deviation = (int32_t)jp_square_root((uint64_t)both);
    const int32_t bias = (int32_t)in_a_step(config, (int64_t)config->bias_deviation * 256);
    const int32_t unit = bias < UNIT_MIN ? UNIT_MIN : bias;
    const int64_t noise = jp_skid_over(config->gyro_noise, 14U, config->bias_deviation);
    const int64_t count = jp_skid_over(config->turn_per_count, 7U, unit); /* 2⁸ times as fine as the unit */
    const int64_t way = jp_skid_over(config->way_noise, 16U, unit);  /* Q8, for the unit is 2⁸ times as fine as Q24 */
    const int64_t turn = jp_skid_over(config->turn_noise, 7U, unit); /* 2⁻³¹ turn in Q0 */

    *gyro = (struct jp_skid_gyro){
        .ratio = jp_add(ratio, jp_multiply_shift(ratio, known->error, 30)),
        .scale = reciprocal_scale(known->error),
        .bias_bias = JP_SKID_ONE,
        .ratio_ratio = JP_SKID_ONE,
        .bias_unit = unit,
        .ratio_unit = deviation,
        .ratio_weight = jp_saturate32((int64_t)deviation * 65536 / unit),
        .ratio_reciprocal = jp_divide((int64_t)1 << 48, config->ratio),
        .scale_share = jp_saturate32((jp_skid_square(scale) << 18) / (both >> 12)),
        .scale_error = known->error,
        .scale_deviation = scale_deviation,
        .bias_growth = (int32_t)(in_a_step(config, JP_SKID_ONE) / (int64_t)config->bias_memory) + 1,
        .way_variance = jp_saturate32((way * way) >> 2),
        .turn_variance = jp_saturate32((turn * turn * RADIANS_INVERSE_Q16) >> 16),
        .per_turn_noise = jp_divide((int64_t)JP_Q24_ONE * UNSURE_ONE, config->turn_noise),
        .gyro_variance = jp_skid_variance(noise * noise * 4 / (int64_t)config->step_ticks, JP_SKID_VARIANCE_MAX),
        .count_variance = count * count / 6,
    };
    gyro->ratio_start = gyro->ratio;
}

/* ---- Filter ---- */

/* Of what the wheels show of the turn, over bias_unit², Q30: what pushes the robot is known by its size only. */
static int64_t turn_noise_of(const struct jp_skid_gyro *gyro, const struct jp_skid_step *step)
{
    const int64_t turn = jp_absolute64(jp_multiply(gyro->turn_variance, step->wheel_turn));
    const int32_t unsure =
        jp_skid_lesser(jp_add(UNSURE_ONE, jp_skid_part(step->pushed, gyro->per_turn_noise)), UNSURE_MAX);

    return (turn < TURN_VARIANCE_MAX ? turn : TURN_VARIANCE_MAX) * (unsure * unsure) / (UNSURE_ONE * UNSURE_ONE);
}

/* Of what the wheels show of the turn and of the gyro's noise, over bias_unit², Q30. */
static int64_t noise_of(const struct jp_skid_gyro *gyro, const struct jp_skid_step *step, bool is_moving)
{
    if (!is_moving) {
        return gyro->gyro_variance;
    }
    const int64_t way = jp_multiply(gyro->way_variance, step->way);

    return gyro->gyro_variance + gyro->count_variance + (jp_absolute64(way) >> 16) + turn_noise_of(gyro, step);
}

/* Q30 · Q24; the result is part of a variance. */
static JP_INLINE_FOR_SPEED int32_t reduction(int32_t gain, int64_t covariance)
{
    return jp_saturate32((gain * (covariance >> 8)) >> 16);
}

void jp_skid_gyro_learn(struct jp_skid_gyro *gyro, const struct jp_skid_step *step, bool is_moving)
{
    const int32_t turn = step->pushed_turn;
    const int32_t expected = jp_add(gyro->bias >> 8, jp_multiply_shift(turn, gyro->ratio, 30));
    const int32_t surprise = jp_sub(step->gyro_turn, expected);
    const int32_t weighted = jp_skid_part(turn, gyro->ratio_weight);
    const int32_t weight = jp_saturate_bits(weighted, WEIGHTED_BITS);
    const uint32_t growth = jp_magnitude32(turn) >> RATIO_GROWTH_SHIFT;

    gyro->bias_bias = jp_skid_lesser(gyro->bias_bias + gyro->bias_growth, JP_SKID_ONE);
    gyro->ratio_ratio = jp_skid_lesser(gyro->ratio_ratio + (int32_t)growth, JP_SKID_ONE);

    const int64_t of_bias = gyro->bias_bias + (jp_multiply(gyro->bias_ratio, weight) >> 16); /* Q30 */
    const int64_t of_ratio = gyro->bias_ratio + (jp_multiply(gyro->ratio_ratio, weight) >> 16);
    const int64_t variance = of_bias + ((of_ratio * weight) >> 16) + noise_of(gyro, step, is_moving);
    const struct jp_reciprocal reciprocal = jp_reciprocal_of(jp_skid_variance(variance, 4 * JP_SKID_VARIANCE_MAX));
    const jp_q24 to_bias = jp_share_of(of_bias, &reciprocal);
    const jp_q24 to_ratio = jp_share_of(of_ratio, &reciprocal);
    const int32_t shown = jp_skid_part(surprise, gyro->ratio_weight); /* of r, Q16 */

    gyro->bias_bias = jp_skid_at_least_one(jp_sub(gyro->bias_bias, reduction(to_bias, of_bias)));
    gyro->bias_ratio = jp_sub(gyro->bias_ratio, reduction(to_bias, of_ratio));
    gyro->ratio_ratio = jp_skid_at_least_one(jp_sub(gyro->ratio_ratio, reduction(to_ratio, of_ratio)));
    gyro->bias_change = jp_multiply_shift(surprise, to_bias, 16);
    gyro->bias = jp_add(gyro->bias, gyro->bias_change);
    gyro->ratio = jp_clamp32(jp_add(gyro->ratio, jp_multiply_shift(shown, to_ratio, 10)), RATIO_MIN, INT32_MAX);
}

int32_t jp_skid_gyro_scale_error(const struct jp_skid_gyro *gyro)
{
    const int32_t relative = jp_skid_part(jp_sub(gyro->ratio, gyro->ratio_start), gyro->ratio_reciprocal);
    const int32_t error = jp_add(gyro->scale_error, jp_multiply_shift(relative, gyro->scale_share, 30));

    return jp_clamp32(error, -JP_GYRO_SCALE_MAX, JP_GYRO_SCALE_MAX);
}

jp_q24 jp_skid_gyro_rescale(struct jp_skid_gyro *gyro)
{
    const int32_t scale = reciprocal_scale(jp_skid_gyro_scale_error(gyro));

    gyro->scale_change = scale - gyro->scale;
    gyro->scale = scale;
    return jp_multiply_shift(gyro->ratio, scale, 36);
}
