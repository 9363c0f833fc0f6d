#include <joulepath/segment.h>

#include "segment_arc.h"
#include "segment_geometry.h"
#include "segment_math.h"
#include "segment_problem.h"
#include "segment_search.h"
#include "shared.h"

#define FOUR_PI_Q27 ((int32_t)1686629713)

/* 135° as a wrapping angle. */
#define LONG_HALF_ARC ((uint32_t)3 << 29)

/* The duration, or a longer one in which `way` is not passed too fast: a product of a duration and a limit. */
static JP_SHARED jp_q16 long_enough(jp_q16 duration, uint64_t way, jp_q24 limit)
{
    uint32_t divisor = (uint32_t)limit;

    if ((uint64_t)(uint32_t)duration * divisor >= way) {
        return duration;
    }

    uint64_t quotient = (way + divisor - 1U) / divisor;

    return quotient > (uint64_t)INT32_MAX ? INT32_MAX : (jp_q16)quotient;
}

static jp_q24 arc_angle(int32_t x)
{
    return (jp_q24)(((int64_t)x * FOUR_PI_Q27 + ((int64_t)1 << 34)) >> 35);
}

/* The duration of an optimum in Q16, rounded so that the arc of this length (Q22) and angle passes no limit. */
static jp_q16 duration_within(const struct jp_segment_limits *limits, jp_q16 time_min, int32_t xi, uint64_t length,
                              jp_q24 angle)
{
    unsigned zeros;
    uint32_t inverse = jp_reciprocal((uint32_t)xi, &zeros);
    jp_q16 duration = (jp_q16)(((uint64_t)(uint32_t)time_min * inverse) >> (32U - zeros));

    duration = jp_clamp32(duration, time_min, limits->duration);
    duration = long_enough(duration, length << 18, limits->speed);
    duration = long_enough(duration, (uint64_t)magnitude(angle) << 16, limits->turn_rate);
    return duration < limits->duration ? duration : limits->duration;
}

/* The motion along an arc of this length (Q22) and angle. */
static struct jp_motion motion_along(const struct jp_segment_limits *limits, uint64_t length, jp_q24 angle,
                                     jp_q16 duration)
{
    unsigned zeros;
    uint32_t inverse = jp_reciprocal((uint32_t)duration, &zeros);
    unsigned drop = (length >> 31) == 0U ? 0U : 4U;
    uint64_t scaled = (length >> drop) * inverse;
    jp_q24 speed = jp_round_shift((int64_t)scaled, 44U - zeros - drop);
    jp_q24 turn_rate = jp_round_shift(angle * (int64_t)inverse, 46U - zeros);

    return (struct jp_motion){.speed = jp_clamp32(speed, 0, limits->speed),
                              .turn_rate = jp_clamp32(turn_rate, -limits->turn_rate, limits->turn_rate)};
}

void jp_segment_store(const struct jp_segment_limits *limits, uint32_t distance, jp_angle bearing, jp_q16 time_min,
                      int32_t x, int32_t xi, struct jp_segment *segment)
{
    struct jp_arc arc;

    jp_arc_at(x, &arc);

    uint64_t length = ((uint64_t)distance * (uint32_t)arc.shape) >> 27; /* Q22 */
    jp_q24 angle = arc_angle(x);
    jp_q16 duration = duration_within(limits, time_min, xi, length, angle);
    jp_q24 turn = jp_angle_to_radians(bearing - (uint32_t)x);

    *segment = (struct jp_segment){
        .command = {.motion = motion_along(limits, length, angle, duration),
                    .turn = jp_clamp32(turn, -limits->turn, limits->turn),
                    .duration = duration},
        .arc = angle,
        .length = (jp_q16)((length + 32U) >> 6),
    };
}

enum jp_status jp_segment_polar(const struct jp_point *from, const struct jp_point *to, uint32_t *distance,
                                jp_angle *direction)
{
    int32_t dx = jp_sub(to->x, from->x); /* saturated is too far, too */
    int32_t dy = jp_sub(to->y, from->y);
    if (magnitude(dx) > (uint32_t)JP_SEGMENT_LENGTH_MAX || magnitude(dy) > (uint32_t)JP_SEGMENT_LENGTH_MAX) {
        return JP_ERR_ARGUMENT;
    }
    int64_t square = (int64_t)dx * dx + (int64_t)dy * dy;
    if (square > (int64_t)JP_SEGMENT_LENGTH_MAX * JP_SEGMENT_LENGTH_MAX) {
        return JP_ERR_ARGUMENT;
    }
    if (square < (int64_t)JP_SEGMENT_LENGTH_MIN * JP_SEGMENT_LENGTH_MIN) {
        return JP_ERR_ZERO_LENGTH;
    }
    *direction = jp_atan2(dy, dx);
    *distance = (uint32_t)(((int64_t)dx * jp_cos(*direction) + (int64_t)dy * jp_sin(*direction)) >> 25);
    return JP_OK;
}

jp_q16 jp_segment_shortest(jp_q16 least, const struct jp_segment_limits *limits, uint32_t distance)
{
    jp_q16 duration = least < JP_SEGMENT_DURATION_MIN ? JP_SEGMENT_DURATION_MIN : least;

    return long_enough(duration, (uint64_t)distance << 18, limits->speed);
}

