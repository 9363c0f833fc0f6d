#include <joulepath/reference.h>

#include <stdbool.h>

#include "src/base/config_check.h"

#define TURNS_PER_RADIAN JP_Q24(0.15915494309189535)

/** 1000 s of the fastest ticks. */
#define REST_TICKS_MAX 10000000

#define FIELD(member, low, high) JP_CONFIG_FIELD("reference.", struct jp_reference_config, member, low, high)

/** Beyond a quarter of the tick rate the tracker's steps would overshoot. */
static bool bandwidth_is_valid(jp_q16 bandwidth, uint32_t tick_rate)
{
    return bandwidth == 0 ||
           (bandwidth >= JP_Q16(0.016) && (uint32_t)bandwidth <= tick_rate * ((uint32_t)JP_Q16_ONE / 4U));
}

enum jp_status jp_reference_check(const struct jp_reference_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(tick_rate, JP_TICK_RATE_MIN, JP_TICK_RATE_MAX),
        FIELD(turns_per_metre, JP_Q24(0.1), JP_Q24(16)),
        FIELD(travel_bandwidth, 0, JP_Q16(100)),
        FIELD(yaw_bandwidth, 0, JP_Q16(100)),
        FIELD(rest_ticks, 0, REST_TICKS_MAX),
    };
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status != JP_OK) {
        return status;
    }
    if (!bandwidth_is_valid(config->travel_bandwidth, config->tick_rate)) {
        return jp_config_refuse("reference.travel_bandwidth", field);
    }
    if (!bandwidth_is_valid(config->yaw_bandwidth, config->tick_rate)) {
        return jp_config_refuse("reference.yaw_bandwidth", field);
    }
    return JP_OK;
}

void jp_reference_leave_track(struct jp_reference *reference)
{
    reference->pitch = 0;
    reference->pitch_rate = 0;
    reference->yaw_lead = 0;
    reference->common = 0;
    reference->difference = 0;
}

void jp_reference_start(struct jp_reference *reference, const struct jp_reference_config *config, jp_phase wheel,
                        jp_phase yaw)
{
    *reference = (struct jp_reference){
        .wheel = {.target = wheel, .angle = wheel},
        .yaw = {.target = yaw, .angle = yaw},
        .phase_per_rate = jp_phase_per_rate(config->tick_rate),
    };
}

static void coast(struct jp_reference_axis *axis, jp_q16 bandwidth, jp_q24 rate)
{
    if (bandwidth != 0) {
        axis->rate = rate;
    }
}

void jp_reference_coast(struct jp_reference *reference, const struct jp_reference_config *config, jp_q24 wheel_rate,
                        jp_q24 yaw_rate)
{
    coast(&reference->wheel, config->travel_bandwidth, wheel_rate);
    coast(&reference->yaw, config->yaw_bandwidth, yaw_rate);
}

struct jp_reference_step jp_reference_step_to(const struct jp_reference_config *config, const struct jp_motion *motion,
                                              jp_q24 turn)
{
    return (struct jp_reference_step){
        .wheel_rate = jp_q24_multiply(motion->speed, config->turns_per_metre),
        .yaw_rate = jp_q24_multiply(motion->turn_rate, TURNS_PER_RADIAN),
        .turn = jp_q24_multiply(turn, TURNS_PER_RADIAN),
    };
}

void jp_reference_apply(struct jp_reference *reference, const struct jp_reference_step *step)
{
    const bool turns_round =
        reference->rest_left > 0U && step->wheel_rate != 0 && (step->wheel_rate > 0) != reference->forward;

    reference->wheel.target_rate = turns_round ? 0 : step->wheel_rate;
    reference->waiting_rate = turns_round ? step->wheel_rate : 0;
    reference->yaw.target_rate = step->yaw_rate;
    reference->yaw.target += (jp_phase)step->turn << 32;
}

/** Acceleration of the critically damped tracker, turn/s². */
static inline jp_q24 tracker_acceleration(const struct jp_reference_axis *axis, jp_q16 bandwidth)
{
    jp_q24 angle_error = jp_phase_difference(axis->target, axis->angle);
    jp_q24 rate_error = jp_sub(axis->target_rate, axis->rate);
    jp_q24 pull = jp_add(jp_q16_multiply(angle_error, bandwidth), jp_add(rate_error, rate_error));

    return jp_q16_multiply(pull, bandwidth);
}

static void follow(struct jp_reference_axis *axis, jp_q16 bandwidth, int32_t phase_per_rate)
{
    axis->target += jp_phase_step(axis->target_rate, phase_per_rate);

    /* 2³²/tick_rate is also the tick's length in 2⁻³² s. */
    jp_q24 rate = jp_add(axis->rate, jp_multiply_shift(tracker_acceleration(axis, bandwidth), phase_per_rate, 32));

    axis->rate = rate;
    axis->angle += jp_phase_step(rate, phase_per_rate);
}

static void pass_through(struct jp_reference_axis *axis, int32_t phase_per_rate)
{
    axis->target += jp_phase_step(axis->target_rate, phase_per_rate);
    axis->angle = axis->target;
    axis->rate = axis->target_rate;
}

static void advance(struct jp_reference_axis *axis, jp_q16 bandwidth, int32_t phase_per_rate)
{
    if (bandwidth == 0) {
        pass_through(axis, phase_per_rate);
    } else {
        follow(axis, bandwidth, phase_per_rate);
    }
}

/** Counts the rest between two directions. */
static void rest(struct jp_reference *reference, uint32_t rest_ticks)
{
    if (reference->wheel.target_rate == 0 && reference->rest_left > 0U) {
        reference->rest_left--;
        if (reference->rest_left == 0U) {
            reference->wheel.target_rate = reference->waiting_rate;
        }
    }
    if (reference->wheel.target_rate != 0) {
        reference->forward = reference->wheel.target_rate > 0;
        reference->rest_left = rest_ticks;
    }
}

void jp_reference_update(struct jp_reference *reference, const struct jp_reference_config *config)
{
    rest(reference, config->rest_ticks);
    advance(&reference->wheel, config->travel_bandwidth, reference->phase_per_rate);
    advance(&reference->yaw, config->yaw_bandwidth, reference->phase_per_rate);
}

/** By the mean rate of the tick. */
static void track(struct jp_reference_axis *axis, jp_turns_per_s rate, int32_t phase_per_rate)
{
    axis->angle += (jp_phase)((jp_multiply(axis->rate, phase_per_rate) + jp_multiply(rate, phase_per_rate)) >> 1);
    axis->rate = rate;
    axis->target = axis->angle;
    axis->target_rate = rate;
}

void jp_reference_track(struct jp_reference *reference, const struct jp_set_point *set_point)
{
    track(&reference->wheel, set_point->wheel_rate, reference->phase_per_rate);
    track(&reference->yaw, jp_add(set_point->yaw_rate, reference->yaw_lead), reference->phase_per_rate);
    reference->pitch = set_point->pitch;
    reference->pitch_rate = set_point->pitch_rate;
    reference->common = set_point->common;
    reference->difference = set_point->difference;
}
