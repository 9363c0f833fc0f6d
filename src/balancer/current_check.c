#include <joulepath/current_check.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/integer.h"
#include "src/base/multiply_q32.h"

#define GAIN_MAX JP_Q16(4)

/** (0.001 A)² in Q32: no sensor is that good for long. */
#define VARIANCE_MIN ((int64_t)4295)

/** Share of the memory: samples until there is an estimate, and that a statement must hold for. */
#define SETTLING_SHARE 4U

/** Share of the memory: samples of the short mean, whose standard deviation is at most so many times the offset's. */
#define SHORT_SHARE      16U
#define SHORT_DEVIATIONS 3

/** Samples lie on one line, but for chance, when their variance about it is at most so many halves of their noise's; of
 *  what is beyond, this share is taken for an error of the line. */
#define FIT_HALVES 3
#define BENT_SHARE 4

/** They are of before and after a change when it is so many times the noise's and beyond this share of `offset`. */
#define MISFIT       4
#define MISFIT_SHARE 4

/** They may be when what noise does not explain is beyond this share of `offset`. */
#define BEND_SHARE 8

#define FIELD(member, low, high) JP_CONFIG_FIELD("current_check.", struct jp_current_check_config, member, low, high)

enum jp_status jp_current_check_check(const struct jp_current_check_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(offset, JP_Q16(0.005), JP_Q16(10)),
        FIELD(gain, JP_Q16(0.01), JP_Q16(0.5)),
        FIELD(resistance, 0, JP_Q16(0.5)),
        FIELD(excitation, JP_Q16(0.02), JP_Q16(10)),
        FIELD(memory, 128, 4096),
    };
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status == JP_OK && config->resistance < config->gain) {
        return jp_config_refuse("current_check.resistance", field);
    }
    return status;
}

void jp_current_check_start(struct jp_current_check *check, const struct jp_current_check_config *config,
                            const struct jp_monitor_config *motors)
{
    static const struct jp_current_motor unknown = {
        .estimate = {.offset_deviation = INT32_MAX, .gain = JP_Q16_ONE, .gain_deviation = JP_CURRENT_DEVIATION_MAX},
    };

    *check = (struct jp_current_check){.config = config, .motors = motors, .left = unknown, .right = unknown};
}

/** (u − kb ω)/Rm, saturated. */
static jp_q16 expected_current(const struct jp_monitor_config *motors, jp_q16 voltage, jp_q24 rate)
{
    const jp_q16 back_emf = jp_multiply_shift(rate, motors->back_emf, 24);

    return jp_q16_divide(jp_sub(voltage, back_emf), motors->motor_resistance);
}

static bool can_be_compared(jp_q16 current)
{
    return jp_is_between(current, -JP_CURRENT_CHECK_MAX, JP_CURRENT_CHECK_MAX);
}

/* Recursive least squares with forgetting, as weighted moments. */

/** Moves a mean towards a value; returns how far the value was from it. */
static int32_t follow(int32_t *mean, int32_t value, uint32_t weight)
{
    const int32_t difference = value - *mean;

    *mean += (int32_t)multiply_q32(difference, weight);
    return difference;
}

static void add(struct jp_current_moments *moments, jp_q16 expected, jp_q16 measured, uint16_t memory)
{
    const int32_t x = expected * 256;
    const int32_t y = measured * 256;

    if (moments->count < memory) {
        moments->count++;
    }

    const uint32_t weight = UINT32_MAX / moments->count;
    const int32_t x_before = follow(&moments->mean_expected, x, weight);
    const int32_t y_before = follow(&moments->mean_measured, y, weight);
    const int32_t x_after = x - moments->mean_expected;
    const int32_t y_after = y - moments->mean_measured;

    moments->expected += multiply_q32(jp_multiply(x_before, x_after) - moments->expected, weight);
    moments->product += multiply_q32(jp_multiply(x_before, y_after) - moments->product, weight);
    moments->measured += multiply_q32(jp_multiply(y_before, y_after) - moments->measured, weight);
}

