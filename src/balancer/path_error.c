#include "src/balancer/path_error.h"

/** The robot never aims at the path more steeply than this, turn. */
#define AIM_LIMIT JP_Q24(1.0 / 32)

/** 2π in Q28. */
#define RADIANS_PER_TURN 1686629713

/** Of a phase about zero, in turn. */
static inline jp_q24 turns_of(jp_phase phase)
{
    return jp_phase_difference(phase, 0);
}

/** A sum of products of Q24 in Q24. */
static inline jp_q24 by_q24(int64_t sum)
{
    return jp_saturate32(sum >> 24);
}

/** What two ticks add at this rate, in radians a second by those of a turn. */
static inline jp_phase step(jp_q24 rate, int32_t phase_per_rate)
{
    return (jp_phase)jp_multiply(rate, jp_multiply_shift(phase_per_rate, RADIANS_PER_TURN, 27));
}

void jp_path_error_start(struct jp_path_error *error)
{
    *error = (struct jp_path_error){0, 0, 0};
}

void jp_path_error_correct(struct jp_path_error *error, const struct jp_trajectory_config *config,
                           const struct jp_set_point *set_point, const struct jp_motion_state *motion,
                           struct jp_reference *reference)
{
    const jp_q24 across = turns_of(error->across);
    const jp_q24 ahead = jp_phase_difference(motion->wheel + error->along, reference->wheel.angle);
    const jp_q24 heading = jp_phase_difference(motion->yaw + error->turned, reference->yaw.angle);
    const jp_q24 aim = jp_clamp32(by_q24(jp_multiply(config->aim, across)), -AIM_LIMIT, AIM_LIMIT);
    const jp_phase turn_back = (jp_phase)jp_multiply(config->steering, turns_of(error->turned) + aim);
    const jp_phase roll_back = (jp_phase)jp_multiply(config->steering, turns_of(error->along));
    const jp_q24 drift = by_q24(jp_multiply(motion->wheel_rate, heading) - jp_multiply(set_point->yaw_rate, ahead));
    const jp_q24 lead = by_q24(jp_multiply(set_point->yaw_rate, across));

    error->across += step(drift, reference->phase_per_rate);
    error->along += step(lead, reference->phase_per_rate) - roll_back;
    error->turned -= turn_back;
    reference->wheel.angle -= roll_back;
    reference->yaw.angle -= turn_back;
}
