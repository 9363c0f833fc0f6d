#include <joulepath/path_speed.h>

#include <stddef.h>

#include "src/base/config_check.h"
#include "src/base/integer.h"
#include "src/trajectory/path_piece.h"

#define PRICE_MAX JP_Q16(16384)
#define GRADE_MAX JP_Q24_ONE

/** Slowest that a piece is driven, m/s or rad/s. */
#define SPEED_MIN JP_Q24(0.001)

/** Least acceleration along a curve, of which a set-point at any rate sees something, m/s². */
#define ACCELERATION_MIN JP_Q24(0.001)

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_path_limits, member, low, high)

enum jp_status jp_path_limits_check(const struct jp_path_limits *limits, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(speed, JP_Q24(0.01), JP_Q24(8)),         FIELD(turn_rate, JP_Q24(0.01), JP_Q24(8)),
        FIELD(side_speed, JP_Q24(0.01), JP_Q24(16)),   FIELD(width, JP_Q24(0.05), JP_Q24(4)),
        FIELD(acceleration, JP_Q24(0.01), JP_Q24(16)), FIELD(turn_acceleration, JP_Q24(0.01), JP_Q24(64)),
    };

    return jp_config_check(limits, fields, JP_CONFIG_COUNT(fields), field);
}

static int32_t smaller(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static int32_t larger(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

/** v² in Q48. */
static int64_t square(jp_q24 speed)
{
    return (int64_t)speed * speed;
}

/** √ of a Q48 that is not below 0. */
static jp_q24 root(int64_t squared)
{
    return jp_saturate32((int64_t)jp_square_root((uint64_t)squared));
}

static jp_q24 last_bend(const struct jp_path_piece *piece)
{
    return jp_piece_bend(piece, piece->length);
}

static jp_q24 sharpest_bend(const struct jp_path_piece *piece)
{
    return larger(jp_absolute32(piece->bend), jp_absolute32(last_bend(piece)));
}

/* Limits of a piece. */

/** Of the three parts of a change of the turn rate, κ v̇, κ' v² and that of a jump of κ, the first two have a quarter
 *  each, the last one has half: a robot that brakes towards the jump begins to blend at twice the square of the speed.
 */
static jp_q24 quarter(const struct jp_path_limits *limits)
{
    return limits->turn_acceleration / 4;
}

/** The greatest speed at which the curvature changes no faster than the turn rate may. */
static jp_q24 speed_by_bend_rate(const struct jp_path_piece *piece, const struct jp_path_limits *limits)
{
    const int32_t rate = jp_saturate32(jp_absolute64(piece->bend_rate));
    const jp_q24 squared = jp_q16_divide(quarter(limits), rate);

    return rate == 0 ? INT32_MAX : root((int64_t)squared * JP_Q24_ONE);
}

static jp_q24 curve_speed_max(const struct jp_path_piece *piece, const struct jp_path_limits *limits)
{
    const jp_q24 bend = sharpest_bend(piece);
    const jp_q24 outer = jp_add(JP_Q24_ONE, jp_multiply_shift(bend, limits->width, 25)); /* speed of the outer side */
    const jp_q24 by_turn_rate = jp_q24_divide(limits->turn_rate, bend);
    const jp_q24 by_side = jp_q24_divide(limits->side_speed, outer);
    const jp_q24 by_bend = smaller(by_turn_rate, speed_by_bend_rate(piece, limits));

    return larger(smaller(smaller(limits->speed, by_side), by_bend), SPEED_MIN);
}

static jp_q24 turn_rate_max(const struct jp_path_limits *limits)
{
    return smaller(limits->turn_rate, jp_q24_divide(jp_add(limits->side_speed, limits->side_speed), limits->width));
}

/* Costs of a piece. */

static int64_t power_at(const struct jp_path_piece *piece, const struct jp_motion_price *price, jp_q24 speed,
                        jp_q24 bend)
{
    const struct jp_motion motion = {speed, jp_q24_multiply(bend, speed)};

    return price->power(price->model, &motion, jp_clamp32(jp_piece_grade(piece), -GRADE_MAX, GRADE_MAX));
}

/** Mean over the piece at a speed: along a curve by Simpson's rule, W in Q16. */
static int64_t mean_power(const struct jp_path_piece *piece, const struct jp_motion_price *price, jp_q24 speed)
{
    if (piece->kind != JP_PIECE_CURVE) {
        const struct jp_motion motion = {0, piece->kind == JP_PIECE_TURN_LEFT ? speed : -speed};

        return price->power(price->model, &motion, 0);
    }

    const int64_t begin = power_at(piece, price, speed, piece->bend);

    if (jp_piece_is_straight(piece)) {
        return begin;
    }

    const int64_t middle = power_at(piece, price, speed, jp_piece_bend(piece, piece->length / 2));
    const int64_t end = power_at(piece, price, speed, last_bend(piece));

    return (begin + 4 * middle + end) / 6;
}

/** The speed up to a limit at which a metre costs least. */
static jp_q24 cheapest_speed(const struct jp_path_piece *piece, const struct jp_motion_price *price, jp_q24 limit)
{
    jp_q24 best = limit;
    int64_t least = mean_power(piece, price, limit) + price->time;

    for (int32_t step = JP_SPEED_STEPS - 1; step > 0; step--) {
        const jp_q24 speed = larger((jp_q24)((int64_t)limit * step / JP_SPEED_STEPS), SPEED_MIN);
        const int64_t cost = mean_power(piece, price, speed) + price->time;

        if (cost * best < least * speed) {
            best = speed;
            least = cost;
        }
    }
    return best;
}

/* Where two pieces meet. */

static jp_q24 jump_between(const struct jp_path_piece *last, const struct jp_path_piece *next)
{
    return jp_saturate32((int64_t)next->bend - last_bend(last));
}

/** By how much the curvature jumps at most at the ends of a piece, or is. */
static jp_q24 sharpest_change(const struct jp_lattice_path *path, unsigned i)
{
    const struct jp_path_piece *piece = &path->pieces[i];
    jp_q24 most = sharpest_bend(piece);

    if (i > 0U && piece[-1].kind == JP_PIECE_CURVE) {
        most = larger(most, jp_absolute32(jump_between(&piece[-1], piece)));
    }
    if (i + 1U < path->count && piece[1].kind == JP_PIECE_CURVE) {
        most = larger(most, jp_absolute32(jump_between(piece, &piece[1])));
    }
    return most;
}

static jp_q24 curve_acceleration(const struct jp_lattice_path *path, unsigned i, const struct jp_path_limits *limits)
{
    return larger(smaller(limits->acceleration, jp_q24_divide(quarter(limits), sharpest_change(path, i))),
                  ACCELERATION_MIN);
}

static void set_cruise(struct jp_lattice_path *path, unsigned i, const struct jp_path_limits *limits,
                       const struct jp_motion_price *price)
{
    struct jp_path_piece *piece = &path->pieces[i];
    const bool is_curve = piece->kind == JP_PIECE_CURVE;
    const jp_q24 limit = is_curve ? curve_speed_max(piece, limits) : turn_rate_max(limits);

    piece->speed = (struct jp_piece_speed){
        .cruise = cheapest_speed(piece, price, limit),
        .acceleration = is_curve ? curve_acceleration(path, i, limits) : limits->turn_acceleration,
    };
}

/** The greatest speed at which the jump fits into half of either piece. */
static jp_q24 meeting_speed(const struct jp_path_piece *last, const struct jp_path_piece *next,
                            const struct jp_path_limits *limits)
{
    if (last->kind != JP_PIECE_CURVE || next->kind != JP_PIECE_CURVE) {
        return 0;
    }
    const jp_q24 room = smaller(last->length, next->length) / 2;
    const jp_q24 squared =
        jp_divide((int64_t)limits->turn_acceleration / 2 * room, jp_absolute32(jump_between(last, next)));

    return smaller(smaller(last->speed.cruise, next->speed.cruise), root((int64_t)squared * JP_Q24_ONE));
}

/** `meeting`: the speed at the begin of `next`. */
static void set_blend(const struct jp_path_piece *last, struct jp_path_piece *next, jp_q24 meeting,
                      const struct jp_path_limits *limits)
{
    const int64_t jump = jump_between(last, next);
    const jp_q24 squared = jp_q24_multiply(meeting, meeting);

    next->speed.blend = jp_divide(jp_absolute64(2 * jump * squared), limits->turn_acceleration);
    next->speed.blend_rate = next->speed.blend == 0 ? 0 : jp_divide(jump * (1 << 15), next->speed.blend);
}

/* Passes along the path. */

/** The speed that is reached over a piece, at most `limit`. */
static jp_q24 reached(const struct jp_path_piece *piece, jp_q24 from, jp_q24 limit)
{
    const int64_t squared = square(from) + 2 * (int64_t)piece->speed.acceleration * piece->length;

    return squared < square(limit) ? root(squared) : limit;
}

static void limit_ends(struct jp_lattice_path *path, const struct jp_path_limits *limits)
{
    jp_q24 speed = 0;

    for (unsigned i = 0; i + 1U < path->count; i++) {
        struct jp_path_piece *piece = &path->pieces[i];

        speed = reached(piece, speed, meeting_speed(piece, &path->pieces[i + 1U], limits));
        piece->speed.end = speed;
    }
    path->pieces[path->count - 1U].speed.end = 0;
    for (unsigned i = path->count - 1U; i > 0U; i--) {
        const struct jp_path_piece *piece = &path->pieces[i];
        struct jp_path_piece *last = &path->pieces[i - 1U];

        last->speed.end = reached(piece, piece->speed.end, last->speed.end);
    }
}

/** Lowers the cruise to what can be reached and where it must be left from. */
static void set_brake(struct jp_path_piece *piece, jp_q24 begin)
{
    struct jp_piece_speed *speed = &piece->speed;
    const int64_t change = (int64_t)speed->acceleration * piece->length;
    const int64_t highest = (square(begin) + square(speed->end)) / 2 + change;
    const int64_t squared = square(speed->cruise);

    if (squared > highest) {
        speed->cruise = root(highest);
    }
    const int64_t way = (square(speed->cruise) - square(speed->end)) / speed->acceleration / 2;

    speed->brake_from = larger(piece->length - jp_saturate32(way), 0);
}

/* What it takes. */

struct path_sum {
    int64_t duration; /* s in Q16 */
    int64_t energy;   /* J in Q16 */
};

static void add_part(struct path_sum *sum, const struct jp_path_piece *piece, const struct jp_motion_price *price,
                     jp_q24 speed, jp_q16 duration)
{
    sum->duration += duration;
    sum->energy += jp_round_shift64(mean_power(piece, price, speed) * duration, 16);
}

/** J in Q16 of a change of v², Q48. */
static int64_t by_square(jp_q16 price, int64_t change)
{
    return jp_multiply(price, (int32_t)(change >> 24)) >> 24;
}

static void add_cost(struct path_sum *sum, const struct jp_path_piece *piece, const struct jp_motion_price *price,
                     jp_q24 begin)
{
    const struct jp_piece_speed *speed = &piece->speed;
    const jp_q16 to_cruise = jp_q16_divide(speed->cruise - begin, speed->acceleration);
    const jp_q16 to_end = jp_q16_divide(speed->cruise - speed->end, speed->acceleration);
    const int64_t first = (square(speed->cruise) - square(begin)) / speed->acceleration / 2;
    const jp_q16 on = jp_q16_divide(jp_saturate32(speed->brake_from - first), speed->cruise);

    add_part(sum, piece, price, (speed->cruise + begin) / 2, to_cruise);
    add_part(sum, piece, price, speed->cruise, on);
    add_part(sum, piece, price, (speed->cruise + speed->end) / 2, to_end);
    if (piece->kind == JP_PIECE_CURVE) {
        sum->energy += by_square(price->gain, square(speed->cruise) - square(begin));
        sum->energy -= by_square(price->recovery, square(speed->cruise) - square(speed->end));
    }
}

static bool is_price(const struct jp_motion_price *price)
{
    return price->power != NULL && jp_is_between(price->time, 0, PRICE_MAX) &&
           jp_is_between(price->gain, 0, PRICE_MAX) && jp_is_between(price->recovery, 0, PRICE_MAX);
}

enum jp_status jp_path_plan_speeds(struct jp_lattice_path *path, const struct jp_path_limits *limits,
                                   const struct jp_motion_price *price, struct jp_path_cost *cost)
{
    if (path == NULL || limits == NULL || price == NULL || cost == NULL || !is_price(price)) {
        return JP_ERR_ARGUMENT;
    }
    if (path->count == 0U) {
        return JP_ERR_NO_PLAN;
    }
    struct path_sum sum = {0, 0};
    jp_q24 begin = 0;

    for (unsigned i = 0; i < path->count; i++) {
        set_cruise(path, i, limits, price);
    }
    limit_ends(path, limits);
    for (unsigned i = 0; i < path->count; i++) {
        struct jp_path_piece *piece = &path->pieces[i];

        if (begin > 0) {
            set_blend(&path->pieces[i - 1U], piece, begin, limits);
        }
        set_brake(piece, begin);
        add_cost(&sum, piece, price, begin);
        begin = piece->speed.end;
    }
    *cost = (struct jp_path_cost){jp_saturate32(sum.duration), jp_saturate32(sum.energy)};
    return cost->duration == sum.duration && cost->energy == sum.energy ? JP_OK : JP_ERR_OVERFLOW;
}