/* The limit of |σ| as a binary angle, rounded to the safe side. */
static int32_t largest_turn(const struct jp_segment_limits *limits)
{
    jp_angle turn = jp_angle_from_radians(limits->turn);
    if (turn == 0U) {
        return 0;
    }
    return turn > (jp_angle)INT32_MAX ? INT32_MAX : (int32_t)(uint32_t)(turn - 1U);
}

/* The best arc: the target may be reached round the left and round the right. Beyond 135° an arc grows so fast that
 * J* can fall again towards its end when the robot was faster before. */
static void find_best(const struct jp_segment_problem *p, int64_t turn, struct jp_evaluation *best)
{
    int32_t reach = jp_segment_longest_half_arc(p);
    int evaluations = JP_SEGMENT_EVALUATIONS;
    int64_t centre = p->bearing;
    int32_t end = 0;

    best->x = 0;
    best->xi = 0;
    for (int side = 0; side < 2; side++) {
        int32_t low = jp_saturate32(centre - turn); /* saturated is out of reach */
        int32_t high = jp_saturate32(centre + turn);

        low = low < -reach ? -reach : low;
        high = high > reach ? reach : high;

        if (low <= high) {
            jp_segment_find_minimum(p, low, high, &evaluations, best);
            if (best->x >= low && best->x <= high) {
                end = best->x < 0 ? low : high;
            }
        }
        centre += centre > 0 ? -((int64_t)1 << 32) : (int64_t)1 << 32;
    }
    if (magnitude(best->x) > LONG_HALF_ARC && best->x != end) {
        jp_segment_try(p, end, &evaluations, best);
    }
}

enum jp_status jp_segment_optimise(const struct jp_energy_model *model, const struct jp_segment_limits *limits,
                                   const struct jp_motion *before, const struct jp_point *start, jp_angle heading,
                                   const struct jp_point *target, struct jp_segment *segment)
{
    if (!model || !limits || !before || !start || !target || !segment || !jp_motion_in_range(before)) {
        return JP_ERR_ARGUMENT;
    }

    uint32_t distance;
    jp_angle direction;
    enum jp_status status = jp_segment_polar(start, target, &distance, &direction);

    if (status != JP_OK) {
        return status;
    }

    jp_angle bearing = direction - heading;
    jp_q16 time_min = jp_segment_shortest(model->settling_time, limits, distance);

    if (time_min > limits->duration) {
        return JP_ERR_INFEASIBLE;
    }

    struct jp_segment_problem problem;
    struct jp_voltage_terms voltage;
    struct jp_evaluation best;

    jp_voltage_terms(model, before, &voltage);
    jp_segment_problem_build(&problem, model, limits, before, &voltage, distance, bearing, time_min);
    find_best(&problem, largest_turn(limits), &best);
    if (best.xi == 0) {
        return JP_ERR_INFEASIBLE;
    }

    struct jp_segment result;

    jp_segment_store(limits, distance, bearing, time_min, best.x, best.xi, &result);
    status = jp_energy_total(model, before, &voltage, &result.command, &result.energy);
    if (result.energy <= 0) {
        return JP_ERR_MODEL;
    }
    *segment = result;
    return status;
}

enum jp_status jp_segment_limits_check(const struct jp_segment_limits *limits, const struct jp_energy_model *model,
                                       const char **field)
{
    if (!limits || !model || !field) {
        return JP_ERR_ARGUMENT;
    }
    if (limits->speed <= 0 || limits->speed > JP_Q24(8)) {
        *field = "speed";
        return JP_ERR_CONFIG;
    }
    if (limits->turn_rate <= 0 || limits->turn_rate > JP_Q24(8)) {
        *field = "turn_rate";
        return JP_ERR_CONFIG;
    }
    if (limits->turn < 0 || limits->turn > JP_Q24(3.141592653589793)) {
        *field = "turn";
        return JP_ERR_CONFIG;
    }
    if (limits->duration < model->settling_time || limits->duration < JP_SEGMENT_DURATION_MIN ||
        limits->duration > JP_Q16(16384)) {
        *field = "duration";
        return JP_ERR_CONFIG;
    }
    return JP_OK;
}

enum jp_status jp_segment_end(const struct jp_segment *segment, const struct jp_point *start, jp_angle heading,
                              struct jp_point *end, jp_angle *end_heading)
{
    if (!segment || !start || !end || !end_heading) {
        return JP_ERR_ARGUMENT;
    }
    jp_angle turn = jp_angle_from_radians(segment->command.turn);
    jp_angle half = jp_angle_from_radians(segment->arc / 2);
    jp_angle direction = heading + turn + half;
    struct jp_arc arc;

    jp_arc_at(jp_clamp32((int32_t)half, -JP_HALF_ARC_MAX, JP_HALF_ARC_MAX), &arc);

    int64_t chord = ((int64_t)segment->length * arc.sinc) >> 21; /* Q24 */
    int64_t x_end = start->x + ((jp_term_scale(chord, jp_cos(direction), 31) + 128) >> 8);
    int64_t y_end = start->y + ((jp_term_scale(chord, jp_sin(direction), 31) + 128) >> 8);
    end->x = jp_saturate32(x_end);
    end->y = jp_saturate32(y_end);
    *end_heading = direction + half;
    return x_end == end->x && y_end == end->y ? JP_OK : JP_ERR_OVERFLOW;
}
