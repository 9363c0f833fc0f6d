#include <joulepath/skid_steer.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/integer.h"

#define MOTION_MAX   JP_Q24(8)
#define GRADE_MAX    JP_Q24_ONE
#define DURATION_MAX JP_Q16(256)
#define CURRENT_MAX  JP_Q16(2047)

/* μt = μ / (0.925 + 0.15 R/B) */
#define LATERAL_AT_PIVOT   JP_Q24(0.925)
#define LATERAL_PER_RADIUS JP_Q24(0.15)

enum { LEFT, RIGHT, SIDES };

/* What each side does. */
struct sides {
    int32_t speed[SIDES]; /* m/s in Q24, |speed| <= 24 */
    jp_q16 force[SIDES];  /* N */
    bool overflow;
};

static bool is_motion(const struct jp_motion *motion)
{
    return jp_is_between(motion->speed, -MOTION_MAX, MOTION_MAX) &&
           jp_is_between(motion->turn_rate, -MOTION_MAX, MOTION_MAX);
}

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_skid_steer_config, member, low, high)

enum jp_status jp_skid_steer_check(const struct jp_skid_steer_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(wheel_radius, JP_Q24(0.01), JP_Q24(1)),
        FIELD(width, JP_Q24(0.05), JP_Q24(4)),
        FIELD(wheelbase, 0, JP_Q24(4)),
        FIELD(weight, JP_Q16(1), JP_Q16(16384)),
        FIELD(rolling, 0, JP_Q24(0.5)),
        FIELD(friction, 0, JP_Q24(2)),
        FIELD(torque_per_ampere, JP_Q16(0.01), JP_Q16(16384)),
        FIELD(resistance, 0, JP_Q24(100)),
        FIELD(efficiency, JP_Q24(0.1), JP_Q24(1)),
        FIELD(recuperation, 0, JP_Q24(1)),
        FIELD(electronics_power, 0, JP_Q16(1024)),
        FIELD(distance_energy, 0, JP_Q16(1024)),
    };

    return jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);
}

static int32_t sign(int32_t x)
{
    return (x > 0) - (x < 0);
}

/* x / 2^shift to nearest, ties away from zero: backwards costs what forwards does. */
static JP_INLINE_FOR_SPEED int64_t rounded(int64_t x, unsigned shift)
{
    const int64_t size = (jp_absolute64(x) + ((int64_t)1 << (shift - 1))) >> shift;

    return x < 0 ? -size : size;
}

/* x / divisor to nearest; divisor > 0. */
static JP_INLINE_FOR_SPEED int64_t divided(int64_t x, int64_t divisor)
{
    return (x < 0 ? x - divisor / 2 : x + divisor / 2) / divisor;
}

static void set_speeds(const struct jp_skid_steer_config *config, const struct jp_motion *motion, struct sides *sides)
{
    const int32_t across = (int32_t)rounded((int64_t)motion->turn_rate * config->width, 25);

    sides->speed[LEFT] = motion->speed - across;
    sides->speed[RIGHT] = motion->speed + across;
}

/* M/B in N, Q16: μ G l |w| / (4 (0.925 B |w| + 0.15 |v|)), against the turn. */
static int64_t turning_force(const struct jp_skid_steer_config *config, const struct jp_motion *motion)
{
    const int64_t grip = rounded((int64_t)config->friction * config->wheelbase, 24);        /* Q24, at most 8 */
    const int64_t moment = rounded(grip * config->weight, 24);                              /* Q16, at most 2³³ */
    const int64_t pivot = rounded((int64_t)config->width * LATERAL_AT_PIVOT, 24);           /* Q24 */
    const int64_t turning = rounded(pivot * jp_absolute64(motion->turn_rate), 16);          /* Q32 */
    const int64_t driving = rounded(LATERAL_PER_RADIUS * jp_absolute64(motion->speed), 16); /* Q32 */
    const int64_t slip = 4 * (turning + driving);                                           /* at most 2⁴⁰ */
    const int64_t effort = moment * motion->turn_rate;                                      /* Q40, at most 2⁶⁰ */

    return slip == 0 ? 0 : effort / slip * 256 + divided(effort % slip * 256, slip);
}

static void set_force(struct sides *sides, int side, int64_t force)
{
    sides->force[side] = jp_saturate32(force);
    sides->overflow = sides->overflow || sides->force[side] != force;
}

static void set_sides(const struct jp_skid_steer_config *config, const struct jp_motion *motion, jp_q24 grade,
                      struct sides *sides)
{
    set_speeds(config, motion, sides);
    sides->overflow = false;

    const int64_t rolling = rounded((int64_t)config->weight * config->rolling, 25);
    const int64_t climbing = sign(motion->speed) * rounded((int64_t)config->weight * grade, 25);
    const int64_t turning = turning_force(config, motion);
    set_force(sides, LEFT, sign(sides->speed[LEFT]) * rolling + climbing - turning);
    set_force(sides, RIGHT, sign(sides->speed[RIGHT]) * rolling + climbing + turning);
}

enum jp_status jp_skid_steer_wheel_speeds(const struct jp_skid_steer_config *config, const struct jp_motion *motion,
                                          struct jp_skid_steer_sides *speeds)
{
    struct sides sides;
    if (config == NULL || motion == NULL || speeds == NULL || !is_motion(motion)) {
        return JP_ERR_ARGUMENT;
    }
    set_speeds(config, motion, &sides);
    speeds->left = (jp_q16)divided((int64_t)sides.speed[LEFT] * JP_Q16_ONE, config->wheel_radius);
    speeds->right = (jp_q16)divided((int64_t)sides.speed[RIGHT] * JP_Q16_ONE, config->wheel_radius);
    return JP_OK;
}

