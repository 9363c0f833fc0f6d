#include <joulepath/four_wheel_energy.h>
#include <stdbool.h>
#include <stddef.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/integer.h"

#define SPEED_MAX    JP_Q24(8)
#define SPEED_MIN    JP_Q24(1.0 / 256)
#define TRAVEL_MAX   JP_Q16(256)
#define DURATION_MAX JP_Q16(256)

/* Over a speed in Q24 it is seconds in Q16. */
#define ONE_METRE ((int64_t)1 << 40)

/* So that no product and no sum overflows: effort, m/s in Q24; force of a wheel over the weight, Q24; W in Q16; energy
 * of a piece, Q16. */
#define EFFORT_MAX JP_Q24(32)
#define FORCE_MAX  JP_Q24_ONE
#define POWER_MAX  ((int64_t)1 << 38)
#define ENERGY_MAX ((int64_t)1 << 46)

enum { FRONT_LEFT, FRONT_RIGHT, REAR_LEFT, REAR_RIGHT, WHEELS };

/* What a piece is on its mean; Q24. */
struct mean_twist {
    int64_t speed[WHEELS]; /* ui, m/s */
    int64_t rolling;       /* u */
    int64_t effort;        /* e, m/s */
    int64_t bend;          /* (x² + y²) w², m²/s⁴, Q24 */
};

/* W in Q16, and of steering 2ⁿ J. */
struct four_wheel_effect {
    int64_t power;
    int64_t change[JP_FOUR_WHEEL_FACTORS];
};

#define FIELD(member, low, high)                                                                                       \
    JP_CONFIG_FIELD("four_wheel_energy.", struct jp_four_wheel_energy_model, member, low, high)

enum jp_status jp_four_wheel_energy_check(const struct jp_four_wheel_energy_model *model, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(wheelbase, JP_Q24(0.05), JP_Q24(4)),
        FIELD(track, JP_Q24(0.05), JP_Q24(4)),
        FIELD(weight, JP_Q16(1), JP_Q16(16384)),
        FIELD(rolling, 0, JP_Q24(0.5)),
        FIELD(drag, 0, JP_Q24(1)),
        FIELD(cornering, 0, JP_Q24(1)),
        FIELD(inertia, 0, JP_Q24(8)),
        FIELD(turn_inertia, 0, JP_Q24(8)),
        FIELD(driving, JP_Q24(1), JP_Q24(10)),
        FIELD(braking, 0, JP_Q24(1)),
        FIELD(copper_driving, 0, JP_Q16(16384)),
        FIELD(copper_braking, 0, JP_Q16(16384)),
        FIELD(steering, 0, JP_Q16(1024)),
        FIELD(contact, 0, JP_Q24(0.5)),
        FIELD(electronics_power, 0, JP_Q16(1024)),
        FIELD(unit_exponent, -JP_ENERGY_UNIT_EXPONENT_MAX, JP_ENERGY_UNIT_EXPONENT_MAX),
    };

    return jp_config_check(model, fields, JP_CONFIG_COUNT(fields), field);
}

/* ---- Motion ---- */

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

/* √(a² + b²), |a| and |b| below 2³¹. */
static int64_t length(int64_t a, int64_t b)
{
    return (int64_t)jp_square_root((uint64_t)(a * a) + (uint64_t)(b * b));
}

/* Change in a second. */
static JP_INLINE_FOR_SPEED int64_t rate(int32_t start, int32_t end, jp_q16 duration)
{
    return limited(((int64_t)end - start) * JP_Q16_ONE / duration, (int64_t)JP_Q24(64));
}

static int32_t mean(int32_t start, int32_t end)
{
    return (start + end) / 2;
}

static void set_wheels(const struct jp_four_wheel_energy_model *model, const struct jp_twist *twist,
                       struct mean_twist *motion)
{
    const int64_t across = q24_product(twist->turn_rate, model->track / 2);
    const int64_t along = q24_product(twist->turn_rate, model->wheelbase / 2);

    motion->speed[FRONT_LEFT] = length(twist->x - across, twist->y + along);
    motion->speed[FRONT_RIGHT] = length(twist->x + across, twist->y + along);
    motion->speed[REAR_LEFT] = length(twist->x - across, twist->y - along);
    motion->speed[REAR_RIGHT] = length(twist->x + across, twist->y - along);
    motion->rolling = (motion->speed[FRONT_LEFT] + motion->speed[FRONT_RIGHT] + motion->speed[REAR_LEFT] +
                       motion->speed[REAR_RIGHT]) /
                      (int64_t)WHEELS;
}

