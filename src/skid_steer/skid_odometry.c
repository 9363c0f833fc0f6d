#include <joulepath/skid_odometry.h>

#include "src/base/config_check.h"
#include "src/skid_steer/skid_arithmetic.h"
#include "src/skid_steer/skid_gyro.h"
#include "src/skid_steer/skid_past.h"
#include "src/skid_steer/skid_slip.h"
#include "src/skid_steer/skid_tilt.h"

#define ACCEL_BITS 26 /* ±2 g */

#define RADIANS_INVERSE JP_Q24(0.15915494309189535)

/* The wheels stand once both sides have stayed within this many counts for a quarter of a second. */
#define STAND_COUNTS       1
#define STANDS_IN_A_SECOND 4U

#define FIELD(member, low, high) JP_CONFIG_FIELD("odometry.", struct jp_skid_odometry_config, member, low, high)

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
        FIELD(turn_shift_along, 0, JP_Q24(8)),
        FIELD(turn_shift_across, 0, JP_Q24(8)),
        FIELD(turn_slide_most, 0, JP_Q24(4)),
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

void jp_skid_odometry_start(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                            const struct jp_sensors *sensors)
{
    const int64_t rate = (int64_t)config->tick_rate;

    *odometry = (struct jp_skid_odometry){
        .steering_ratio = config->ratio,
        .internal =
            {
                .encoder = {sensors->encoder_left, sensors->encoder_right},
                .stand = {sensors->encoder_left, sensors->encoder_right},
                .stand_steps = UINT32_MAX,
                .stand_steps_min = config->tick_rate / (STANDS_IN_A_SECOND * config->step_ticks) + 1U,
                .phase_per_rate = jp_phase_per_rate(config->tick_rate),
                .mean_share = jp_divide((int64_t)1 << 31, (int32_t)config->step_ticks),
                .speed_per_way = jp_saturate32(rate * JP_Q16_ONE / (int64_t)config->step_ticks),
            },
    };
    jp_skid_odometry_know_scale(odometry, config, &(struct jp_gyro_scale){0});
    jp_skid_tilt_start(&odometry->internal.tilt, config, jp_saturate_bits(sensors->accel_x, ACCEL_BITS));
    jp_skid_slip_start(&odometry->internal.slip, config, odometry->internal.tilt.acceleration);
}

void jp_skid_odometry_know_scale(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                                 const struct jp_gyro_scale *scale)
{
    const struct jp_gyro_scale by_file = jp_skid_gyro_scale_by_file(config);

    jp_skid_gyro_start(&odometry->internal.gyro, config, scale->deviation > 0 ? scale : &by_file);
}

/* ---- Steps ---- */

static bool stays(uint32_t counts, uint32_t anchor)
{
    return jp_is_between((int32_t)(counts - anchor), -STAND_COUNTS, STAND_COUNTS);
}

static void watch_stand(struct jp_skid_odometry *odometry, const uint32_t *counts)
{
    uint32_t *stand = odometry->internal.stand;

    if (!stays(counts[JP_SKID_LEFT], stand[JP_SKID_LEFT]) || !stays(counts[JP_SKID_RIGHT], stand[JP_SKID_RIGHT])) {
        stand[JP_SKID_LEFT] = counts[JP_SKID_LEFT];
        stand[JP_SKID_RIGHT] = counts[JP_SKID_RIGHT];
        odometry->internal.stand_steps = 0;
    }
    odometry->internal.is_moving = odometry->internal.stand_steps < odometry->internal.stand_steps_min;
    if (odometry->internal.is_moving) {
        odometry->internal.stand_steps++;
    }
}

static void take_counts(struct jp_skid_odometry *odometry, const struct jp_sensors *sensors)
{
    const uint32_t counts[] = {sensors->encoder_left, sensors->encoder_right};
    struct jp_skid_step *step = &odometry->internal.step;

    for (unsigned side = 0; side < (unsigned)JP_SKID_SIDES; side++) {
        step->counts[side] = (int32_t)(counts[side] - odometry->internal.encoder[side]);
        odometry->internal.encoder[side] = counts[side];
    }
    step->current[JP_SKID_LEFT] = sensors->current_left;
    step->current[JP_SKID_RIGHT] = sensors->current_right;
    watch_stand(odometry, counts);
}

