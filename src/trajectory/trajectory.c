#include <joulepath/trajectory.h>

#include <stddef.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/trajectory/trajectory_blend.h"

#define Q30_ONE ((int32_t)1 << 30)
#define Q31_ONE ((int64_t)1 << 31)

#define FIELD(member, low, high) JP_CONFIG_FIELD("trajectory.", struct jp_trajectory_config, member, low, high)

enum jp_status jp_trajectory_check(const struct jp_trajectory_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(tick_rate, JP_TICK_RATE_MIN, JP_TICK_RATE_MAX),
        FIELD(turns_per_metre, JP_Q24(0.1), JP_Q24(16)),
        FIELD(lag, 0, JP_Q24_ONE),
        FIELD(lean, -JP_Q24(16), JP_Q24(16)),
        FIELD(volts, -JP_Q16(4096), JP_Q16(4096)),
        FIELD(turning, -JP_Q16(4096), JP_Q16(4096)),
        FIELD(voltage, 1, JP_Q16(512)),
        FIELD(blend, JP_Q16(0.05), JP_Q16(60)),
        FIELD(turn_pace, JP_Q24(0.01), JP_Q24(64)),
        FIELD(turn_rate, JP_Q24(0.01), JP_Q24(64)),
        FIELD(pitch, 1, JP_Q24(0.125)),
        FIELD(steering, 0, Q30_ONE),
        FIELD(aim, 0, JP_Q24(16)),
        FIELD(modes.decay, 1, INT32_MAX),
        FIELD(modes.keep, 1, INT32_MAX),
        FIELD(modes.share, -JP_Q16(1024), JP_Q16(1024)),
        FIELD(modes.lean, -JP_Q24(16), JP_Q24(16)),
        FIELD(modes.lean_rate, -JP_Q24(64), JP_Q24(64)),
        FIELD(modes.volts, -JP_Q16(4096), JP_Q16(4096)),
    };

    return jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);
}

/* Shapes. */

/** 1/duration, 1/s. */
static jp_q24 pace_of(const struct jp_trajectory_config *config, uint32_t set_points)
{
    const int64_t rate = config->tick_rate;
    const uint32_t share = UINT32_MAX / set_points;

    return jp_saturate32((int64_t)share * rate / (256 * (int64_t)JP_TICKS_PER_SET_POINT));
}

/** The quintic of ν: its derivatives are 30 p², 60 p(1 − 2s) and 60(1 − 6p) by the change and the pace. */
static void shape_travel(struct jp_blend *blend, const struct jp_trajectory_config *config, jp_q24 speed, jp_q24 change,
                         jp_q24 pace)
{
    const jp_q24 first = jp_q24_multiply(jp_saturate32(30 * (int64_t)change), pace);
    const jp_q16 second = jp_multiply_shift(jp_q24_multiply(jp_saturate32(60 * (int64_t)change), pace), pace, 32);
    const jp_q16 third = jp_multiply_shift(second, pace, 24);
    const jp_q24 lag = jp_multiply_shift(config->lag, second, 16);

    blend->wheel_rate[0] = jp_q24_multiply(speed, config->turns_per_metre);
    blend->wheel_rate[1] = jp_q24_multiply(change, config->turns_per_metre);
    blend->wheel_rate[2] = jp_sub(0, jp_q24_multiply(lag, config->turns_per_metre));
    blend->pitch[0] = jp_q24_multiply(config->lean[0], speed);
    blend->pitch[1] = jp_q24_multiply(config->lean[0], change);
    blend->pitch[2] = jp_q24_multiply(config->lean[1], first);
    blend->pitch_rate[0] = jp_q24_multiply(config->lean[0], first);
    blend->pitch_rate[1] = jp_multiply_shift(config->lean[1], second, 16);
    blend->common[0] = jp_multiply_shift(config->volts[0], speed, 24);
    blend->common[1] = jp_multiply_shift(config->volts[0], change, 24);
    blend->common[2] = jp_multiply_shift(config->volts[1], first, 24);
    blend->common[3] = jp_q16_multiply(config->volts[2], second);
    blend->common[4] = jp_q16_multiply(config->volts[3], third);
}

