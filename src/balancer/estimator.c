#include <joulepath/estimator.h>

#include <stdbool.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"

#define TURNS_PER_RADIAN JP_Q24(0.15915494309189535)

/** A gyro with more bias than this, turn/s (18 °/s), is broken; learning stops there. */
#define GYRO_BIAS_MAX JP_Q24(0.05)

#define FIELD(member, low, high) JP_CONFIG_FIELD("estimator.", struct jp_estimator_config, member, low, high)

/** Above 0, at most a turn. */
static JP_INLINE_FOR_SPEED bool is_step(jp_phase angle)
{
    return (uint32_t)((angle - 1U) >> 56) == 0U;
}

enum jp_status jp_estimator_check(const struct jp_estimator_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(tick_rate, JP_TICK_RATE_MIN, JP_TICK_RATE_MAX),
        FIELD(tracking_gain, 1, JP_Q16_ONE),
        FIELD(tracking_rate_gain, 1, INT32_MAX),
        FIELD(tilt_gain, 0, INT32_MAX),
        FIELD(bias_gain, 0, INT32_MAX),
    };
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status != JP_OK) {
        return status;
    }
    if (!is_step(config->wheel_per_count)) {
        return jp_config_refuse("estimator.wheel_per_count", field);
    }
    if (!is_step(config->yaw_per_count)) {
        return jp_config_refuse("estimator.yaw_per_count", field);
    }
    if ((uint32_t)config->tracking_rate_gain > config->tick_rate * (uint32_t)JP_Q16_ONE) {
        return jp_config_refuse("estimator.tracking_rate_gain", field);
    }
    return JP_OK;
}

static jp_q24 turns_from_phase(int64_t phase)
{
    return jp_round_shift(phase, 32);
}

/** The phase without its full turns: ±½ turn. */
static int64_t within_half_turn(jp_phase phase)
{
    return (int64_t)(phase << 8) >> 8;
}

void jp_estimator_start(struct jp_estimator *estimator, const struct jp_estimator_config *config,
                        const struct jp_sensors *sensors)
{
    /* At rest the specific force points up: (−sin ψ, cos ψ) in the body's axes. */
    jp_phase tilt = (jp_phase)(int64_t)(int32_t)jp_atan2(jp_sub(0, sensors->accel_x), sensors->accel_z);

    *estimator = (struct jp_estimator){
        .encoder_left = sensors->encoder_left,
        .encoder_right = sensors->encoder_right,
        .pitch = tilt << 24,
        .phase_per_rate = jp_phase_per_rate(config->tick_rate),
    };
}

/** Follows a measured angle with position and rate (an alpha-beta filter). */
static inline void track(struct jp_tracking_loop *loop, const struct jp_estimator_config *config,
                         int32_t phase_per_rate, jp_phase measured)
{
    jp_phase predicted = loop->angle + jp_phase_step(loop->rate, phase_per_rate);
    int64_t error = (int64_t)(measured - predicted);
    jp_q24 error_turns = turns_from_phase(error);

    loop->angle = predicted + (jp_phase)((error >> 16) * config->tracking_gain);
    loop->rate = jp_add(loop->rate, jp_q16_multiply(error_turns, config->tracking_rate_gain));
}

/** A turn is more than a radian: nothing saturates. */
static JP_INLINE_FOR_SPEED jp_q24 turns(jp_q24 radians)
{
    return (jp_q24)((jp_multiply(radians, TURNS_PER_RADIAN) + JP_Q24_ONE / 2) >> 24);
}

/** The bias within ±GYRO_BIAS_MAX, of whose lower half all bits are 0: the upper half decides. */
static int64_t limited_bias(int64_t bias)
{
    int32_t high = (int32_t)(bias >> 32);

    return high >= GYRO_BIAS_MAX   ? (int64_t)((uint64_t)GYRO_BIAS_MAX << 32)
           : high < -GYRO_BIAS_MAX ? -(int64_t)((uint64_t)GYRO_BIAS_MAX << 32)
                                   : bias;
}

/** Draws pitch toward the accelerometer's vertical and learns the gyro's bias on the way. */
static void level(struct jp_estimator *estimator, const struct jp_estimator_config *config,
                  const struct jp_sensors *sensors)
{
    jp_angle pitch = jp_phase_angle(estimator->pitch);
    jp_q31 sine = jp_sin(pitch);
    jp_q31 cosine = jp_cos(pitch);

    /* sin(ψ_accel − ψ) in g: the part of gravity across the believed vertical; in turns it is /(2π). */
    int64_t across = -(jp_multiply(sensors->accel_x, cosine) + jp_multiply(sensors->accel_z, sine));
    jp_q24 tilt_error = turns(jp_round_shift(across, 31));

    estimator->pitch += (jp_phase)(jp_multiply(tilt_error, config->tilt_gain) * 2);

    estimator->gyro_bias = limited_bias(estimator->gyro_bias - jp_multiply(tilt_error, config->bias_gain) * 2);
}

static JP_INLINE_FOR_SPEED void count(struct jp_estimator *estimator, const struct jp_estimator_config *config,
                                      const struct jp_sensors *sensors)
{
    /* Wrapping differences as signed counts. */
    int64_t left = (int32_t)(sensors->encoder_left - estimator->encoder_left);
    int64_t right = (int32_t)(sensors->encoder_right - estimator->encoder_right);

    estimator->encoder_left = sensors->encoder_left;
    estimator->encoder_right = sensors->encoder_right;
    estimator->wheel_encoder += (jp_phase)(left + right) * config->wheel_per_count;
    estimator->yaw_encoder += (jp_phase)(right - left) * config->yaw_per_count;
}

/** All but the counts. */
static void follow(struct jp_estimator *estimator, const struct jp_estimator_config *config,
                   const struct jp_sensors *sensors, struct jp_motion_state *state)
{
    track(&estimator->wheel, config, estimator->phase_per_rate, estimator->wheel_encoder);
    track(&estimator->yaw, config, estimator->phase_per_rate, estimator->yaw_encoder);

    jp_q24 pitch_rate = jp_sub(sensors->pitch_rate, turns_from_phase(estimator->gyro_bias));

    estimator->pitch += jp_phase_step(pitch_rate, estimator->phase_per_rate);
    level(estimator, config, sensors);

    state->pitch = turns_from_phase(within_half_turn(estimator->pitch));
    state->pitch_rate = pitch_rate;
    state->wheel = estimator->wheel.angle + estimator->pitch;
    state->wheel_rate = jp_add(estimator->wheel.rate, pitch_rate);
    state->yaw = estimator->yaw.angle;
    state->yaw_rate = estimator->yaw.rate;
}

void jp_estimator_resume(struct jp_estimator *estimator, const struct jp_estimator_config *config,
                         const struct jp_sensors *sensors, struct jp_motion_state *state)
{
    jp_phase wheel = estimator->wheel_encoder;
    jp_phase yaw = estimator->yaw_encoder;

    /* The loops jump with the counts and keep their rates. */
    count(estimator, config, sensors);
    estimator->wheel.angle += estimator->wheel_encoder - wheel;
    estimator->yaw.angle += estimator->yaw_encoder - yaw;
    follow(estimator, config, sensors, state);
}

void jp_estimator_update(struct jp_estimator *estimator, const struct jp_estimator_config *config,
                         const struct jp_sensors *sensors, struct jp_motion_state *state)
{
    count(estimator, config, sensors);
    follow(estimator, config, sensors, state);
}