static void set_mean(const struct jp_four_wheel_energy_model *model, const struct jp_four_wheel_piece *piece,
                     struct mean_twist *motion)
{
    const struct jp_twist twist = {mean(piece->start.x, piece->end.x), mean(piece->start.y, piece->end.y),
                                   mean(piece->start.turn_rate, piece->end.turn_rate)};
    const int64_t slope = q24_product(piece->grade, twist.x) + q24_product(piece->bank, twist.y);
    const int64_t driving = q24_product(rate(piece->start.x, piece->end.x, piece->duration), twist.x) +
                            q24_product(rate(piece->start.y, piece->end.y, piece->duration), twist.y);
    const int64_t turning =
        q24_product(rate(piece->start.turn_rate, piece->end.turn_rate, piece->duration), twist.turn_rate);
    const int64_t pull = q24_product(length(twist.x, twist.y), twist.turn_rate); /* at most 2³¹ */

    set_wheels(model, &twist, motion);
    motion->effort =
        limited(slope + q24_product(model->inertia, driving) + q24_product(model->turn_inertia, turning), EFFORT_MAX);
    motion->bend = q24_product(pull, pull);
}

/* ---- Power ---- */

static void add_wheel(const struct jp_four_wheel_energy_model *model, int64_t speed, int64_t pushed,
                      struct four_wheel_effect *effect)
{
    const int64_t drag = q24_product(model->drag, speed);
    const int64_t force = limited(model->rolling / (int64_t)WHEELS + drag + pushed, FORCE_MAX);
    const bool is_driving = force >= 0;
    const int64_t weight = q24_product(is_driving ? model->driving : model->braking, model->weight); /* below 2³⁴ */
    const int64_t per_force = q24_product(is_driving ? model->copper_driving : model->copper_braking, force);
    const int64_t gain = q24_product(weight, speed) + 2 * per_force; /* by a change of the force; below 2³⁹ */

    effect->power += q24_product(q24_product(weight, speed), force) + q24_product(per_force, force);
    effect->change[JP_FOUR_WHEEL_ROLLING] += q24_product(gain, model->rolling / (int64_t)WHEELS);
    effect->change[JP_FOUR_WHEEL_WEIGHT] += q24_product(gain, limited(force - drag, FORCE_MAX));
}

static void set_effect(const struct jp_four_wheel_energy_model *model, const struct mean_twist *motion,
                       struct four_wheel_effect *effect)
{
    *effect = (struct four_wheel_effect){.power = model->electronics_power};
    effect->change[JP_FOUR_WHEEL_ELECTRONICS] = model->electronics_power;
    if (motion->rolling > 0) {
        const int64_t pushed = limited(motion->effort * JP_Q24_ONE / (motion->rolling * (int64_t)WHEELS), FORCE_MAX);
        const int64_t bend = limited(q24_product(model->cornering, motion->bend), (int64_t)JP_Q24(16));
        const int64_t lost = q24_product(q24_product(model->driving, model->weight), bend);

        for (int wheel = 0; wheel < (int)WHEELS; wheel++) {
            add_wheel(model, motion->speed[wheel], pushed, effect);
        }
        effect->power += lost;
        effect->change[JP_FOUR_WHEEL_WEIGHT] += lost;
    }
}

/* J in Q16. */
static int64_t steering_of(const struct jp_four_wheel_energy_model *model, const struct jp_four_wheel_piece *piece,
                           int64_t rolling)
{
    const int64_t turning = (int64_t)piece->travel * JP_Q24_ONE / ((int64_t)WHEELS * piece->duration);
    const int64_t scrubbing = q24_product(model->contact, limited(turning, (int64_t)JP_Q24(127))); /* q, Q24 */
    const int64_t all = jp_multiply_shift(model->steering, piece->travel, 16);

    return rolling == 0 ? all : all * scrubbing / length(scrubbing, rolling);
}

/* ---- Drives ---- */

static JP_INLINE_FOR_SPEED int64_t in_unit(const struct jp_four_wheel_energy_model *model, int64_t joules_q32)
{
    return limited(jp_round_shift64(joules_q32, (unsigned)(16 + model->unit_exponent)), ENERGY_MAX);
}

static JP_INLINE_FOR_SPEED int64_t over_time(const struct jp_four_wheel_energy_model *model, int64_t power,
                                             jp_q16 duration)
{
    return in_unit(model, limited(power, POWER_MAX) * duration);
}

