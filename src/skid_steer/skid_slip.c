#include "src/skid_steer/skid_slip.h"
#include "src/base/compiler.h"

#include "src/skid_steer/skid_arithmetic.h"

/* Of the force that a turn takes: 1/e after 1/3 rad; ground that grips less than the file's by 8 at most. */
#define GRIP_ONE       4096
#define GRIP_MEMORY    5
#define GRIP_MAX       8
#define GRIP_FORCE_MIN JP_Q24(0.05)

/* What the steering ratio grows by at most. */
#define RATIO_GROWTH_MAX JP_Q24(0.0625)

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
        .centripetal = jp_skid_part(acceleration, JP_SKID_TWO_PI),
        .braking = jp_divide((int64_t)1 << 48, config->efficiency),
    };
    set_creep(slip, config);
}

/* What the robot goes forward and sideways. */
static void move(struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config,
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

    slip->along = jp_skid_part(slip->creep_along, ahead);
    slip->across = jp_clamp32(turned_left, -slip->most, slip->most);
    const int32_t crept = jp_add(jp_skid_part(rolled, ahead), jp_skid_part(turned, slip->along));

    step->forward_before = step->forward;
    step->forward = jp_sub(jp_add(way, pushed_ahead), jp_add(crept, way < 0 ? -bend : bend));
    step->sideways = jp_sub(jp_skid_part(turned, slip->across), jp_skid_part(rolled, left));
}

/* Of the steering ratio: a robot that is pushed aside skids less. */
static jp_q24 ratio_growth(const struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config)
{
    const int32_t aside = jp_sub(jp_skid_part(slip->across, slip->across), jp_skid_part(slip->along, slip->along));

    return jp_clamp32(jp_skid_part(aside, config->ratio_growth), -RATIO_GROWTH_MAX, RATIO_GROWTH_MAX);
}

void jp_skid_slip_move(struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config,
                       const struct jp_skid_tilt *tilt, struct jp_skid_step *step)
{
    set_creep(slip, config);
    move(slip, config, tilt, step);
    step->pushed_turn = jp_add(step->wheel_turn, jp_share(step->wheel_turn, ratio_growth(slip, config), 24));
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

    return config->turn_force >= GRIP_FORCE_MIN && turned / 2 > jp_share(jp_skid_size(step->way), config->creep, 24);
}

void jp_skid_slip_learn(struct jp_skid_slip *slip, const struct jp_skid_odometry_config *config,
                        const struct jp_skid_step *step)
{
    if (!is_skidding(slip, config, step)) {
        return;
    }
    const jp_q24 left = side_force(slip, config, step, (unsigned)JP_SKID_LEFT);
    const jp_q24 right = side_force(slip, config, step, (unsigned)JP_SKID_RIGHT);
    const jp_q24 force = step->turn < 0 ? jp_sub(left, right) : jp_sub(right, left);
    const int32_t weight = jp_skid_lesser(jp_skid_size(step->turn), JP_SKID_ONE / GRIP_MEMORY) * GRIP_MEMORY;
    const jp_q24 learned = slip->turn_force + jp_share(jp_sub(force, slip->turn_force), weight, 30);

    slip->turn_force = jp_clamp32(learned, config->turn_force / GRIP_MAX, config->turn_force * 2);
    slip->looseness = config->turn_force / (slip->turn_force / GRIP_ONE);
}
