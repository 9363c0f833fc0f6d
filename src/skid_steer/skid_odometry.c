#include <joulepath/skid_odometry.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/integer.h"

#define ONE ((int32_t)1 << 30) /* Q30 */

#define TWO_PI              JP_Q24(6.283185307179586)
#define RADIANS_INVERSE_Q16 JP_Q16(0.15915494309189535)
#define TWO_PI_Q16          JP_Q16(6.283185307179586)
#define ACCEL_BITS          26 /* ±2 g */

/* The wheels stand once both sides have stayed within this many counts for a quarter of a second. */
#define STAND_COUNTS       1
#define STANDS_IN_A_SECOND 4U

/* Of two numbers of the configuration. */
#define QUOTIENT_MAX ((int64_t)1 << 24)

/* What variances of the heading's filter are limited to, Q30, so that the reciprocal of their sum is precise. */
#define VARIANCE_MIN ((int64_t)1 << 16)
#define VARIANCE_MAX ((int64_t)1 << 45)

/* The wheels' turn in a step, in deviations, Q16, is limited to ±32. */
#define WEIGHTED_BITS 22

/* r returns to its prior deviation within 512 turns, because grounds differ: 2³⁰ over 512 · 2³². */
#define RATIO_GROWTH_SHIFT 11U

/* Least r that is believed, Q30. */
#define RATIO_MIN (ONE / 16)

/* The grade ahead changes by 1/64 of what the one to the left does, for the pitch gyro tells. */
#define AHEAD_FADING_SHIFT 6U

/* The bias of the pitch gyro takes 1/64 of what it shows in a step at rest. */
#define PITCH_SHARE_SHIFT 6U

/* Of steps in motion: those of 2¹⁷ steps ago count 1/e, because the bias wanders. */
#define STEPS_FADING_SHIFT 17U

/* Of the force that a turn takes: 1/e after 1/3 rad; ground that grips less than the file's by 8 at most. */
#define GRIP_ONE       4096
#define GRIP_MEMORY    5
#define GRIP_MAX       8
#define GRIP_FORCE_MIN JP_Q24(0.05)

/* Of an error of the position, Q16: ±8 192 m. */
#define ERROR_BITS 30

/* What ratio and scale are corrected by at most. */
#define RATIO_GROWTH_MAX JP_Q24(0.0625)
#define SCALE_ERROR_MAX  (ONE / 4)

#define FIELD(member, low, high) JP_CONFIG_FIELD("skid_odometry.", struct jp_skid_odometry_config, member, low, high)

enum jp_status jp_skid_odometry_check(const struct jp_skid_odometry_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(tick_rate, JP_TICK_RATE_MIN, JP_TICK_RATE_MAX),
        FIELD(step_ticks, 6, 32),
        FIELD(way_per_count, (int32_t)1 << 12, (int32_t)1 << 30),
        FIELD(turn_per_count, (int32_t)1 << 12, (int32_t)1 << 30),
        FIELD(ratio, JP_Q24(0.1), JP_Q24(1.5)),
        FIELD(ratio_deviation, JP_Q24(0.0001), JP_Q24(0.5)),
        FIELD(scale_deviation, 0, JP_Q24(0.1)),
        FIELD(bias_deviation, JP_Q24_ONE >> 16, JP_Q24(0.1)),
        FIELD(bias_memory, 1000, 100000000),
        FIELD(gyro_noise, JP_Q24_ONE >> 20, JP_Q24(0.1)),
        FIELD(way_noise, JP_Q24_ONE >> 16, JP_Q24(0.1)),
        FIELD(turn_noise, JP_Q24(0.001), JP_Q24_ONE),
        FIELD(tilt_deviation, JP_Q24(0.005), JP_Q24(0.5)),
        FIELD(tilt_change, JP_Q24(0.001), JP_Q24_ONE),
        FIELD(accel_noise, JP_Q24(0.0005), JP_Q24(0.1)),
        FIELD(accel_offset, 0, JP_Q24(0.5)),
        FIELD(ratio_growth, 0, JP_Q24(16)),
        FIELD(creep, 0, JP_Q24_ONE),
        FIELD(turn_creep_along, 0, JP_Q24(8)),
        FIELD(turn_creep_across, 0, JP_Q24(8)),
        FIELD(caster_drag, 0, JP_Q24(0.2)),
        FIELD(turn_force, 0, JP_Q24(2)),
        FIELD(force_per_ampere, 0, JP_Q24(16)),
        FIELD(efficiency, JP_Q24(0.1), JP_Q24_ONE),
        FIELD(rolling, 0, JP_Q24(0.5)),
        FIELD(way_deviation, 0, JP_Q24(0.1)),
        FIELD(way_drift, 0, JP_Q24(0.5)),
        FIELD(turn_drift, 0, JP_Q24(0.5)),
    };

    return jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);
}

/* ---- Start ---- */

static int64_t square(int64_t x)
{
    return x * x;
}

