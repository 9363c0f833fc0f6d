#include "src/balancer/path_error.h"

#include "src/base/integer.h"

/** The robot never aims at the path more steeply than this, turn. */
#define AIM_LIMIT JP_Q24(1.0 / 32)

/** Most that its heading leads where the path bends, turn. For δ up to it, 1 − δ²/2 is cos δ within 2 %. */
#define LEAD_LIMIT JP_Q24(1.0 / 8)

/** The lead follows so many times faster than the way back to the path, which takes half a waypoint's turn. */
#define LEAD_SHARE 16

/** All of it in two ticks, 2³² by the share. */
#define LEAD_STEERING_MAX (2 * (INT32_MAX / LEAD_SHARE))

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

/** 1/rate, s/turn. */
static jp_q16 pace_of(jp_turns_per_s rate)
{
    const int32_t divisor = rate >> 10; /* Q14 */

    return divisor != 0 ? ((int32_t)1 << 30) / divisor : 0;
}

/** The rate at which the heading's lead becomes what the path turns from the set-point to where the robot is; with it
 *  the robot turns no faster than it may. */
static jp_turns_per_s lead_rate(const struct jp_path_error *error, const struct jp_trajectory_config *config,
                                jp_turns_per_s yaw_rate, jp_q24 ahead)
{
    const jp_q16 early = jp_multiply_shift(pace_of(error->cruise), ahead, 24);
    const jp_q24 lead = jp_clamp32(jp_q16_multiply(yaw_rate, early), -LEAD_LIMIT, LEAD_LIMIT);
    const int32_t share = jp_clamp32(config->steering, 0, LEAD_STEERING_MAX);
    const int64_t missing = jp_multiply(lead - turns_of(error->lead), share) >> 8; /* Q48 */
    const uint32_t pace = (uint32_t)LEAD_SHARE * config->tick_rate / JP_TICKS_PER_SET_POINT;
    const jp_turns_per_s most = config->turn_rate;
    const jp_turns_per_s spare = most - jp_absolute32(jp_clamp32(yaw_rate, -most, most));

    return jp_clamp32(jp_saturate32(missing * (int32_t)pace >> 24), -spare, spare);
}

void jp_path_error_start(struct jp_path_error *error)
{
    /* One by one: the compilers would call memset for the whole. */
    error->across = 0;
    error->along = 0;
    error->turned = 0;
    error->lead = 0;
    error->cruise = 0;
}

void jp_path_error_correct(struct jp_path_error *error, const struct jp_trajectory_config *config,
                           const struct jp_set_point *set_point, const struct jp_motion_state *motion,
                           struct jp_reference *reference)
{
    const jp_q24 across = turns_of(error->across);
    const jp_q24 ahead = jp_phase_difference(motion->wheel + error->along, reference->wheel.angle);
    const jp_q24 heading =
        jp_clamp32(jp_phase_difference(motion->yaw + error->turned, reference->yaw.angle), -LEAD_LIMIT, LEAD_LIMIT);
    const jp_q24 radians = jp_multiply_shift(heading, RADIANS_PER_TURN, 28);
    const jp_q24 bow = by_q24(jp_multiply(heading, radians) / 2);        /* (1 − cos δ)/2π */
    const jp_q24 sine = heading - by_q24(jp_multiply(bow, radians / 3)); /* sin δ/2π */
    const jp_q24 aim = jp_clamp32(by_q24(jp_multiply(config->aim, across)), -AIM_LIMIT, AIM_LIMIT);
    const jp_phase turn_back = (jp_phase)jp_multiply(config->steering, turns_of(error->turned - error->lead) + aim);
    const jp_phase roll_back = (jp_phase)jp_multiply(config->steering, turns_of(error->along));
    const jp_q24 drift = by_q24(jp_multiply(motion->wheel_rate, sine) - jp_multiply(set_point->yaw_rate, ahead));
    const jp_q24 inside = by_q24(jp_multiply(set_point->yaw_rate, across) - jp_multiply(motion->wheel_rate, bow));

    reference->yaw_lead = lead_rate(error, config, set_point->yaw_rate, ahead);

    const jp_phase lead = (jp_phase)(2 * jp_multiply(reference->yaw_lead, reference->phase_per_rate));

    error->across += step(drift, reference->phase_per_rate);
    error->along += step(inside, reference->phase_per_rate) - roll_back;
    error->lead += lead;
    error->turned += lead - turn_back;
    reference->wheel.angle -= roll_back;
    reference->yaw.angle -= turn_back;
}
