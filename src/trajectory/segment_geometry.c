#include "src/trajectory/segment_geometry.h"

#include "src/base/compiler.h"
#include "src/base/integer.h"
#include "src/trajectory/segment_arc.h"
#include "src/trajectory/segment_math.h"

#define FOUR_PI_Q27 ((int32_t)1686629713)

/* The duration, or the shortest one in which `travel` does not exceed `limit`: duration · limit >= travel. */
static JP_INLINE_FOR_SPEED jp_q16 long_enough(jp_q16 duration, uint64_t travel, jp_q24 limit)
{
    uint32_t divisor = (uint32_t)limit;

    if ((uint64_t)(uint32_t)duration * divisor >= travel) {
        return duration;
    }

    uint64_t quotient = (travel + divisor - 1U) / divisor;

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
    duration = long_enough(duration, (uint64_t)jp_magnitude32(angle) << 16, limits->turn_rate);
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
    if (jp_magnitude32(dx) > (uint32_t)JP_SEGMENT_LENGTH_MAX || jp_magnitude32(dy) > (uint32_t)JP_SEGMENT_LENGTH_MAX) {
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