/** Of what is measured about offset + gain · expected, A² in Q32. */
static int64_t residual_variance(const struct jp_current_moments *moments, jp_q16 gain)
{
    const int64_t product = moments->product >> 16;
    const int64_t explained = (gain * (2 * product - ((gain * (moments->expected >> 16)) >> 16))) >> 16;
    const int64_t variance = (moments->measured >> 16) - explained;

    return variance > VARIANCE_MIN ? variance : VARIANCE_MIN;
}

static jp_q16 fitted_gain(const struct jp_current_moments *moments)
{
    return jp_clamp32(jp_saturate32(moments->product / (moments->expected >> 16)), -GAIN_MAX, GAIN_MAX);
}

/** What noise does not explain of a variance about a line; at least 0. */
static int64_t bend(int64_t variance, int64_t noise)
{
    const int64_t bent = variance - noise * FIT_HALVES / 2;

    return bent > 0 ? bent : 0;
}

/** Of the line at the mean: noise averages out; what the samples are away from any line does not. */
static int64_t mean_variance(int64_t variance, int64_t noise, int64_t count)
{
    return variance / count + bend(variance, noise) / BENT_SHARE;
}

/** The standard deviation of a gain that was fitted. */
static jp_q16 gain_deviation(const struct jp_current_moments *moments, int64_t of_mean)
{
    const int64_t height = (int64_t)jp_square_root((uint64_t)of_mean) << 16;
    const int32_t width = (int32_t)jp_square_root((uint64_t)(moments->expected >> 16));

    return jp_clamp32(jp_divide(height, width), 0, GAIN_MAX);
}

/** Unless the expected current varied the gain stays what it is and is known ever less. Returns the variance about the
 *  line, A² in Q32. */
static int64_t update_estimate(struct jp_current_estimate *estimate, const struct jp_current_motor *motor,
                               const struct jp_current_check_config *config)
{
    const struct jp_current_moments *moments = &motor->moments;
    const bool excited = moments->expected >> 16 >= jp_multiply(config->excitation, config->excitation);

    if (excited) {
        estimate->gain = fitted_gain(moments);
    }

    const int64_t variance = residual_variance(moments, estimate->gain);
    const int64_t of_mean = mean_variance(variance, motor->noise, moments->count);

    if (excited) {
        estimate->gain_deviation = gain_deviation(moments, of_mean);
    } else {
        (void)follow(&estimate->gain_deviation, JP_CURRENT_DEVIATION_MAX, UINT32_MAX / config->memory);
    }

    /* An error of the gain turns the line about the mean. */
    const int64_t turned = jp_multiply_shift(moments->mean_expected, estimate->gain_deviation, 24);
    const int64_t measured = (int64_t)moments->mean_measured * JP_Q16_ONE;

    estimate->offset = jp_round_shift(measured - jp_multiply(estimate->gain, moments->mean_expected), 24);
    estimate->offset_deviation = (jp_q16)jp_square_root((uint64_t)(of_mean + turned * turned));
    return variance;
}

/* Statements. */

enum verdict { UNDECIDED, WITHIN, BEYOND };

static JP_INLINE_FOR_SPEED enum verdict compare(int32_t value, int32_t deviation, int32_t limit)
{
    const int64_t magnitude = value < 0 ? -(int64_t)value : value;
    const int64_t margin = (int64_t)deviation * JP_CURRENT_DEVIATIONS;

    if (magnitude - margin > limit) {
        return BEYOND;
    }
    return magnitude + margin < limit ? WITHIN : UNDECIDED;
}

/** It begins to hold and ends after `wait` verdicts in a row. */
static void judge(struct jp_current_statement *statement, enum verdict verdict, uint16_t wait)
{
    const enum verdict contrary = statement->holds ? WITHIN : BEYOND;

    statement->samples = verdict == contrary ? (uint16_t)(statement->samples + 1U) : 0U;
    if (statement->samples >= wait) {
        statement->holds = !statement->holds;
        statement->samples = 0;
    }
}

