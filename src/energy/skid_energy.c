#include <joulepath/skid_energy.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/integer.h"
#include "src/energy/energy_terms.h"

#define DURATION_MAX JP_Q16(256)

#define EFFORT_MAX JP_Q24(2)
#define FORCE_MAX  JP_Q24(8)

/* So that no product and no sum overflows: work of a side over the weight, m/s in Q24; power by the force over the
 * weight and power, W in Q16; energy of a piece, Q16. */
#define WORK_MAX   JP_Q24(32)
#define GAIN_MAX   ((int64_t)1 << 35)
#define POWER_MAX  ((int64_t)1 << 38)
#define ENERGY_MAX ((int64_t)1 << 46)

enum { LEFT, RIGHT, SIDES };

/* What a piece is on its mean; Q24. */
struct mean_motion {
    int32_t speed;
    int32_t turn_rate;
    int32_t grade;
    int32_t bank;
    int32_t effort;   /* e */
    int32_t swinging; /* j α */
};

/* What the treads do; forces as shares of the weight; Q24. */
struct treads {
    int32_t speed[SIDES];
    int32_t force[SIDES];
    int64_t turning;         /* t */
    int64_t turning_by_grip; /* its change by the relative one of the friction */
    int64_t slip;            /* s, m/s */
    int64_t slip_by_grip;
    int32_t level; /* 1/(1 + grade²) */
};

/* W in Q16. */
struct effect {
    int64_t power;
    int64_t change[JP_SKID_FACTORS];
};

#define FIELD(member, low, high) JP_CONFIG_FIELD("skid_energy.", struct jp_skid_energy_model, member, low, high)

enum jp_status jp_skid_energy_check(const struct jp_skid_energy_model *model, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(half_track, JP_Q24(0.01), JP_Q24(4)),
        FIELD(weight, JP_Q16(1), JP_Q16(16384)),
        FIELD(rolling, 0, JP_Q24(0.5)),
        FIELD(friction, JP_Q24(0.02), JP_Q24(2)),
        FIELD(turning, 0, JP_Q24(4)),
        FIELD(yielding, 0, JP_Q24(16)),
        FIELD(scrub, 0, JP_Q24(4)),
        FIELD(easing, 0, JP_Q24(4)),
        FIELD(bank_easing, 0, JP_Q24(4)),
        FIELD(tilting, 0, JP_Q24(4)),
        FIELD(inertia, 0, JP_Q24(8)),
        FIELD(turn_inertia, 0, JP_Q24(8)),
        FIELD(driving, JP_Q24(1), JP_Q24(10)),
        FIELD(braking, 0, JP_Q24(1)),
        FIELD(copper_driving, 0, JP_Q16(16384)),
        FIELD(copper_braking, 0, JP_Q16(16384)),
        FIELD(electronics_power, 0, JP_Q16(1024)),
        FIELD(unit_exponent, -JP_ENERGY_UNIT_EXPONENT_MAX, JP_ENERGY_UNIT_EXPONENT_MAX),
    };

    return jp_config_check(model, fields, JP_CONFIG_COUNT(fields), field);
}

/* ---- Treads ---- */

/* a·b of Q24 numbers whose product fits 64 bits. */
static JP_INLINE_FOR_SPEED int64_t q24_product(int64_t a, int64_t b)
{
    return jp_round_shift64(a * b, 24);
}

static JP_INLINE_FOR_SPEED int64_t limited(int64_t x, int64_t limit)
{
    if (x < -limit) {
        return -limit;
    }
    return x > limit ? limit : x;
}

static JP_INLINE_FOR_SPEED int32_t sign(int32_t x)
{
    return (x > 0) - (x < 0);
}

static JP_INLINE_FOR_SPEED int64_t ratio(int64_t a, int64_t b)
{
    return a * JP_Q24_ONE / b;
}

/* m: how fast the treads roll. */
static JP_INLINE_FOR_SPEED int64_t rolling_speed(const struct jp_skid_energy_model *model,
                                                 const struct mean_motion *mean)
{
    const int64_t across = q24_product(model->half_track, jp_absolute64(mean->turn_rate));
    const int64_t along = jp_absolute64(mean->speed);

    return across > along ? across : along;
}

/* 1 − r */
static int64_t eased(const struct jp_skid_energy_model *model, const struct mean_motion *mean)
{
    const int64_t by_effort = q24_product(model->easing, q24_product(mean->effort, mean->effort));
    const int64_t by_bank = q24_product(model->bank_easing, q24_product(mean->bank, mean->bank));

    return limited(ratio(by_effort + by_bank, q24_product(model->friction, model->friction)), JP_Q24_ONE);
}