static bool is_twist(const struct jp_twist *twist)
{
    return jp_is_between(twist->x, -SPEED_MAX, SPEED_MAX) && jp_is_between(twist->y, -SPEED_MAX, SPEED_MAX) &&
           jp_is_between(twist->turn_rate, -SPEED_MAX, SPEED_MAX);
}

static bool is_rise(jp_q24 rise)
{
    return jp_is_between(rise, -JP_Q24_ONE, JP_Q24_ONE);
}

enum jp_status jp_four_wheel_energy_add(const struct jp_four_wheel_energy_model *model,
                                        struct jp_four_wheel_drive *drive, const struct jp_four_wheel_piece *piece)
{
    struct four_wheel_effect effect;

    if (model == NULL || drive == NULL || piece == NULL || !is_twist(&piece->start) || !is_twist(&piece->end) ||
        !is_rise(piece->grade) || !is_rise(piece->bank) || !jp_is_between(piece->travel, 0, TRAVEL_MAX) ||
        !jp_is_between(piece->duration, 1, DURATION_MAX)) {
        return JP_ERR_ARGUMENT;
    }
    struct mean_twist motion;

    set_mean(model, piece, &motion);

    const int64_t steering = in_unit(model, steering_of(model, piece, motion.rolling) * JP_Q16_ONE);

    set_effect(model, &motion, &effect);
    drive->energy += over_time(model, effect.power, piece->duration) + steering;
    for (int factor = 0; factor < (int)JP_FOUR_WHEEL_FACTORS; factor++) {
        drive->change[factor] += over_time(model, effect.change[factor], piece->duration);
    }
    drive->change[JP_FOUR_WHEEL_STEERING] += steering;
    return JP_OK;
}

enum jp_status jp_four_wheel_energy_metre(const struct jp_four_wheel_energy_model *model, jp_q24 speed, jp_q24 grade,
                                          jp_q16 *joules)
{
    struct jp_four_wheel_drive drive = {0};

    if (model == NULL || joules == NULL || !jp_is_between(speed, SPEED_MIN, SPEED_MAX)) {
        return JP_ERR_ARGUMENT;
    }
    const struct jp_four_wheel_piece piece = {
        .start = {speed, 0, 0}, .end = {speed, 0, 0}, .grade = grade, .duration = jp_divide(ONE_METRE, speed)};
    const enum jp_status status = jp_four_wheel_energy_add(model, &drive, &piece);

    if (status != JP_OK) {
        return status;
    }
    const int64_t exact = model->unit_exponent < 0 ? jp_round_shift64(drive.energy, (unsigned)-model->unit_exponent)
                                                   : drive.energy * ((int64_t)1 << model->unit_exponent);

    *joules = jp_saturate32(exact);
    return *joules == exact ? JP_OK : JP_ERR_OVERFLOW;
}

/* ---- Factors ---- */

static JP_INLINE_FOR_SPEED int32_t times(int32_t value, jp_q16 factor, int32_t low, int32_t high)
{
    return jp_clamp32(jp_multiply_shift(value, factor, 16), low, high);
}

void jp_four_wheel_energy_scale(const struct jp_four_wheel_energy_model *model,
                                const jp_q16 factor[JP_FOUR_WHEEL_FACTORS], struct jp_four_wheel_energy_model *scaled)
{
    const jp_q16 weight = factor[JP_FOUR_WHEEL_WEIGHT];
    const jp_q16 square = jp_q16_multiply(weight, weight);

    *scaled = *model;
    scaled->rolling = times(model->rolling, factor[JP_FOUR_WHEEL_ROLLING], 0, JP_Q24(0.5));
    scaled->drag = jp_clamp32(jp_divide((int64_t)model->drag * JP_Q16_ONE, weight), 0, JP_Q24(1));
    scaled->weight = times(model->weight, weight, JP_Q16(1), JP_Q16(16384));
    scaled->copper_driving = times(model->copper_driving, square, 0, JP_Q16(16384));
    scaled->copper_braking = times(model->copper_braking, square, 0, JP_Q16(16384));
    scaled->steering = times(model->steering, factor[JP_FOUR_WHEEL_STEERING], 0, JP_Q16(1024));
    scaled->electronics_power = times(model->electronics_power, factor[JP_FOUR_WHEEL_ELECTRONICS], 0, JP_Q16(1024));
}
