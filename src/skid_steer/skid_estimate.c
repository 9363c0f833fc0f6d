/* What the odometry knows, and how well. */
#include "src/skid_steer/skid_arithmetic.h"
#include "src/skid_steer/skid_gyro.h"
#include "src/skid_steer/skid_past.h"

/* Of an error of the position, Q16: ±8 192 m. */
#define ERROR_BITS 30

/* √x of Q30. */
static int32_t root(int32_t x)
{
    return (int32_t)jp_square_root((uint64_t)(uint32_t)x << 30);
}

/* √(x² + y²), saturated. */
static int32_t length(int32_t x, int32_t y)
{
    return jp_saturate32((int64_t)jp_square_root((uint64_t)jp_multiply(x, x) + (uint64_t)jp_multiply(y, y)));
}

/* Of γ: σγ² (1 − share (1 − variance of r)), Q24. */
static jp_q24 scale_deviation(const struct jp_skid_odometry *odometry)
{
    const int32_t known = JP_SKID_ONE - jp_skid_lesser(odometry->internal.gyro.ratio_ratio, JP_SKID_ONE);
    const int32_t left = JP_SKID_ONE - jp_multiply_shift(odometry->internal.gyro.scale_share, known, 30);

    return jp_multiply_shift(odometry->internal.gyro.scale_deviation, root(left), 30);
}

/* Of b in a step, 2⁻⁴⁰ turn. */
static int32_t bias_deviation(const struct jp_skid_odometry *odometry)
{
    return jp_multiply_shift(odometry->internal.gyro.bias_unit, root(odometry->internal.gyro.bias_bias), 22);
}

/* Of one cause, m in Q32. */
static void add_error(struct jp_skid_estimate *estimate, int64_t x, int64_t y)
{
    const int32_t x_error = jp_saturate_bits(jp_round_shift(x, 16), ERROR_BITS); /* Q16 */
    const int32_t y_error = jp_saturate_bits(jp_round_shift(y, 16), ERROR_BITS);

    estimate->xx += jp_multiply(x_error, x_error);
    estimate->xy += jp_multiply(x_error, y_error);
    estimate->yy += jp_multiply(y_error, y_error);
}

/* Variance of a random walk, m², Q32: deviation² · amount in Q16. */
static int64_t walked(jp_q24 deviation, int32_t amount)
{
    return jp_multiply(jp_multiply_shift(deviation, deviation, 24), amount) >> 8;
}

/* The error that the way is wrong by a share, m, Q32. */
static int64_t by_way(int64_t position, jp_q24 deviation)
{
    return jp_multiply(jp_saturate32(position >> 16), deviation) >> 8;
}

static void set_pose_deviation(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                               int32_t bias, jp_q24 scale, struct jp_skid_estimate *estimate)
{
    const int32_t turns = odometry->internal.past.turn;
    const int32_t radians = jp_multiply_shift(turns, JP_SKID_TWO_PI, 24);
    const int64_t noise = walked(config->way_drift, odometry->internal.past.way) + walked(config->turn_drift, radians);

    estimate->xx = noise;
    estimate->xy = 0;
    estimate->yy = noise;
    add_error(estimate, by_way(odometry->x, config->way_deviation), by_way(odometry->y, config->way_deviation));
    add_error(estimate, jp_skid_past_error(odometry->internal.past.bias_x, bias, JP_SKID_BIAS_BITS),
              jp_skid_past_error(odometry->internal.past.bias_y, bias, JP_SKID_BIAS_BITS));
    add_error(estimate, jp_skid_past_error(odometry->internal.past.scale_x, scale * 64, JP_SKID_SCALE_BITS),
              jp_skid_past_error(odometry->internal.past.scale_y, scale * 64, JP_SKID_SCALE_BITS));
}

void jp_skid_odometry_estimate(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                               struct jp_skid_estimate *estimate)
{
    const struct jp_skid_step *step = &odometry->internal.step;
    const int32_t bias = bias_deviation(odometry);
    const jp_q24 scale = scale_deviation(odometry);
    const int32_t steps = odometry->internal.past.steps >> 8;
    const int64_t by_bias = jp_multiply(steps, bias) >> 16; /* turn, Q24; so the next */
    const int64_t by_scale = jp_multiply(odometry->internal.past.turned, scale) >> 24;
    const int32_t turned = length(jp_saturate32(by_bias), jp_saturate32(by_scale));
    const jp_q24 ratio =
        jp_multiply_shift(odometry->internal.gyro.ratio_unit, root(odometry->internal.gyro.ratio_ratio), 30);
    const jp_q24 of_scale = jp_multiply_shift(scale, config->ratio, 24);

    estimate->gyro_bias = odometry->bias_rate;
    estimate->gyro_bias_deviation = jp_multiply_shift(bias, odometry->internal.speed_per_way, 32);
    estimate->steering_ratio = odometry->steering_ratio;
    estimate->steering_ratio_deviation = length(ratio, of_scale);
    estimate->slip = jp_divide((int64_t)jp_sub(step->way, step->forward) * JP_Q24_ONE, step->way);
    estimate->slip_deviation = config->way_deviation;
    estimate->grade_ahead = odometry->internal.tilt.state[JP_SKID_TILT_AHEAD];
    estimate->grade_left = odometry->internal.tilt.state[JP_SKID_TILT_LEFT];
    estimate->heading_deviation = jp_multiply_shift(turned, JP_SKID_TWO_PI, 24);
    set_pose_deviation(odometry, config, bias, scale, estimate);
}

/* What the file says of wheels and gyro leaves of the scale when r is known: σγ σρ/√(σρ² + σγ² ρ0²), Q24. */
static jp_q24 least_scale_deviation(const struct jp_skid_odometry_config *config)
{
    const jp_q24 of_ratio = jp_multiply_shift(config->scale_deviation, config->ratio, 24);

    return jp_divide(jp_multiply(config->scale_deviation, config->ratio_deviation),
                     length(of_ratio, config->ratio_deviation));
}

void jp_skid_odometry_scale(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                            struct jp_gyro_scale *scale)
{
    const jp_q24 now = scale_deviation(odometry);
    const jp_q24 least = least_scale_deviation(config);

    scale->error = jp_skid_gyro_scale_error(&odometry->internal.gyro);
    scale->deviation = jp_clamp32(now > least ? now : least, 0, JP_GYRO_SCALE_DEVIATION_MAX / 64) * 64;
}