static void judge_motor(struct jp_current_motor *motor, const struct jp_current_check_config *config, uint16_t wait)
{
    const struct jp_current_estimate *estimate = &motor->estimate;
    const enum verdict offset = compare(estimate->offset, estimate->offset_deviation, config->offset);

    judge(&motor->offset, offset, wait);
    judge(&motor->gain, compare(estimate->gain - JP_Q16_ONE, estimate->gain_deviation, config->gain), wait);
    if (offset != UNDECIDED) {
        motor->changed = false;
    }
}

/* One motor. */

/** Twice the noise is what differs from sample to sample; offset and speed do not. */
static void update_noise(struct jp_current_motor *motor, jp_q16 expected, jp_q16 measured, uint16_t memory)
{
    const int64_t rise = jp_multiply(motor->estimate.gain, expected - motor->last_expected) >> 16;
    const int64_t difference = measured - motor->last_measured - rise;

    if (motor->samples < memory) {
        motor->samples++;
    }
    motor->noise += multiply_q32(difference * difference / 2 - motor->noise, UINT32_MAX / motor->samples);
    motor->last_expected = expected;
    motor->last_measured = measured;
}

/** (offset/share)², A² in Q32. */
static int64_t square_of_share(jp_q16 offset, jp_q16 share)
{
    return jp_multiply(offset / share, offset / share);
}

/** Takes one more difference between what is measured and what is estimated, once something is. True: it has for a
 * short while been too large for chance. */
static bool watch_difference(struct jp_current_motor *motor, const struct jp_current_check_config *config,
                             jp_q16 expected, jp_q16 measured)
{
    const struct jp_current_estimate *estimate = &motor->estimate;

    if (estimate->offset_deviation == INT32_MAX) {
        return false;
    }

    const int64_t of_gain = jp_multiply_shift(expected, estimate->gain_deviation, 16);
    const int64_t of_mean = (int64_t)estimate->offset_deviation * SHORT_DEVIATIONS;
    const int64_t margin = ((of_gain < 0 ? -of_gain : of_gain) + of_mean) * JP_CURRENT_DEVIATIONS;
    const int64_t limit = (config->offset / 2 + margin) * 256;
    const int64_t estimated = (int64_t)estimate->offset * 256 + (jp_multiply(estimate->gain, expected) >> 8);
    const int64_t difference = jp_saturate32((int64_t)measured * 256 - estimated);

    motor->parted += (int32_t)multiply_q32(difference - motor->parted, UINT32_MAX / (config->memory / SHORT_SHARE));
    return motor->parted > limit || motor->parted < -limit;
}

/** It may have been offset or gain that changed. */
static void forget(struct jp_current_motor *motor)
{
    motor->moments = (struct jp_current_moments){.count = 0};
    motor->parted = 0;
    motor->estimate.offset_deviation = INT32_MAX;
    motor->estimate.gain_deviation = JP_CURRENT_DEVIATION_MAX;
    motor->offset.samples = 0;
    motor->gain.samples = 0;
    motor->changed = true;
}

/** When there are enough samples for it. */
static void examine(struct jp_current_motor *motor, const struct jp_current_check_config *config, jp_q16 expected,
                    jp_q16 measured)
{
    struct jp_current_estimate estimate = motor->estimate;
    const int64_t variance = update_estimate(&estimate, motor, config);
    const bool parted = watch_difference(motor, config, expected, measured);

    if (parted || variance > square_of_share(config->offset, MISFIT_SHARE) + MISFIT * motor->noise) {
        forget(motor);
    } else {
        motor->estimate = estimate;
        motor->bent = bend(variance, motor->noise) > square_of_share(config->offset, BEND_SHARE);
        judge_motor(motor, config, config->memory / SETTLING_SHARE);
    }
}