static int64_t within(int64_t x, int64_t low, int64_t high)
{
    const int64_t at_least = x < low ? low : x;

    return at_least > high ? high : at_least;
}

/* x 2^bits / divisor, so limited that its square fits; x >= 0, divisor > 0. */
static int64_t over(int64_t x, unsigned bits, int64_t divisor)
{
    return within(x * ((int64_t)1 << bits) / divisor, 0, QUOTIENT_MAX);
}

/* x · step / s, rounded down. */
static int64_t in_a_step(const struct jp_skid_odometry_config *config, int64_t x)
{
    const int64_t ticks = (int64_t)config->step_ticks;
    const int64_t rate = (int64_t)config->tick_rate;

    return x * ticks / rate;
}

static void set_heading_filter(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    const int64_t scale = ((int64_t)config->scale_deviation * config->ratio) >> 24; /* of r, Q24 */
    const int64_t both = square(config->ratio_deviation) + square(scale);           /* Q48 */
    const int64_t unit = within(in_a_step(config, (int64_t)config->bias_deviation * 256), 16, INT32_MAX);
    const int64_t gyro = over(config->gyro_noise, 14U, config->bias_deviation);
    const int64_t count = over(config->turn_per_count, 7U, unit); /* turn_per_count is 2⁸ times as fine as the unit */
    const int64_t way = over(config->way_noise, 16U, unit);       /* Q8, for the unit is 2⁸ times as fine as Q24 */
    const int64_t turn = over(config->turn_noise, 7U, unit);      /* 2⁻³¹ turn in Q0 */
    const uint32_t deviation = jp_square_root((uint64_t)both);

    odometry->steering_ratio = config->ratio;
    odometry->internal.ratio = config->ratio * 64;
    odometry->internal.scale = ONE;
    odometry->internal.bias_bias = ONE;
    odometry->internal.ratio_ratio = ONE;
    odometry->internal.bias_unit = (int32_t)unit;
    odometry->internal.ratio_unit = (int32_t)deviation;
    odometry->internal.ratio_weight = jp_saturate32((int64_t)deviation * 65536 / unit);
    odometry->internal.ratio_reciprocal = jp_divide((int64_t)1 << 48, config->ratio);
    odometry->internal.scale_share = jp_saturate32((square(scale) << 18) / (both >> 12));
    odometry->internal.bias_growth = (int32_t)(in_a_step(config, ONE) / (int64_t)config->bias_memory) + 1;
    odometry->internal.gyro_variance =
        within(square(gyro) * 4 / (int64_t)config->step_ticks, VARIANCE_MIN, VARIANCE_MAX);
    odometry->internal.count_variance = within(square(count) / 6, 0, VARIANCE_MAX);
    odometry->internal.way_variance = jp_saturate32(square(way) >> 2);
    odometry->internal.turn_variance = jp_saturate32((square(turn) * RADIANS_INVERSE_Q16) >> 16);
}

static void set_tilt_filter(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    const int64_t noise = over(config->accel_noise, 15U, config->tilt_deviation);
    const int64_t offset = over(config->accel_offset, 15U, config->tilt_deviation);
    const int64_t change = over(config->tilt_change, 8U, config->tilt_deviation);

    odometry->internal.tilt_reciprocal = jp_divide((int64_t)1 << 39, config->tilt_deviation);
    odometry->internal.accel_variance = jp_saturate32(within(square(noise), VARIANCE_MIN, INT32_MAX));
    odometry->internal.tilt_fading = jp_saturate32(square(change) >> 2);
    odometry->internal.tilt.ahead_ahead = ONE;
    odometry->internal.tilt.left_left = ONE;
    odometry->internal.tilt.offset_offset = jp_saturate32(within(square(offset), 1, ONE));
}

/* What a turn creeps on ground that grips less than the file's by a factor, Q12. */
static void set_turn_creep(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                           int32_t factor)
{
    const int32_t per_turn = jp_multiply_shift(TWO_PI, factor, 12); /* Q24 */

    odometry->internal.turn_creep_along = jp_multiply_shift(config->turn_creep_along, per_turn, 24);
    odometry->internal.turn_creep_across = jp_multiply_shift(config->turn_creep_across, per_turn, 24);
}

static void set_units(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    const int64_t ticks = (int64_t)config->step_ticks;
    const int64_t rate = (int64_t)config->tick_rate;

    odometry->internal.phase_per_rate = jp_phase_per_rate(config->tick_rate);
    odometry->internal.stand_steps_min = config->tick_rate / (STANDS_IN_A_SECOND * config->step_ticks) + 1U;
    odometry->internal.mean_share = jp_divide((int64_t)1 << 31, (int32_t)ticks);
    odometry->internal.speed_per_way = jp_saturate32(rate * JP_Q16_ONE / ticks);
    odometry->internal.acceleration = jp_saturate32(square(rate) * JP_Q24_ONE / (square(ticks) * JP_Q16(9.80665)));
    odometry->internal.centripetal = jp_multiply_shift(odometry->internal.acceleration, TWO_PI, 24);
    odometry->internal.turn_force = config->turn_force;
    odometry->internal.braking = jp_divide((int64_t)1 << 48, config->efficiency);
    set_turn_creep(odometry, config, GRIP_ONE);
}

