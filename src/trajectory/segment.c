#include <joulepath/segment.h>

#include "src/base/config_check.h"
#include "src/base/integer.h"
#include "src/trajectory/segment_arc.h"
#include "src/trajectory/segment_geometry.h"
#include "src/trajectory/segment_math.h"
#include "src/trajectory/segment_problem.h"
#include "src/trajectory/segment_search.h"

/* 135° as a wrapping angle. */
#define LONG_HALF_ARC ((uint32_t)3 << 29)

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
    if (jp_magnitude32(best->x) > LONG_HALF_ARC && best->x != end) {
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

#define FIELD(member, low, high) JP_CONFIG_FIELD("limits.", struct jp_segment_limits, member, low, high)

enum jp_status jp_segment_limits_check(const struct jp_segment_limits *limits, const struct jp_energy_model *model,
                                       const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(speed, 1, JP_Q24(8)),
        FIELD(turn_rate, 1, JP_Q24(8)),
        FIELD(turn, 0, JP_Q24(3.141592653589793)),
        FIELD(duration, JP_SEGMENT_DURATION_MIN, JP_Q16(16384)),
    };
    const enum jp_status status = jp_config_check(limits, fields, JP_CONFIG_COUNT(fields), field);

    if (status == JP_OK && model != NULL && limits->duration < model->settling_time) {
        return jp_config_refuse("limits.duration", field);
    }
    return status;
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

struct jp_point jp_segment_turning_point(jp_q16 yaw_bandwidth, jp_q24 speed, const struct jp_point *start,
                                         jp_angle heading, jp_q24 turn)
{
    jp_angle turned = heading + jp_angle_from_radians(turn);
    jp_q24 way = jp_q16_divide(jp_add(speed, speed), yaw_bandwidth);

    return (struct jp_point){
        .x = jp_add(start->x, jp_multiply_shift(way, jp_sub(jp_cos(heading) / 2, jp_cos(turned) / 2), 38)),
        .y = jp_add(start->y, jp_multiply_shift(way, jp_sub(jp_sin(heading) / 2, jp_sin(turned) / 2), 38)),
    };
}
