#include "src/skid_steer/skid_slip.h"
#include "src/base/compiler.h"

#include "src/skid_steer/skid_arithmetic.h"

/* Of the force that a turn takes: 1/e after 1/3 rad; ground that grips less than the file's by 8 at most. */
#define GRIP_ONE       4096
#define GRIP_MEMORY    5
#define GRIP_MAX       8
#define GRIP_FORCE_MIN JP_Q24(0.05)

/* Turns so tight that what the treads roll hardly changes the force: the turn's creep along is 8 times that of the way.
 */
#define GRIP_TURN_SHIFT 3U

/* The slip of a turn holds what rolls across, up to a way of a quarter of its creep along over the way's by the radian.
 */
#define HOLD_SHIFT 2U

/* What the steering ratio grows by at most. */
#define RATIO_GROWTH_MAX JP_Q24(0.25)

/* What pushes it aside changes the ratio more surely than what pushes it along, by 8. */
#define ACROSS_SURER 8

static void set_creep(struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config)
{
    const int32_t per_turn = jp_multiply_shift(JP_SKID_TWO_PI, slip->looseness, 12); /* Q24 */

    slip->creep_along = jp_skid_part(config->turn_creep_along, per_turn);
    slip->creep_across = jp_skid_part(config->turn_creep_across, per_turn);
}

void jp_skid_slip_start(struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config, int32_t acceleration)
{
    *slip = (struct jp_skid_slip){
        .turn_force = config->turn_force,
        .looseness = GRIP_ONE,
        .shift_along = jp_skid_part(config->turn_shift_along, JP_SKID_TWO_PI),
        .shift_across = jp_skid_part(config->turn_shift_across, JP_SKID_TWO_PI),
        .most = jp_skid_part(config->turn_slide_most, JP_SKID_TWO_PI),
        .held = jp_skid_part(config->turn_creep_along, JP_SKID_TWO_PI) >> HOLD_SHIFT,
        .centripetal = jp_skid_part(acceleration, JP_SKID_TWO_PI),
        .braking = jp_divide((int64_t)1 << 48, config->efficiency),
    };
    slip->per_most = slip->most > 0 ? jp_saturate32(((int64_t)1 << 40) / slip->most) : INT32_MAX;
    set_creep(slip, config);
}

/* (1 + x⁴)^(-1/4) of x in steps of a quarter, Q15. */
#define SHARES     16U
#define SHARE_BITS 15U
#define X_BITS     10U

/* Of what treads would creep across in proportion to their load, the share that they do: x is that over the most. The
 * axle that slips less holds the more. The force that turns the robot falls by as much. */
static int32_t yielding_share(const struct jp_skid_slip *slip, int32_t across)
{
    static const uint16_t yielding_shares[SHARES] = {32768, 32736, 32275, 30592, 27554, 24058, 20883, 18256,
                                                     16138, 14425, 13025, 11864, 10889, 10060, 9347,  8727};
    const uint32_t x = (uint32_t)jp_multiply_shift(jp_skid_size(across), slip->per_most, 28); /* Q12 */
    const uint32_t i = x >> X_BITS;

    if (i >= SHARES - 1U) {
        return yielding_shares[SHARES - 1U];
    }
    const uint32_t fall = (uint32_t)yielding_shares[i] - yielding_shares[i + 1U];

    return (int32_t)(yielding_shares[i] - ((fall * (x - (i << X_BITS))) >> X_BITS));
}