void jp_skid_odometry_start(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                            const struct jp_sensors *sensors)
{
    *odometry = (struct jp_skid_odometry){.internal = {.encoder_left = sensors->encoder_left,
                                                       .encoder_right = sensors->encoder_right,
                                                       .stand_left = sensors->encoder_left,
                                                       .stand_right = sensors->encoder_right,
                                                       .stand_steps = UINT32_MAX}};
    odometry->internal.tilt.ahead = jp_saturate_bits(sensors->accel_x, ACCEL_BITS);
    set_heading_filter(odometry, config);
    set_tilt_filter(odometry, config);
    set_units(odometry, config);
}

/* ---- Filters ---- */

/* 1/x = mantissa / 2^(63 − zeros), mantissa of 2¹⁵…2¹⁶. */
struct reciprocal {
    int32_t mantissa;
    unsigned zeros;
};

/* Of 2¹⁶ <= x < 2⁴⁸, to 2⁻¹⁵. One 32-bit division. */
static struct reciprocal reciprocal_of(int64_t x)
{
    const uint32_t high = (uint32_t)(x >> 16);
    const unsigned zeros = JP_LEADING_ZEROS(high);
    const uint32_t mantissa = ((uint32_t)1 << 31) / ((high << zeros) >> 16);

    return (struct reciprocal){(int32_t)mantissa, zeros};
}

/* x over what the reciprocal is of, both in one format, Q24; |x| < 2⁴⁶. */
static int32_t share(int64_t x, const struct reciprocal *reciprocal)
{
    return jp_saturate32((x * reciprocal->mantissa) >> (39U - reciprocal->zeros));
}

/* Q30 · Q24; the result is part of a variance. */
static int32_t reduction(int32_t gain, int64_t covariance)
{
    return jp_saturate32((gain * (covariance >> 8)) >> 16);
}

/* x · share of Q24. */
static int32_t part(int32_t x, jp_q24 share_of_it)
{
    return jp_multiply_shift(x, share_of_it, 24);
}

static int32_t at_least_one(int32_t variance)
{
    return variance < 1 ? 1 : variance;
}

/* |x|, saturated. */
static int32_t distance(int32_t x)
{
    return x < 0 ? jp_sub(0, x) : x;
}

/* The part of r that is the gyro's is taken out of its turn. */
static void share_ratio(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    const int32_t change = odometry->internal.ratio - config->ratio * 64;
    const int32_t relative = jp_multiply_shift(change, odometry->internal.ratio_reciprocal, 24);
    const int32_t error =
        jp_clamp32(jp_multiply_shift(relative, odometry->internal.scale_share, 30), -SCALE_ERROR_MAX, SCALE_ERROR_MAX);
    const int32_t scale = ONE - error + jp_multiply_shift(error, error, 30);

    odometry->internal.scale_change = scale - odometry->internal.scale;
    odometry->internal.scale = scale;
    odometry->internal.bias_rate = jp_multiply_shift(odometry->internal.bias, odometry->internal.speed_per_way, 32);
    odometry->steering_ratio = jp_multiply_shift(odometry->internal.ratio, odometry->internal.scale, 36);
}

/* Of what the wheels show of the turn and of the gyro's noise, over bias_unit², Q30. */
static int64_t heading_noise(const struct jp_skid_odometry *odometry)
{
    const int64_t way = jp_multiply(odometry->internal.way_variance, odometry->internal.way);
    const int64_t turn = jp_multiply(odometry->internal.turn_variance, odometry->internal.wheel_turn);
    const int64_t counting = odometry->internal.is_moving ? odometry->internal.count_variance : 0;
    const int64_t noise =
        odometry->internal.gyro_variance + counting + (jp_absolute64(way) >> 16) + jp_absolute64(turn);

    return noise > VARIANCE_MAX ? VARIANCE_MAX : noise;
}

/* The turn by the wheels: a robot that is pushed aside skids less, so its ratio grows. */
static int32_t wheel_turn(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    const int32_t across = part(odometry->internal.across_turn, odometry->internal.across_turn);
    const int32_t ahead = part(odometry->internal.along_turn, odometry->internal.along_turn);
    const int32_t growth =
        jp_clamp32(part(jp_sub(across, ahead), config->ratio_growth), -RATIO_GROWTH_MAX, RATIO_GROWTH_MAX);

    return jp_add(odometry->internal.wheel_turn, part(odometry->internal.wheel_turn, growth));
}