/** The cubic of φ: φ̇ = w₀ + Δw s + b p. */
static void shape_turn(struct jp_blend *blend, const struct jp_trajectory_config *config,
                       const struct jp_waypoint_motion *from, const struct jp_waypoint_motion *to, int32_t turned,
                       jp_q24 pace)
{
    const jp_turns_per_s change = to->turn_rate - from->turn_rate;
    const jp_turns_per_s bend = jp_saturate32(6 * (int64_t)jp_multiply_shift(turned, pace, 31) -
                                              3 * ((int64_t)from->turn_rate + to->turn_rate));
    const jp_q16 acceleration = jp_multiply_shift(jp_add(change, bend), pace, 32); /* at its begin, turn/s² */
    const jp_q16 jerk = jp_multiply_shift(jp_add(bend, bend), pace, 32);           /* how much less at its end */

    blend->yaw_rate[0] = from->turn_rate;
    blend->yaw_rate[1] = change;
    blend->yaw_rate[2] = bend;
    blend->difference[0] = jp_add(jp_multiply_shift(config->turning[0], from->turn_rate, 24),
                                  jp_q16_multiply(config->turning[1], acceleration));
    blend->difference[1] =
        jp_sub(jp_multiply_shift(config->turning[0], change, 24), jp_q16_multiply(config->turning[1], jerk));
    blend->difference[2] = jp_multiply_shift(config->turning[0], bend, 24);
}

static void shape_blend(const struct jp_trajectory_config *config, const struct jp_waypoint_motion *from,
                        const struct jp_waypoint_motion *to, int32_t turned, struct jp_blend *blend)
{
    const jp_q24 pace = pace_of(config, blend->set_points);

    blend->step = UINT32_MAX / blend->set_points;
    shape_travel(blend, config, from->speed, to->speed - from->speed, pace);
    shape_turn(blend, config, from, to, turned, pace);
}

static void shape_cruise(const struct jp_trajectory_config *config, jp_q24 speed, struct jp_cruise *cruise)
{
    cruise->wheel_rate = jp_q24_multiply(speed, config->turns_per_metre);
    cruise->pitch = jp_q24_multiply(config->lean[0], speed);
    cruise->common = jp_multiply_shift(config->volts[0], speed, 24);
}

void jp_leg_shape(const struct jp_trajectory_config *config, const struct jp_waypoint_motion *from,
                  struct jp_trajectory_leg *leg)
{
    const struct jp_waypoint_motion middle = {.heading = leg->heading, .speed = leg->speed};

    shape_blend(config, from, &middle, jp_turn_by(from->heading, leg->chord, leg->heading), &leg->begin);
    shape_cruise(config, leg->speed, &leg->middle);
    shape_blend(config, &middle, &leg->next, jp_turn_by(leg->heading, leg->chord, leg->next.heading), &leg->end);
}

/* Set-points. */

/** a·b in Q30; both are within ±2, their product too. */
static inline int32_t multiply30(int32_t a, int32_t b)
{
    return (int32_t)(jp_multiply(a, b) >> 30);
}

/** A sum of at most four products by Q30, saturated. */
static inline int32_t by_q30(int64_t sum)
{
    return jp_saturate32((sum + (Q30_ONE >> 1)) >> 30);
}

void jp_blend_at(const struct jp_blend *blend, int32_t share, struct jp_set_point *at)
{
    const int32_t square = multiply30(share, share);
    const int32_t rest = 10 * (Q30_ONE >> 3) - 15 * (share >> 3) + 6 * (square >> 3); /* Q27 */
    const int32_t q = (int32_t)(jp_multiply(multiply30(square, share), rest) >> 27);
    const int32_t p = share - square;
    const int32_t pp = multiply30(p, p);
    const int32_t odd = multiply30(p, Q30_ONE - share - share); /* p(1 − 2s) */
    const int32_t third = Q30_ONE - 6 * p;

    at->wheel_rate = jp_add(blend->wheel_rate[0],
                            by_q30(jp_multiply(blend->wheel_rate[1], q) + jp_multiply(blend->wheel_rate[2], odd)));
    at->pitch = jp_add(blend->pitch[0], by_q30(jp_multiply(blend->pitch[1], q) + jp_multiply(blend->pitch[2], pp)));
    at->pitch_rate = by_q30(jp_multiply(blend->pitch_rate[0], pp) + jp_multiply(blend->pitch_rate[1], odd));
    at->common =
        jp_add(blend->common[0], by_q30(jp_multiply(blend->common[1], q) + jp_multiply(blend->common[2], pp) +
                                        jp_multiply(blend->common[3], odd) + jp_multiply(blend->common[4], third)));
    at->yaw_rate =
        jp_add(blend->yaw_rate[0], by_q30(jp_multiply(blend->yaw_rate[1], share) + jp_multiply(blend->yaw_rate[2], p)));
    at->difference = jp_add(blend->difference[0],
                            by_q30(jp_multiply(blend->difference[1], share) + jp_multiply(blend->difference[2], p)));
}

static void cruise_at(const struct jp_cruise *cruise, struct jp_set_point *at)
{
    *at = (struct jp_set_point){.wheel_rate = cruise->wheel_rate, .pitch = cruise->pitch, .common = cruise->common};
}