void jp_skid_slip_move(struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config,
                       const struct jp_skid_tilt *tilt, struct jp_skid_step *step)
{
    const int32_t way = step->way;
    const int32_t turned = jp_skid_size(step->turn);
    const int32_t rolled = jp_share(jp_skid_size(way), config->creep, 24);
    const jp_q24 drag = way < 0 ? -config->caster_drag : config->caster_drag;
    const jp_q24 ahead =
        step->force - tilt->state[JP_SKID_TILT_OFFSET] + drag; /* of the wheels: they push the caster */
    const jp_q24 centripetal = jp_multiply_shift(jp_multiply_shift(way, step->turn, 32), slip->centripetal, 16);
    const jp_q24 left = jp_add(tilt->state[JP_SKID_TILT_LEFT], centripetal);
    const int32_t bend =
        jp_skid_part(jp_share(slip->turn_force, config->creep, 24), jp_skid_lesser(jp_skid_size(way), step->side_way));

    const int32_t pushed_ahead = jp_skid_part(step->turn, jp_skid_part(slip->shift_along, left));
    const int32_t pushed_left = jp_skid_part(slip->shift_across, ahead);
    const int32_t crept_right = jp_skid_part(slip->creep_across, left);
    const int32_t turned_left = jp_sub(step->turn < 0 ? jp_sub(0, pushed_left) : pushed_left, crept_right);

    slip->yielding = yielding_share(slip, turned_left);
    slip->wanted = turned_left;
    slip->along = jp_share(jp_skid_part(slip->creep_along, ahead), slip->yielding, SHARE_BITS);
    slip->across = jp_clamp32(jp_share(turned_left, slip->yielding, SHARE_BITS), -slip->most, slip->most);
    const int32_t crept = jp_add(jp_skid_part(rolled, ahead), jp_skid_part(turned, slip->along));
    const int32_t held = jp_skid_part(turned, slip->held);
    const int32_t rolled_aside = rolled > held ? rolled - held : 0;

    step->forward_before = step->forward;
    step->forward =
        jp_sub(jp_add(way, jp_share(pushed_ahead, slip->yielding, SHARE_BITS)), jp_add(crept, way < 0 ? -bend : bend));
    step->sideways = jp_sub(jp_skid_part(turned, slip->across), jp_skid_part(rolled_aside, left));
}

void jp_skid_slip_push(const struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config,
                       struct jp_skid_step *step)
{
    const int32_t across = jp_skid_part(jp_skid_part(slip->wanted, slip->wanted), config->ratio_growth);
    const int32_t along = jp_skid_part(jp_skid_part(slip->along, slip->along), config->ratio_growth);
    const jp_q24 growth = jp_clamp32(jp_sub(across, along), -RATIO_GROWTH_MAX, RATIO_GROWTH_MAX);

    step->pushed = jp_add(across / ACROSS_SURER, along);
    step->pushed_turn = jp_add(step->wheel_turn, jp_share(step->wheel_turn, growth, 24));
}

/* Of a side on the ground over the weight, g: what its motor's current leaves behind gear and rolling. */
static JP_INLINE_FOR_SPEED jp_q24 side_force(const struct jp_skid_slip *slip,
                                             const struct jp_skid_odometry_config *config,
                                             const struct jp_skid_step *step, unsigned side)
{
    const int32_t counts = step->counts[side];
    const jp_q24 motor = jp_multiply_shift(step->current[side], config->force_per_ampere, 16);
    const bool is_driving = (motor ^ counts) >= 0;
    const jp_q24 behind_gear = jp_skid_part(motor, is_driving ? config->efficiency : slip->braking);
    const jp_q24 rolling = config->rolling / 2;

    return jp_sub(behind_gear, counts < 0 ? -rolling : rolling);
}

static bool is_skidding(const struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config,
                        const struct jp_skid_step *step)
{
    const int32_t turned = jp_skid_part(jp_skid_size(step->turn), slip->creep_along);

    return config->turn_force >= GRIP_FORCE_MIN &&
           turned >> GRIP_TURN_SHIFT > jp_share(jp_skid_size(step->way), config->creep, 24);
}

/* From the force that it takes to turn the robot. */
static void learn_grip(struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config,
                       const struct jp_skid_step *step)
{
    const jp_q24 left = side_force(slip, config, step, (unsigned)JP_SKID_LEFT);
    const jp_q24 right = side_force(slip, config, step, (unsigned)JP_SKID_RIGHT);
    const jp_q24 force = step->turn < 0 ? jp_sub(left, right) : jp_sub(right, left);
    const jp_q24 expected = jp_share(slip->turn_force, slip->yielding, SHARE_BITS);
    const int32_t weight = jp_skid_lesser(jp_skid_size(step->turn), JP_SKID_ONE / GRIP_MEMORY) * GRIP_MEMORY;
    const jp_q24 learned = jp_add(slip->turn_force, jp_share(jp_sub(force, expected), weight, 30));

    slip->turn_force = jp_clamp32(learned, config->turn_force / GRIP_MAX, config->turn_force * 2);
    slip->looseness = config->turn_force / (slip->turn_force / GRIP_ONE);
}

void jp_skid_slip_learn(struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config,
                        const struct jp_skid_step *step)
{
    if (is_skidding(slip, config, step)) {
        learn_grip(slip, config, step);
    }
    set_creep(slip, config);
}