enum jp_status jp_skid_steer_torques(const struct jp_skid_steer_config *config, const struct jp_motion *motion,
                                     jp_q24 grade, struct jp_skid_steer_sides *torques)
{
    struct sides sides;
    if (config == NULL || motion == NULL || torques == NULL || !is_motion(motion) ||
        !jp_is_between(grade, -GRADE_MAX, GRADE_MAX)) {
        return JP_ERR_ARGUMENT;
    }
    set_sides(config, motion, grade, &sides);
    torques->left = jp_multiply_shift(sides.force[LEFT], config->wheel_radius, 24);
    torques->right = jp_multiply_shift(sides.force[RIGHT], config->wheel_radius, 24);
    return sides.overflow ? JP_ERR_OVERFLOW : JP_OK;
}

/* W in Q16 (eq. 8, 9). */
static int64_t side_power(const struct jp_skid_steer_config *config, enum jp_cost_kind kind, struct sides *sides,
                          int side)
{
    const int64_t work = rounded((int64_t)sides->force[side] * sides->speed[side], 24);
    const int64_t torque = (int64_t)sides->force[side] * config->wheel_radius; /* Q40 */
    int64_t current = divided(torque / 256, (int64_t)config->torque_per_ampere);
    const bool returns = kind == JP_COST_PHYSICAL && work < 0;
    const int64_t share = rounded((int64_t)config->recuperation * config->efficiency, 24); /* Q24 */
    const int64_t mechanical = returns ? rounded(work * share, 24) : divided(work * JP_Q24_ONE, config->efficiency);

    if (jp_absolute64(current) > CURRENT_MAX) {
        sides->overflow = true;
        current = CURRENT_MAX;
    }
    const int64_t voltage = rounded(current * config->resistance, 24);
    return mechanical + rounded(voltage * current, 16);
}

static bool are_arguments(const struct jp_skid_steer_config *config, enum jp_cost_kind kind,
                          const struct jp_motion *motion, jp_q24 grade)
{
    return config != NULL && motion != NULL && (kind == JP_COST_PHYSICAL || kind == JP_COST_PAPER) &&
           is_motion(motion) && jp_is_between(grade, -GRADE_MAX, GRADE_MAX);
}

enum jp_status jp_skid_steer_power(const struct jp_skid_steer_config *config, enum jp_cost_kind kind,
                                   const struct jp_motion *motion, jp_q24 grade, jp_q16 *power)
{
    struct sides sides;
    if (power == NULL || !are_arguments(config, kind, motion, grade)) {
        return JP_ERR_ARGUMENT;
    }
    set_sides(config, motion, grade, &sides);
    const int64_t electronics = kind == JP_COST_PHYSICAL ? config->electronics_power : 0;
    const int64_t sum = side_power(config, kind, &sides, LEFT) + side_power(config, kind, &sides, RIGHT) + electronics;

    *power = jp_saturate32(sum);
    return sides.overflow || *power != sum ? JP_ERR_OVERFLOW : JP_OK;
}

jp_q16 jp_skid_steer_power_of(const void *config, const struct jp_motion *motion, jp_q24 grade)
{
    jp_q16 power = 0;

    (void)jp_skid_steer_power(config, JP_COST_PHYSICAL, motion, grade, &power);
    return power;
}

/* Grade: rise over distance, both m in Q24; INT32_MAX when the rise exceeds the distance. */
static int32_t grade_of(jp_q24 rise, int64_t distance)
{
    if (jp_absolute64(rise) > distance) {
        return INT32_MAX;
    }
    return distance == 0 ? 0 : (int32_t)divided((int64_t)rise * JP_Q24_ONE, distance);
}

/* J in Q16: α|v|T + μ G rise. */
static int64_t paper_terms(const struct jp_skid_steer_config *config, int64_t distance, jp_q24 rise)
{
    const int64_t drag = rounded((int64_t)config->weight * config->friction, 24); /* Q16 */

    return rounded(config->distance_energy * distance, 24) + rounded(drag * rise, 24);
}

enum jp_status jp_skid_steer_energy(const struct jp_skid_steer_config *config, enum jp_cost_kind kind,
                                    const struct jp_motion *motion, jp_q24 rise, jp_q16 duration, jp_q16 *energy)
{
    jp_q16 power = 0;
    if (energy == NULL || motion == NULL || !is_motion(motion) || !jp_is_between(duration, 0, DURATION_MAX)) {
        return JP_ERR_ARGUMENT;
    }
    const int64_t distance = rounded(jp_absolute64(motion->speed) * duration, 16); /* m in Q24, at most 2³⁵ */
    const enum jp_status status = jp_skid_steer_power(config, kind, motion, grade_of(rise, distance), &power);
    if (status == JP_ERR_ARGUMENT) {
        return status;
    }
    const int64_t driven = rounded((int64_t)power * duration, 16);
    const bool physical = kind == JP_COST_PHYSICAL;
    const int64_t least = physical ? rounded((int64_t)config->electronics_power * duration, 16) : 0;
    const int64_t sum = physical ? driven : driven + paper_terms(config, distance, rise);
    const int64_t limited = sum < least ? least : sum;

    *energy = jp_saturate32(limited);
    return *energy != limited ? JP_ERR_OVERFLOW : status;
}