/* By the wheels. */
static void set_way(struct jp_skid_step *step, const struct jp_skid_odometry_config *config)
{
    const int32_t sum = jp_add(step->counts[JP_SKID_LEFT], step->counts[JP_SKID_RIGHT]);
    const int32_t difference = jp_sub(step->counts[JP_SKID_RIGHT], step->counts[JP_SKID_LEFT]);

    step->way = jp_round_shift(jp_multiply(sum, config->way_per_count), 9);
    step->side_way = jp_skid_size(jp_round_shift(jp_multiply(difference, config->way_per_count), 9));
    step->wheel_turn = jp_round_shift(jp_multiply(difference, config->turn_per_count), 8);
}

/* By the gyro. */
static void set_turn(struct jp_skid_odometry *odometry, struct jp_skid_step *step)
{
    const int32_t turned = jp_sub(step->gyro_turn, odometry->internal.gyro.bias >> 8);

    odometry->internal.past.turned = jp_add(odometry->internal.past.turned, jp_round_shift(turned, 8));
    step->turn = jp_multiply_shift(turned, odometry->internal.gyro.scale, 30);
}

/* Begins a step: what the ticks added up becomes its increments. */
static void take_step(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                      const struct jp_sensors *sensors)
{
    struct jp_skid_step *step = &odometry->internal.step;

    take_counts(odometry, sensors);
    step->gyro_turn = jp_round_shift((int64_t)odometry->internal.yaw_angle, 24);
    step->gyro_pitch = jp_round_shift((int64_t)odometry->internal.pitch_angle, 24);
    step->force = jp_share(odometry->internal.accel_sum, odometry->internal.mean_share, 31);
    odometry->internal.yaw_angle = 0;
    odometry->internal.pitch_angle = 0;
    odometry->internal.accel_sum = 0;
    if (odometry->internal.is_moving) {
        set_way(step, config);
        set_turn(odometry, step);
    } else {
        step->way = 0;
        step->side_way = 0;
        step->wheel_turn = 0;
        step->turn = 0;
    }
}

/* ---- Pose ---- */

/* What the robot goes, and what the map sees of it. */
static void slip(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    const struct jp_skid_tilt *tilt = &odometry->internal.tilt;
    struct jp_skid_step *step = &odometry->internal.step;
    const jp_q24 ahead = tilt->state[JP_SKID_TILT_AHEAD];
    const jp_q24 left = tilt->state[JP_SKID_TILT_LEFT];
    const jp_q24 half_ahead = jp_multiply_shift(ahead, ahead, 25); /* p²/2 */
    const jp_q24 half_left = jp_multiply_shift(left, left, 25);

    jp_skid_slip_move(&odometry->internal.slip, config, tilt, step);
    step->plan = jp_sub(step->forward, jp_skid_part(step->forward, half_ahead));
    step->heading_turn = jp_add(step->turn, jp_skid_part(step->turn, half_ahead - half_left));
    odometry->speed = jp_multiply_shift(step->forward, odometry->internal.speed_per_way, 24);
}

/* component · way with the component in Q31 and the way in Q32 m. */
static int64_t along(jp_q31 component, int32_t way)
{
    return jp_multiply(component, way) >> 31;
}

static void move(struct jp_skid_odometry *odometry)
{
    struct jp_skid_step *step = &odometry->internal.step;
    const jp_angle mean = jp_phase_angle(odometry->heading) + (jp_angle)(step->heading_turn / 2);
    const jp_q31 cosine = jp_cos(mean);
    const jp_q31 sine = jp_sin(mean);

    step->way_x = jp_saturate32(along(cosine, step->plan) - along(sine, step->sideways));
    step->way_y = jp_saturate32(along(sine, step->plan) + along(cosine, step->sideways));
    odometry->x += step->way_x;
    odometry->y += step->way_y;
    odometry->heading += (jp_phase)((int64_t)step->heading_turn * ((int64_t)1 << 24));
    jp_skid_tilt_move(&odometry->internal.tilt, step);
}

/* ---- Ticks ---- */