/* Learns bias and ratio from what the gyro shows beside the wheels. */
static void filter_heading(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    const int32_t turn = wheel_turn(odometry, config);
    const int32_t expected =
        jp_add(odometry->internal.bias >> 8, jp_multiply_shift(turn, odometry->internal.ratio, 30));
    const int32_t surprise = jp_sub(odometry->internal.gyro_turn, expected);
    const int32_t weighted = jp_multiply_shift(turn, odometry->internal.ratio_weight, 24);
    const int32_t weight = jp_saturate_bits(weighted, WEIGHTED_BITS);
    const uint32_t growth = jp_magnitude32(turn) >> RATIO_GROWTH_SHIFT;

    odometry->internal.bias_bias = jp_clamp32(odometry->internal.bias_bias + odometry->internal.bias_growth, 1, ONE);
    odometry->internal.ratio_ratio = jp_clamp32(odometry->internal.ratio_ratio + (int32_t)growth, 1, ONE);

    const int64_t of_bias =
        odometry->internal.bias_bias + (jp_multiply(odometry->internal.bias_ratio, weight) >> 16); /* Q30 */
    const int64_t of_ratio =
        odometry->internal.bias_ratio + (jp_multiply(odometry->internal.ratio_ratio, weight) >> 16);
    const int64_t variance = of_bias + ((of_ratio * weight) >> 16) + heading_noise(odometry);
    const struct reciprocal reciprocal = reciprocal_of(within(variance, VARIANCE_MIN, 4 * VARIANCE_MAX));
    const int32_t to_bias = share(of_bias, &reciprocal);
    const int32_t to_ratio = share(of_ratio, &reciprocal);
    const int32_t step = jp_multiply_shift(surprise, odometry->internal.ratio_weight, 24); /* of r, Q16 */

    odometry->internal.bias_bias = at_least_one(jp_sub(odometry->internal.bias_bias, reduction(to_bias, of_bias)));
    odometry->internal.bias_ratio = jp_sub(odometry->internal.bias_ratio, reduction(to_bias, of_ratio));
    odometry->internal.ratio_ratio =
        at_least_one(jp_sub(odometry->internal.ratio_ratio, reduction(to_ratio, of_ratio)));
    odometry->internal.bias_change = jp_multiply_shift(surprise, to_bias, 16);
    odometry->internal.bias = jp_add(odometry->internal.bias, odometry->internal.bias_change);
    odometry->internal.ratio =
        jp_clamp32(jp_add(odometry->internal.ratio, jp_multiply_shift(step, to_ratio, 10)), RATIO_MIN, INT32_MAX);
}

/* A stand shows the bias of the pitch gyro. */
static void rest_pitch(struct jp_skid_odometry *odometry)
{
    const int64_t shown = (int64_t)odometry->internal.gyro_pitch * 256;

    odometry->internal.pitch_bias += jp_saturate32((shown - odometry->internal.pitch_bias) >> PITCH_SHARE_SHIFT);
}

static jp_q24 within_one(jp_q24 x)
{
    return jp_clamp32(x, -JP_Q24_ONE, JP_Q24_ONE);
}

/* x without the share that is forgotten, Q30. */
static int32_t faded(int32_t x, int32_t fading)
{
    return x - jp_multiply_shift(x, fading, 30);
}

/* The grades turn with the robot. Two shears keep the covariance one, however fast it turns. */
static void turn_tilt(struct jp_skid_tilt *tilt, int32_t turn)
{
    const int32_t half_way = jp_add(tilt->ahead_left, part(tilt->left_left, turn));

    tilt->ahead = jp_add(tilt->ahead, part(tilt->left, turn));
    tilt->ahead_ahead = jp_add(tilt->ahead_ahead, part(jp_add(tilt->ahead_left, half_way), turn));
    tilt->ahead_left = half_way;
    tilt->ahead_offset = jp_add(tilt->ahead_offset, part(tilt->left_offset, turn));

    const int32_t whole_way = jp_sub(tilt->ahead_left, part(tilt->ahead_ahead, turn));

    tilt->left = jp_sub(tilt->left, part(tilt->ahead, turn));
    tilt->left_left = jp_sub(tilt->left_left, part(jp_add(tilt->ahead_left, whole_way), turn));
    tilt->ahead_left = whole_way;
    tilt->left_offset = jp_sub(tilt->left_offset, part(tilt->ahead_offset, turn));
}

/* The grade to the left is forgotten as the ground goes by. */
static void fade_tilt(struct jp_skid_tilt *tilt, int32_t fading)
{
    tilt->left = faded(tilt->left, fading / 2);
    tilt->left_left = jp_add(faded(tilt->left_left, fading), fading);
    tilt->ahead_left = faded(tilt->ahead_left, fading / 2);
    tilt->left_offset = faded(tilt->left_offset, fading / 2);
    tilt->ahead_ahead = jp_add(tilt->ahead_ahead, fading >> AHEAD_FADING_SHIFT);
}