static void set_turning(const struct jp_skid_energy_model *model, const struct mean_motion *mean, struct treads *treads)
{
    const int64_t tilting = q24_product(model->tilting, q24_product(mean->effort, mean->bank));

    treads->turning = tilting + mean->swinging;
    treads->turning_by_grip = 0;
    if (mean->turn_rate != 0) {
        const int64_t stiffness = q24_product(model->friction, model->yielding);
        const int64_t turning = jp_absolute64(mean->turn_rate);
        const int64_t resistance = turning + q24_product(stiffness, rolling_speed(model, mean)); /* D, at most 2³⁴ */
        const int64_t grip = q24_product(q24_product(model->turning, model->friction), mean->turn_rate);
        const int64_t level = ratio(grip, resistance);      /* k μ w/D, at most 2²⁷ */
        const int64_t sliding = ratio(turning, resistance); /* |w|/D */
        const int64_t gone = eased(model, mean);
        const bool is_left = gone < JP_Q24_ONE;
        treads->turning += q24_product(level, JP_Q24_ONE - gone);
        treads->turning_by_grip = is_left ? q24_product(level, q24_product(sliding, JP_Q24_ONE - gone) + 2 * gone) : 0;
    }
}

static void set_slip(const struct jp_skid_energy_model *model, const struct mean_motion *mean, struct treads *treads)
{
    const int64_t stiffness = q24_product(model->friction, model->yielding);
    const int64_t rolling = q24_product(stiffness, jp_absolute64(mean->speed)); /* at most 2³² */
    const int64_t turning = jp_absolute64(mean->turn_rate);
    const int64_t way = q24_product(q24_product(mean->effort, mean->effort), model->scrub); /* at most 2²⁸ */
    const int64_t left = model->friction - jp_absolute64(mean->effort);
    const int64_t least = model->friction / 4;
    const int64_t grip = left > least ? left : least;
    const int64_t change = left > least ? ratio(model->friction, grip) : JP_Q24_ONE;

    treads->slip = limited(ratio(q24_product(way, turning + rolling), 2 * grip), WORK_MAX);
    treads->slip_by_grip =
        limited(ratio(q24_product(way, rolling), 2 * grip), WORK_MAX) - q24_product(treads->slip, change);
}

static void set_side(const struct jp_skid_energy_model *model, const struct mean_motion *mean, int side,
                     struct treads *treads)
{
    const int32_t across = (int32_t)q24_product(model->half_track, mean->turn_rate);
    const int32_t speed = side == LEFT ? mean->speed - across : mean->speed + across;
    const int32_t straight = sign(speed) * (model->rolling / 2) + mean->effort / 2;

    treads->speed[side] = speed;
    treads->force[side] =
        (int32_t)limited(side == LEFT ? straight - treads->turning : straight + treads->turning, FORCE_MAX);
}

static void set_treads(const struct jp_skid_energy_model *model, const struct mean_motion *mean, struct treads *treads)
{
    set_turning(model, mean, treads);
    set_slip(model, mean, treads);
    set_side(model, mean, LEFT, treads);
    set_side(model, mean, RIGHT, treads);
    treads->level = (int32_t)ratio(JP_Q24_ONE, JP_Q24_ONE + q24_product(mean->grade, mean->grade));
}

/* ---- Power ---- */

static void add_side(const struct jp_skid_energy_model *model, const struct treads *treads, int side,
                     struct effect *effect)
{
    const int32_t speed = treads->speed[side];
    const int32_t force = treads->force[side];
    const int64_t driven = q24_product(force, speed);
    const int64_t work = limited(driven + treads->slip, WORK_MAX);
    const int64_t weight =
        q24_product(work < 0 ? model->braking : model->driving, model->weight); /* x G, at most 2³⁴ */
    const int32_t windings = driven <= 0 ? model->copper_braking : model->copper_driving;
    const int64_t per_force = q24_product(windings, q24_product(force, treads->level)); /* at most 2³³ */
    const int64_t mechanical = q24_product(weight, work);
    const int64_t copper = q24_product(per_force, force);
    const int64_t gain = limited(q24_product(weight, speed) + 2 * per_force, GAIN_MAX); /* by a change of the force */
    const int64_t turning = limited(treads->turning_by_grip, FORCE_MAX);

    effect->power += mechanical + copper;
    effect->change[JP_SKID_ROLLING] += q24_product(gain, (int64_t)sign(speed) * (model->rolling / 2));
    effect->change[JP_SKID_FRICTION] += q24_product(gain, side == LEFT ? -turning : turning) +
                                        q24_product(weight, limited(treads->slip_by_grip, WORK_MAX));
    effect->change[JP_SKID_WEIGHT] += mechanical + 2 * copper;
}

static void set_effect(const struct jp_skid_energy_model *model, const struct mean_motion *mean, struct effect *effect)
{
    struct treads treads;

    *effect = (struct effect){.power = model->electronics_power};
    effect->change[JP_SKID_ELECTRONICS] = model->electronics_power;
    set_treads(model, mean, &treads);
    if (treads.speed[LEFT] != 0 || treads.speed[RIGHT] != 0) {
        add_side(model, &treads, LEFT, effect);
        add_side(model, &treads, RIGHT, effect);
    }
}