static void update_motor(struct jp_current_motor *motor, const struct jp_current_check_config *config, jp_q16 expected,
                         jp_q16 measured)
{
    if (can_be_compared(expected) && can_be_compared(measured)) {
        update_noise(motor, expected, measured, config->memory);
        add(&motor->moments, expected, measured, config->memory);
        if (motor->moments.count >= config->memory / SETTLING_SHARE) {
            examine(motor, config, expected, measured);
        }
    }
}

/* Both. */

/** Whether gains are what motors that are warm or cold alike would show. */
static enum jp_current_blame blame_of(const struct jp_current_check *check)
{
    const struct jp_current_check_config *config = check->config;
    const struct jp_current_estimate *left = &check->left.estimate;
    const struct jp_current_estimate *right = &check->right.estimate;
    const jp_q16 deviation = (left->gain_deviation + right->gain_deviation) / 4 * 3; /* above the root of squares */
    const enum verdict difference = compare(left->gain - right->gain, deviation, config->gain);
    const enum verdict both = compare((left->gain + right->gain) / 2 - JP_Q16_ONE, deviation, config->resistance);

    if (difference == BEYOND || both == BEYOND) {
        return JP_CURRENT_SENSOR;
    }
    return difference == WITHIN && both == WITHIN ? JP_CURRENT_MOTORS : JP_CURRENT_NOBODY;
}

/** Only while a gain is off. A sensor's gain passes through what resistance could be while it is forgotten. */
static void judge_gains(struct jp_current_check *check)
{
    const uint16_t memory = check->config->memory;
    const uint16_t wait = check->blame == JP_CURRENT_SENSOR ? 2U * memory : memory / SETTLING_SHARE;
    const enum jp_current_blame found = blame_of(check);

    if (!check->left.gain.holds && !check->right.gain.holds) {
        check->blame = JP_CURRENT_NOBODY;
        check->blame_samples = 0;
    } else if (found == JP_CURRENT_NOBODY || found == check->blame) {
        check->blame_samples = 0;
    } else {
        check->blame_samples++;
    }
    if (check->blame_samples >= wait) {
        check->blame = found;
        check->blame_samples = 0;
    }
}

static bool is_changing(const struct jp_current_motor *motor)
{
    return motor->changed || motor->bent || motor->offset.samples != 0U || motor->gain.samples != 0U;
}

static unsigned bit(bool condition, enum jp_current_finding finding)
{
    return condition ? (unsigned)finding : 0U;
}

static uint8_t findings(const struct jp_current_check *check)
{
    const bool left = check->left.gain.holds;
    const bool right = check->right.gain.holds;
    const bool sensor = check->blame == JP_CURRENT_SENSOR;
    const bool unknown = (left || right) && check->blame == JP_CURRENT_NOBODY;

    return (uint8_t)(bit(check->left.offset.holds, JP_CURRENT_OFFSET_LEFT) |
                     bit(check->right.offset.holds, JP_CURRENT_OFFSET_RIGHT) |
                     bit(left && sensor, JP_CURRENT_GAIN_LEFT) | bit(right && sensor, JP_CURRENT_GAIN_RIGHT) |
                     bit(check->blame == JP_CURRENT_MOTORS, JP_CURRENT_RESISTANCE) |
                     bit(unknown || is_changing(&check->left) || is_changing(&check->right), JP_CURRENT_CHANGING));
}

uint8_t jp_current_check_update(struct jp_current_check *check, const struct jp_motor_sample *sample)
{
    const struct jp_monitor_config *motors = check->motors;
    const jp_q24 turning = jp_q16_multiply(sample->yaw_rate, motors->half_track);
    const jp_q16 left = expected_current(motors, sample->voltages.left, jp_sub(sample->wheel_rate, turning));
    const jp_q16 right = expected_current(motors, sample->voltages.right, jp_add(sample->wheel_rate, turning));

    update_motor(&check->left, check->config, left, sample->current_left);
    update_motor(&check->right, check->config, right, sample->current_right);
    judge_gains(check);
    return findings(check);
}