static void predict_tilt(struct jp_skid_odometry *odometry)
{
    struct jp_skid_tilt *tilt = &odometry->internal.tilt;
    const int32_t nodding = jp_sub(odometry->internal.gyro_pitch, odometry->internal.pitch_bias >> 8);
    const int64_t passed = jp_absolute64(jp_multiply(odometry->internal.way, odometry->internal.tilt_fading)) >> 16;

    turn_tilt(tilt, jp_multiply_shift(odometry->internal.turn, TWO_PI, 32));
    fade_tilt(tilt, passed > ONE ? ONE : (int32_t)passed);
    tilt->ahead = jp_sub(tilt->ahead, jp_multiply_shift(nodding, TWO_PI, 32));
}

/* Learns grades and offset from the accelerometer without the robot's own acceleration. */
static void filter_tilt(struct jp_skid_odometry *odometry)
{
    struct jp_skid_tilt *tilt = &odometry->internal.tilt;
    const int32_t change = jp_sub(odometry->internal.forward, odometry->internal.forward_before);
    const jp_q24 acceleration = jp_multiply_shift(change, odometry->internal.acceleration, 16);
    const jp_q24 expected = jp_add(jp_add(tilt->ahead, tilt->offset), acceleration);
    const jp_q24 surprise = jp_sub(odometry->internal.force, expected);
    const int32_t of_ahead = jp_add(tilt->ahead_ahead, tilt->ahead_offset);
    const int32_t of_left = jp_add(tilt->ahead_left, tilt->left_offset);
    const int32_t of_offset = jp_add(tilt->offset_offset, tilt->ahead_offset);
    const int32_t doubt = jp_multiply_shift(acceleration, odometry->internal.tilt_reciprocal, 24); /* Q15 */
    const int64_t variance =
        (int64_t)of_ahead + of_offset + odometry->internal.accel_variance + jp_multiply(doubt, doubt) / 4;
    const struct reciprocal reciprocal = reciprocal_of(within(variance, VARIANCE_MIN, VARIANCE_MAX));
    const int32_t to_ahead = share(of_ahead, &reciprocal);
    const int32_t to_left = share(of_left, &reciprocal);
    const int32_t to_offset = share(of_offset, &reciprocal);

    tilt->ahead = within_one(jp_add(tilt->ahead, part(surprise, to_ahead)));
    tilt->left = within_one(jp_add(tilt->left, part(surprise, to_left)));
    tilt->offset = within_one(jp_add(tilt->offset, part(surprise, to_offset)));
    tilt->ahead_ahead = at_least_one(jp_sub(tilt->ahead_ahead, part(of_ahead, to_ahead)));
    tilt->ahead_left = jp_sub(tilt->ahead_left, part(of_left, to_ahead));
    tilt->ahead_offset = jp_sub(tilt->ahead_offset, part(of_offset, to_ahead));
    tilt->left_left = at_least_one(jp_sub(tilt->left_left, part(of_left, to_left)));
    tilt->left_offset = jp_sub(tilt->left_offset, part(of_offset, to_left));
    tilt->offset_offset = at_least_one(jp_sub(tilt->offset_offset, part(of_offset, to_offset)));
}

/* Force of a side on the ground over the weight, g: what its motor's current leaves behind gear and rolling. */
static jp_q24 side_force(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                         jp_q16 current, int32_t counts)
{
    const jp_q24 motor = jp_multiply_shift(current, config->force_per_ampere, 16);
    const bool is_driving = (motor ^ counts) >= 0;
    const jp_q24 behind_gear = part(motor, is_driving ? config->efficiency : odometry->internal.braking);
    const jp_q24 rolling = config->rolling / 2;

    return jp_sub(behind_gear, counts < 0 ? -rolling : rolling);
}

/* What it takes to turn tells how the ground grips, and so how far the robot slips down a slope as it turns. */
static void learn_grip(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    const int32_t turn = odometry->internal.turn;
    const jp_q24 left = side_force(odometry, config, odometry->internal.current_left, odometry->internal.counts_left);
    const jp_q24 right =
        side_force(odometry, config, odometry->internal.current_right, odometry->internal.counts_right);
    const jp_q24 force = turn < 0 ? jp_sub(left, right) : jp_sub(right, left);
    const int32_t weight = jp_clamp32(distance(turn), 0, ONE / GRIP_MEMORY) * GRIP_MEMORY;
    const jp_q24 least = config->turn_force / GRIP_MAX;

    odometry->internal.turn_force += jp_multiply_shift(jp_sub(force, odometry->internal.turn_force), weight, 30);
    odometry->internal.turn_force = jp_clamp32(odometry->internal.turn_force, least, config->turn_force * 2);
    set_turn_creep(odometry, config, config->turn_force / (odometry->internal.turn_force / GRIP_ONE));
}

/* ---- Pose ---- */

/* component · way with the component in Q31 and the way in Q32 m. */
static int64_t along(jp_q31 component, int32_t way)
{
    return jp_multiply(component, way) >> 31;
}