/** What is left of the start's difference; it decays. */
static void add_modes(struct jp_set_point *at, const struct jp_trajectory_config *config, int32_t *mode)
{
    const struct jp_travel_modes *modes = &config->modes;
    const int64_t speed = (int64_t)mode[0] + mode[1] + mode[2];
    int64_t pitch = 0;
    int64_t pitch_rate = 0;
    int64_t volts = 0;

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        pitch += jp_multiply(modes->lean[i], mode[i]);
        pitch_rate += jp_multiply(modes->lean_rate[i], mode[i]);
        volts += jp_multiply(modes->volts[i], mode[i]);
        /* Towards 0, which a slow mode would not reach if it were rounded. */
        mode[i] = (int32_t)(jp_multiply(modes->keep[i], mode[i]) / Q31_ONE);
    }
    at->wheel_rate = jp_add(at->wheel_rate, jp_multiply_shift(jp_saturate32(speed), config->turns_per_metre, 28));
    at->pitch = jp_add(at->pitch, jp_saturate32(pitch >> 28));
    at->pitch_rate = jp_add(at->pitch_rate, jp_saturate32(pitch_rate >> 28));
    at->common = jp_add(at->common, jp_saturate32(volts >> 28));
}

/* A drive. */

static uint32_t set_points_of(const struct jp_trajectory_leg *leg, enum jp_trajectory_piece piece)
{
    if (piece == JP_MIDDLE) {
        return leg->middle.set_points;
    }
    return piece == JP_BLEND_AT_BEGIN ? leg->begin.set_points : leg->end.set_points;
}

static void next_leg(struct jp_trajectory_drive_internal *drive)
{
    drive->leg++;
    drive->place++;
    if (drive->place == drive->trajectory->places) {
        drive->place = 0;
    }
}

static void next_piece(struct jp_trajectory_drive_internal *drive)
{
    if (drive->piece == JP_BLEND_AT_END) {
        drive->piece = JP_BLEND_AT_BEGIN;
        next_leg(drive);
    } else {
        drive->piece = drive->piece == JP_BLEND_AT_BEGIN ? JP_MIDDLE : JP_BLEND_AT_END;
    }
    drive->share = 0;
}

enum jp_status jp_trajectory_duration(const struct jp_trajectory_config *config, const struct jp_trajectory *trajectory,
                                      jp_q16 *seconds)
{
    uint64_t set_points = 0;

    if (config == NULL || trajectory == NULL || seconds == NULL) {
        return JP_ERR_ARGUMENT;
    }
    for (uint16_t i = 0; i < trajectory->count; i++) {
        const struct jp_trajectory_leg *leg = &trajectory->legs[i];

        set_points += leg->begin.set_points;
        set_points += leg->middle.set_points;
        set_points += leg->end.set_points;
    }

    const uint64_t share = set_points * JP_TICKS_PER_SET_POINT * (uint32_t)JP_Q16_ONE;
    const uint64_t least = (share + config->tick_rate - 1U) / config->tick_rate;
    const bool fits = least <= (uint64_t)INT32_MAX;

    *seconds = fits ? (jp_q16)least : INT32_MAX;
    return fits ? JP_OK : JP_ERR_OVERFLOW;
}

void jp_trajectory_begin(struct jp_trajectory_drive *drive, const struct jp_trajectory *trajectory)
{
    drive->internal = (struct jp_trajectory_drive_internal){.trajectory = trajectory};
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        drive->internal.mode[i] = trajectory->transient[i];
    }
}

const struct jp_trajectory_leg *jp_trajectory_next_leg(const struct jp_trajectory_drive *drive)
{
    const struct jp_trajectory_drive_internal *d = &drive->internal;

    return d->leg < JP_LOAD_ACQUIRE(&d->trajectory->count) ? &d->trajectory->legs[d->place] : NULL;
}

bool jp_trajectory_advance(struct jp_trajectory_drive *drive, const struct jp_trajectory_config *config,
                           struct jp_set_point *set_point)
{
    struct jp_trajectory_drive_internal *d = &drive->internal;

    if (d->set_points_left == 0U && jp_trajectory_next_leg(drive) == NULL) {
        return false;
    }

    const struct jp_trajectory_leg *leg = &d->trajectory->legs[d->place];

    if (d->set_points_left == 0U) {
        d->set_points_left = set_points_of(leg, d->piece);
    }
    if (d->piece == JP_MIDDLE) {
        cruise_at(&leg->middle, set_point);
    } else {
        const struct jp_blend *blend = d->piece == JP_BLEND_AT_BEGIN ? &leg->begin : &leg->end;

        jp_blend_at(blend, (int32_t)(d->share >> 2), set_point);
        d->share += blend->step;
    }
    add_modes(set_point, config, d->mode);
    d->set_points_left--;
    if (d->set_points_left == 0U) {
        next_piece(d);
    }
    return true;
}