/* One part of the step a tick. */
static void work(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    struct jp_skid_step *step = &odometry->internal.step;
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
            jp_skid_tilt_stand(&odometry->internal.tilt, step);
        }
        odometry->internal.next = JP_SKID_FILTER_HEADING;
        break;
    case JP_SKID_FILTER_HEADING:
        jp_skid_slip_push(&odometry->internal.slip, config, step);
        jp_skid_gyro_learn(&odometry->internal.gyro, step, odometry->internal.is_moving);
        odometry->internal.next = JP_SKID_CORRECT_POSE;
        break;
    case JP_SKID_CORRECT_POSE:
        odometry->steering_ratio = jp_skid_gyro_rescale(&odometry->internal.gyro);
        odometry->bias_rate = jp_multiply_shift(odometry->internal.gyro.bias, odometry->internal.speed_per_way, 32);
        jp_skid_past_correct(odometry);
        odometry->internal.next = JP_SKID_FILTER_TILT;
        break;
    case JP_SKID_FILTER_TILT:
        jp_skid_tilt_learn(&odometry->internal.tilt, step);
        break;
    case JP_SKID_ADD_UP:
    default:
        break;
    }
}

void jp_skid_odometry_update(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                             const struct jp_sensors *sensors)
{
    const jp_turns_per_s rate = jp_sub(sensors->yaw_rate, odometry->bias_rate);

    odometry->turn_rate = jp_multiply_shift(rate, odometry->internal.gyro.scale, 30);
    odometry->internal.yaw_angle += jp_phase_step(sensors->yaw_rate, odometry->internal.phase_per_rate);
    odometry->internal.pitch_angle += jp_phase_step(sensors->pitch_rate, odometry->internal.phase_per_rate);
    odometry->internal.accel_sum += jp_saturate_bits(sensors->accel_x, ACCEL_BITS);
    odometry->internal.ticks++;
    if (odometry->internal.ticks == config->step_ticks) {
        odometry->internal.ticks = 0;
        jp_skid_slip_learn(&odometry->internal.slip, config, &odometry->internal.step); /* the step before */
        take_step(odometry, config, sensors);
        odometry->internal.next = JP_SKID_SLIP;
    } else {
        work(odometry, config);
    }
}

/* Ticks that the pose does not know of. */
static int32_t ticks_since_pose(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    const enum jp_skid_odometry_part next = odometry->internal.next;
    const bool step_waits = next == JP_SKID_SLIP || next == JP_SKID_MOVE;

    return (int32_t)(odometry->internal.ticks + (step_waits ? config->step_ticks : 0U));
}

void jp_skid_odometry_now(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                          struct jp_point *position, jp_angle *heading)
{
    const int32_t ticks = odometry->internal.is_moving ? ticks_since_pose(odometry, config) : 0;
    const int64_t turned = (int64_t)jp_phase_step(odometry->turn_rate, odometry->internal.phase_per_rate) * ticks;
    const jp_angle middle = jp_phase_angle(odometry->heading + (jp_phase)(turned / 2));
    const int64_t way = jp_multiply(odometry->internal.step.forward, odometry->internal.mean_share) * ticks;
    const int32_t ahead = jp_saturate32(way >> 47); /* m, Q16 */

    position->x = jp_add(jp_saturate32(odometry->x >> 16), jp_share(ahead, jp_cos(middle), 31));
    position->y = jp_add(jp_saturate32(odometry->y >> 16), jp_share(ahead, jp_sin(middle), 31));
    *heading = jp_phase_angle(odometry->heading + (jp_phase)turned);
}

void jp_skid_odometry_slide(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                            struct jp_path_slide *slide)
{
    const struct jp_skid_tilt *tilt = &odometry->internal.tilt;

    slide->ahead = tilt->state[JP_SKID_TILT_AHEAD];
    slide->left = tilt->state[JP_SKID_TILT_LEFT];
    slide->by_turn = jp_skid_part(odometry->internal.slip.creep_across, RADIANS_INVERSE);
    slide->by_left = config->turn_shift_across;
    slide->most = config->turn_slide_most;
    slide->by_way = config->creep;
    slide->per_most = jp_multiply_shift(odometry->internal.slip.per_most, JP_SKID_TWO_PI, 16);
}