/* m, Q32: 2π · sensitivity · change, whose formats together have `shift` bits more than Q32. */
static int64_t shifted(int64_t sensitivity, int32_t change, unsigned shift)
{
    const int64_t product = jp_multiply(jp_saturate32(sensitivity >> 8), change);

    return (jp_round_shift64(product, shift + 8U) * TWO_PI_Q16) >> 8;
}

/* What the filter has learned in this step was true before. */
static void correct_pose(struct jp_skid_odometry *odometry)
{
    const int32_t bias = odometry->internal.bias_change;
    const int32_t scale = odometry->internal.scale_change;
    const int32_t steps = (int32_t)(odometry->internal.steps >> 16);
    const int32_t turned = jp_saturate32(odometry->internal.turned >> 8);

    odometry->x += shifted(odometry->internal.bias_x, bias, 16U) + shifted(odometry->internal.scale_x, scale, 14U);
    odometry->y += shifted(odometry->internal.bias_y, bias, 16U) + shifted(odometry->internal.scale_y, scale, 14U);
    odometry->heading +=
        (jp_phase)jp_multiply(turned, scale) * 4U - (jp_phase)jp_multiply(steps, bias) * (jp_phase)JP_Q16_ONE;
}

/* The pose of the next step depends on bias and scale as the heading does. */
static void follow_sensitivity(struct jp_skid_odometry *odometry)
{
    const int32_t steps = (int32_t)(odometry->internal.steps >> 16);
    const int32_t turned = jp_saturate32(odometry->internal.turned >> 8); /* turn, Q24 */
    const int32_t x = odometry->internal.way_x;
    const int32_t y = odometry->internal.way_y;

    odometry->internal.bias_x += jp_multiply(y, steps) >> 16;
    odometry->internal.bias_y -= jp_multiply(x, steps) >> 16;
    odometry->internal.scale_x -= jp_multiply(y, turned) >> 32;
    odometry->internal.scale_y += jp_multiply(x, turned) >> 32;
    if (odometry->internal.is_moving) {
        odometry->internal.steps += JP_Q16_ONE - (odometry->internal.steps >> STEPS_FADING_SHIFT);
        odometry->internal.way_total += distance(odometry->internal.way) >> 16;
        odometry->internal.turn_total += distance(odometry->internal.turn);
    }
}