static bool is_rise(jp_q24 rise)
{
    return jp_is_between(rise, -JP_Q24_ONE, JP_Q24_ONE);
}

enum jp_status jp_skid_energy_power(const struct jp_skid_energy_model *model, const struct jp_motion *motion,
                                    jp_q24 grade, jp_q16 *power)
{
    struct effect effect;

    if (model == NULL || motion == NULL || power == NULL || !jp_motion_in_range(motion) || !is_rise(grade)) {
        return JP_ERR_ARGUMENT;
    }
    const struct mean_motion mean = {
        .speed = motion->speed, .turn_rate = motion->turn_rate, .grade = grade, .effort = grade};

    set_effect(model, &mean, &effect);
    *power = jp_saturate32(effect.power);
    return *power == effect.power ? JP_OK : JP_ERR_OVERFLOW;
}

/* ---- Drives ---- */

/* Change of a speed in a second. */
static JP_INLINE_FOR_SPEED int32_t acceleration(int32_t start, int32_t end, jp_q16 duration)
{
    return jp_divide(((int64_t)end - start) * JP_Q16_ONE, duration);
}

static struct mean_motion mean_of(const struct jp_skid_energy_model *model, const struct jp_skid_piece *piece)
{
    const int32_t ahead = acceleration(piece->start.speed, piece->end.speed, piece->duration);
    const int32_t around = acceleration(piece->start.turn_rate, piece->end.turn_rate, piece->duration);

    return (struct mean_motion){
        .speed = (piece->start.speed + piece->end.speed) / 2,
        .turn_rate = (piece->start.turn_rate + piece->end.turn_rate) / 2,
        .grade = piece->grade,
        .bank = piece->bank,
        .effort = (int32_t)limited(piece->grade + q24_product(model->inertia, ahead), EFFORT_MAX),
        .swinging = (int32_t)limited(q24_product(model->turn_inertia, around), FORCE_MAX),
    };
}

/* Of the slope under the robot, whichever way it moves; W in Q16. */
static int64_t slope_power(const struct jp_skid_energy_model *model, const struct mean_motion *mean)
{
    const int64_t per_rise = limited(q24_product(model->weight, rolling_speed(model, mean)), GAIN_MAX);

    return q24_product(per_rise, jp_absolute64(mean->grade) + jp_absolute64(mean->bank));
}

/* 2ⁿ J in Q16. */
static JP_INLINE_FOR_SPEED int64_t over_time(const struct jp_skid_energy_model *model, int64_t power, jp_q16 duration)
{
    const int32_t shift = 16 + model->unit_exponent;

    return limited(jp_round_shift64(limited(power, POWER_MAX) * duration, (unsigned)shift), ENERGY_MAX);
}

enum jp_status jp_skid_energy_add(const struct jp_skid_energy_model *model, struct jp_skid_drive *drive,
                                  const struct jp_skid_piece *piece)
{
    struct effect effect;

    if (model == NULL || drive == NULL || piece == NULL || !jp_motion_in_range(&piece->start) ||
        !jp_motion_in_range(&piece->end) || !is_rise(piece->grade) || !is_rise(piece->bank) ||
        !jp_is_between(piece->duration, 1, DURATION_MAX)) {
        return JP_ERR_ARGUMENT;
    }
    const struct mean_motion mean = mean_of(model, piece);

    set_effect(model, &mean, &effect);
    drive->energy += over_time(model, effect.power, piece->duration);
    for (int factor = 0; factor < (int)JP_SKID_FACTORS; factor++) {
        drive->change[factor] += over_time(model, effect.change[factor], piece->duration);
    }
    drive->slope_work += over_time(model, slope_power(model, &mean), piece->duration);
    return JP_OK;
}

/* ---- Factors ---- */

static JP_INLINE_FOR_SPEED int32_t times(int32_t value, jp_q16 factor, int32_t low, int32_t high)
{
    return jp_clamp32(jp_multiply_shift(value, factor, 16), low, high);
}

void jp_skid_energy_scale(const struct jp_skid_energy_model *model, const jp_q16 factor[JP_SKID_FACTORS],
                          struct jp_skid_energy_model *scaled)
{
    const jp_q16 square = jp_q16_multiply(factor[JP_SKID_WEIGHT], factor[JP_SKID_WEIGHT]);

    *scaled = *model;
    scaled->rolling = times(model->rolling, factor[JP_SKID_ROLLING], 0, JP_Q24(0.5));
    scaled->friction = times(model->friction, factor[JP_SKID_FRICTION], JP_Q24(0.02), JP_Q24(2));
    scaled->weight = times(model->weight, factor[JP_SKID_WEIGHT], JP_Q16(1), JP_Q16(16384));
    scaled->copper_driving = times(model->copper_driving, square, 0, JP_Q16(16384));
    scaled->copper_braking = times(model->copper_braking, square, 0, JP_Q16(16384));
    scaled->electronics_power = times(model->electronics_power, factor[JP_SKID_ELECTRONICS], 0, JP_Q16(1024));
}