static int32_t lesser(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

/* How far the robot slips under the forces on its wheels, and what the map sees of the rest. */
static void slip(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    const struct jp_skid_tilt *tilt = &odometry->internal.tilt;
    const int32_t way = odometry->internal.way;
    const int32_t turn = odometry->internal.turn;
    const jp_q24 half_ahead = jp_multiply_shift(tilt->ahead, tilt->ahead, 25); /* p²/2 */
    const jp_q24 half_left = jp_multiply_shift(tilt->left, tilt->left, 25);
    const jp_q24 drag = way < 0 ? -config->caster_drag : config->caster_drag;
    const jp_q24 ahead = odometry->internal.force - tilt->offset + drag; /* of the wheels, so they push the caster */
    const jp_q24 centripetal = jp_multiply_shift(jp_multiply_shift(way, turn, 32), odometry->internal.centripetal, 16);
    const jp_q24 left = jp_add(tilt->left, centripetal);
    const int32_t rolled = part(distance(way), config->creep);
    const int32_t turned = distance(turn);
    const int32_t along_turn = part(odometry->internal.turn_creep_along, ahead);
    const int32_t across_turn = part(odometry->internal.turn_creep_across, left);
    const int32_t bend =
        part(part(odometry->internal.turn_force, config->creep), lesser(distance(way), odometry->internal.side_way));
    const int32_t crept = jp_add(part(rolled, ahead), part(turned, along_turn));
    const int32_t forward = jp_sub(way, jp_add(crept, way < 0 ? -bend : bend));

    odometry->internal.along_turn = along_turn;
    odometry->internal.across_turn = across_turn;
    odometry->internal.forward = forward;
    odometry->internal.sideways = jp_sub(0, jp_add(part(rolled, left), part(turned, across_turn)));
    odometry->internal.plan = jp_sub(forward, part(forward, half_ahead));
    odometry->internal.heading_turn = jp_add(turn, part(turn, half_ahead - half_left));
    odometry->speed = jp_multiply_shift(forward, odometry->internal.speed_per_way, 24);
}

static void move(struct jp_skid_odometry *odometry)
{
    const int32_t turn = odometry->internal.heading_turn;
    const int32_t plan = odometry->internal.plan;
    const int32_t sideways = odometry->internal.sideways;
    const jp_angle mean = jp_phase_angle(odometry->heading) + (jp_angle)(turn / 2);
    const jp_q31 cosine = jp_cos(mean);
    const jp_q31 sine = jp_sin(mean);

    odometry->internal.way_x = jp_saturate32(along(cosine, plan) - along(sine, sideways));
    odometry->internal.way_y = jp_saturate32(along(sine, plan) + along(cosine, sideways));
    odometry->x += odometry->internal.way_x;
    odometry->y += odometry->internal.way_y;
    odometry->heading += (jp_phase)((int64_t)turn * ((int64_t)1 << 24));
    predict_tilt(odometry);
}

/* Whether the robot slipped by turning rather than by its way, so that the motors' currents tell of the ground. */
static bool is_skidding(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    const int32_t turned = part(distance(odometry->internal.turn), odometry->internal.turn_creep_along);

    return config->turn_force >= GRIP_FORCE_MIN && turned / 2 > part(distance(odometry->internal.way), config->creep);
}

static bool stays(uint32_t counts, uint32_t anchor)
{
    return jp_is_between((int32_t)(counts - anchor), -STAND_COUNTS, STAND_COUNTS);
}

static void watch_stand(struct jp_skid_odometry *odometry, const struct jp_sensors *sensors)
{
    if (!stays(sensors->encoder_left, odometry->internal.stand_left) ||
        !stays(sensors->encoder_right, odometry->internal.stand_right)) {
        odometry->internal.stand_left = sensors->encoder_left;
        odometry->internal.stand_right = sensors->encoder_right;
        odometry->internal.stand_steps = 0;
    }
    odometry->internal.is_moving = odometry->internal.stand_steps < odometry->internal.stand_steps_min;
    if (odometry->internal.is_moving) {
        odometry->internal.stand_steps++;
    }
}

/* What the ticks added up becomes the increments of the step. */
static void take_increments(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                            const struct jp_sensors *sensors)
{
    const int32_t left = (int32_t)(sensors->encoder_left - odometry->internal.encoder_left);
    const int32_t right = (int32_t)(sensors->encoder_right - odometry->internal.encoder_right);

    odometry->internal.encoder_left = sensors->encoder_left;
    odometry->internal.encoder_right = sensors->encoder_right;
    watch_stand(odometry, sensors);
    odometry->internal.counts_left = left;
    odometry->internal.counts_right = right;
    odometry->internal.current_left = sensors->current_left;
    odometry->internal.current_right = sensors->current_right;
    odometry->internal.way = jp_round_shift(jp_multiply(jp_add(left, right), config->way_per_count), 9);
    odometry->internal.side_way = distance(jp_round_shift(jp_multiply(jp_sub(right, left), config->way_per_count), 9));
    odometry->internal.wheel_turn = jp_round_shift(jp_multiply(jp_sub(right, left), config->turn_per_count), 8);
    odometry->internal.gyro_turn = jp_round_shift((int64_t)odometry->internal.yaw_angle, 24);
    odometry->internal.gyro_pitch = jp_round_shift((int64_t)odometry->internal.pitch_angle, 24);
    odometry->internal.force = jp_multiply_shift(odometry->internal.accel_sum, odometry->internal.mean_share, 31);
    odometry->internal.yaw_angle = 0;
    odometry->internal.pitch_angle = 0;
    odometry->internal.accel_sum = 0;
}

/* Begins a step. */
static void take_step(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                      const struct jp_sensors *sensors)
{
    take_increments(odometry, config, sensors);
    odometry->internal.forward_before = odometry->internal.forward;
    if (odometry->internal.is_moving) {
        const int32_t turned = jp_sub(odometry->internal.gyro_turn, odometry->internal.bias >> 8);

        odometry->internal.turned += turned;
        odometry->internal.turn = jp_multiply_shift(turned, odometry->internal.scale, 30);
    } else {
        odometry->internal.way = 0;
        odometry->internal.side_way = 0;
        odometry->internal.wheel_turn = 0;
        odometry->internal.turn = 0;
        odometry->speed = 0;
    }
}

/* One part of the step a tick. */
static void work(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    const enum jp_skid_odometry_part part_of_step = odometry->internal.next;

    odometry->internal.next = JP_SKID_ADD_UP;
    switch (part_of_step) {
    case JP_SKID_SLIP:
        slip(odometry, config);
        odometry->internal.next = JP_SKID_MOVE;
        break;
    case JP_SKID_MOVE:
        if (odometry->internal.is_moving) {
            move(odometry);
        } else {
            rest_pitch(odometry);
        }
        odometry->internal.next = JP_SKID_FILTER_HEADING;
        break;
    case JP_SKID_FILTER_HEADING:
        filter_heading(odometry, config);
        odometry->internal.next = JP_SKID_CORRECT_POSE;
        break;
    case JP_SKID_CORRECT_POSE:
        share_ratio(odometry, config);
        correct_pose(odometry);
        follow_sensitivity(odometry);
        odometry->internal.next = JP_SKID_FILTER_TILT;
        break;
    case JP_SKID_FILTER_TILT:
        filter_tilt(odometry);
        break;
    case JP_SKID_ADD_UP:
    default:
        break;
    }
}

void jp_skid_odometry_update(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                             const struct jp_sensors *sensors)
{
    const jp_turns_per_s rate = jp_sub(sensors->yaw_rate, odometry->internal.bias_rate);

    odometry->turn_rate = jp_multiply_shift(rate, odometry->internal.scale, 30);
    odometry->internal.yaw_angle += jp_phase_step(sensors->yaw_rate, odometry->internal.phase_per_rate);
    odometry->internal.pitch_angle += jp_phase_step(sensors->pitch_rate, odometry->internal.phase_per_rate);
    odometry->internal.accel_sum += jp_saturate_bits(sensors->accel_x, ACCEL_BITS);
    odometry->internal.ticks++;
    if (odometry->internal.ticks == config->step_ticks) {
        odometry->internal.ticks = 0;
        if (is_skidding(odometry, config)) {
            learn_grip(odometry, config); /* of the step before */
        }
        take_step(odometry, config, sensors);
        odometry->internal.next = JP_SKID_SLIP;
    } else {
        work(odometry, config);
    }
}

/* ---- What is known ---- */

/* √x of Q30. */
static int32_t root(int32_t x)
{
    return (int32_t)jp_square_root((uint64_t)(uint32_t)x << 30);
}

/* Of γ: σγ² (1 − share (1 − variance of r)), Q24. */
static jp_q24 scale_deviation(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    const int32_t known = ONE - lesser(odometry->internal.ratio_ratio, ONE);
    const int32_t left = ONE - jp_multiply_shift(odometry->internal.scale_share, known, 30);

    return jp_multiply_shift(config->scale_deviation, root(left), 30);
}

/* Of b in a step, 2⁻⁴⁰ turn. */
static int32_t bias_deviation(const struct jp_skid_odometry *odometry)
{
    return jp_multiply_shift(odometry->internal.bias_unit, root(odometry->internal.bias_bias), 22);
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
static int64_t walked(jp_q24 deviation, int64_t amount)
{
    return jp_multiply(jp_multiply_shift(deviation, deviation, 24), jp_saturate32(amount)) >> 8;
}

/* The error that the way is wrong by a share, m, Q32. */
static int64_t by_way(int64_t position, jp_q24 deviation)
{
    return jp_multiply(jp_saturate32(position >> 16), deviation) >> 8;
}

static void set_pose_deviation(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                               int32_t bias, jp_q24 scale, struct jp_skid_estimate *estimate)
{
    const int32_t turns = jp_saturate32(odometry->internal.turn_total >> 16); /* Q16 */
    const int32_t radians = jp_multiply_shift(turns, TWO_PI, 24);
    const int64_t noise = walked(config->way_drift, odometry->internal.way_total) + walked(config->turn_drift, radians);

    estimate->xx = noise;
    estimate->xy = 0;
    estimate->yy = noise;
    add_error(estimate, by_way(odometry->x, config->way_deviation), by_way(odometry->y, config->way_deviation));
    add_error(estimate, shifted(odometry->internal.bias_x, bias, 16U), shifted(odometry->internal.bias_y, bias, 16U));
    add_error(estimate, shifted(odometry->internal.scale_x, scale * 64, 14U),
              shifted(odometry->internal.scale_y, scale * 64, 14U));
}

void jp_skid_odometry_estimate(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                               struct jp_skid_estimate *estimate)
{
    const int32_t bias = bias_deviation(odometry);
    const jp_q24 scale = scale_deviation(odometry, config);
    const int32_t steps = (int32_t)(odometry->internal.steps >> 16);
    const int64_t by_bias = jp_multiply(steps, bias) >> 16; /* turn, Q24; so the next */
    const int64_t by_scale = jp_multiply(jp_saturate32(odometry->internal.turned >> 8), scale) >> 24;
    const int32_t turned = jp_saturate32((int64_t)jp_square_root((uint64_t)(square(by_bias) + square(by_scale))));
    const jp_q24 ratio = jp_multiply_shift(odometry->internal.ratio_unit, root(odometry->internal.ratio_ratio), 30);
    const jp_q24 of_scale = jp_multiply_shift(scale, config->ratio, 24);

    estimate->gyro_bias = odometry->internal.bias_rate;
    estimate->gyro_bias_deviation = jp_multiply_shift(bias, odometry->internal.speed_per_way, 32);
    estimate->steering_ratio = odometry->steering_ratio;
    estimate->steering_ratio_deviation = (jp_q24)jp_square_root((uint64_t)(square(ratio) + square(of_scale)));
    estimate->slip = jp_divide((int64_t)jp_sub(odometry->internal.way, odometry->internal.forward) * JP_Q24_ONE,
                               odometry->internal.way);
    estimate->slip_deviation = config->way_deviation;
    estimate->grade_ahead = odometry->internal.tilt.ahead;
    estimate->grade_left = odometry->internal.tilt.left;
    estimate->heading_deviation = jp_multiply_shift(turned, TWO_PI, 24);
    set_pose_deviation(odometry, config, bias, scale, estimate);
}
