#include <joulepath/pure_pursuit.h>

#include "src/base/config_check.h"
#include "src/base/integer.h"

#define SPEED_MAX  JP_Q24(16)
#define PERIOD_MAX JP_Q24_ONE
#define CHORD_MAX  ((int32_t)64 * 65536) /* m, Q16 */

/* Offsets saturate at 16 384 m, so that their squares fit. */
#define OFFSET_BITS 31

/* Farther ends do not limit the speed: from 16 m/s the least acceleration takes 1024 m, and a tick another 16 m. Q24 m
 */
#define STOPPING_MAX ((int64_t)1040 << 24)

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_pure_pursuit_config, member, low, high)

static enum jp_status check(const struct jp_pure_pursuit_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(speed, JP_Q24(0.01), SPEED_MAX),          FIELD(lookahead_time, JP_Q24(0.05), JP_Q24(8)),
        FIELD(lookahead_min, JP_Q24(0.05), JP_Q24(8)),  FIELD(lookahead_max, 0, JP_Q24(64)),
        FIELD(curvature_max, JP_Q24(0.01), JP_Q24(16)), FIELD(lateral_acceleration, JP_Q24(0.01), JP_Q24(16)),
        FIELD(acceleration, JP_Q24(0.125), JP_Q24(16)), FIELD(tolerance, JP_Q24(0.005), JP_Q24(1)),
    };
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status == JP_OK && config->lookahead_max < config->lookahead_min) {
        return jp_config_refuse("lookahead_max", field);
    }
    return status;
}

enum jp_status jp_pure_pursuit_init(struct jp_pure_pursuit *tracker, const struct jp_pure_pursuit_config *config,
                                    const char **field)
{
    if (tracker == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const enum jp_status status = check(config, field);
    if (status == JP_OK) {
        *tracker = (struct jp_pure_pursuit){.config = *config};
    }
    return status;
}

/* From one point to another, m in Q16; saturated at ±16 384 m. */
struct offset {
    int32_t x;
    int32_t y;
};

static struct offset offset_of(const struct jp_point *from, const struct jp_point *to)
{
    return (struct offset){jp_saturate_bits(jp_sub(to->x, from->x), OFFSET_BITS),
                           jp_saturate_bits(jp_sub(to->y, from->y), OFFSET_BITS)};
}

/* Q32 m², at most 2⁶¹. */
static int64_t dot(struct offset a, struct offset b)
{
    return jp_multiply(a.x, b.x) + jp_multiply(a.y, b.y);
}

static int64_t square(jp_q24 distance)
{
    return jp_round_shift64(jp_multiply(distance, distance), 16); /* Q32 */
}

/* √ of a square in Q32, m in Q24; of a chord or of something within the lookahead. */
static jp_q24 root(int64_t square_q32)
{
    return jp_saturate32((int64_t)jp_square_root((uint64_t)square_q32 << 16));
}

static struct offset chord_of(const struct jp_pure_pursuit *tracker, size_t index)
{
    return offset_of(&tracker->path[index], &tracker->path[index + 1U]);
}

static jp_q24 chord_length(const struct jp_point *path, size_t index)
{
    const struct offset chord = offset_of(&path[index], &path[index + 1U]);

    return root(dot(chord, chord));
}

static bool is_chord(const struct jp_point *path, size_t index)
{
    const struct offset chord = offset_of(&path[index], &path[index + 1U]);

    return jp_is_between(chord.x, -CHORD_MAX, CHORD_MAX) && jp_is_between(chord.y, -CHORD_MAX, CHORD_MAX) &&
           jp_is_between(chord_length(path, index), 1, JP_Q24(64));
}

enum jp_status jp_pure_pursuit_follow(struct jp_pure_pursuit *tracker, const struct jp_point *path, size_t count)
{
    int64_t beyond = 0;
    if (tracker == NULL || path == NULL || count < 2U) {
        return JP_ERR_ARGUMENT;
    }
    for (size_t i = 0; i + 1U < count; i++) {
        if (!is_chord(path, i)) {
            return JP_ERR_ARGUMENT;
        }
        beyond += i > 0U ? chord_length(path, i) : 0;
    }
    tracker->path = path;
    tracker->count = count;
    tracker->passed = 0;
    tracker->beyond = beyond;
    return JP_OK;
}

/* Square of the distance from the robot, Q32, of the point of a chord that is nearest to it. */
static int64_t chord_distance(struct offset start, struct offset chord)
{
    const int64_t whole = dot(chord, chord);
    const int64_t along = -dot(start, chord);
    const uint64_t inside = along < 0 ? 0U : (uint64_t)(along < whole ? along : whole);
    const uint64_t part = (inside << 19) / (uint64_t)whole; /* Q19 */
    const struct offset nearest = {start.x + (int32_t)((chord.x * (int64_t)part) >> 19),
                                   start.y + (int32_t)((chord.y * (int64_t)part) >> 19)};

    return dot(nearest, nearest);
}

struct path_place {
    size_t chord;
    int64_t distance; /* its square, Q32 */
};

/* The chord nearest to the robot, at most as far ahead as to where the path leaves the circle of the lookahead. */
static struct path_place nearest_place(const struct jp_pure_pursuit *tracker, const struct jp_point *position,
                                       int64_t lookahead)
{
    const size_t last = tracker->count - 2U;
    const size_t farthest = tracker->passed + (size_t)JP_PURSUIT_STRIDE;
    struct path_place nearest = {tracker->passed, INT64_MAX};
    bool leaves = false;

    for (size_t i = tracker->passed; !leaves && i <= last && i <= farthest; i++) {
        const struct offset end = offset_of(position, &tracker->path[i + 1U]);
        const int64_t distance = chord_distance(offset_of(position, &tracker->path[i]), chord_of(tracker, i));

        nearest = distance <= nearest.distance ? (struct path_place){i, distance} : nearest;
        leaves = nearest.distance < lookahead && dot(end, end) >= lookahead;
    }
    return nearest;
}

static void pass_to(struct jp_pure_pursuit *tracker, size_t chord)
{
    while (tracker->passed < chord) {
        tracker->passed++;
        tracker->beyond -= chord_length(tracker->path, tracker->passed);
    }
}

/* The chord on which the path leaves the circle, or the last one that is looked at. */
static size_t leaving_chord(const struct jp_pure_pursuit *tracker, const struct jp_point *position, int64_t lookahead)
{
    const size_t last = tracker->count - 2U;
    const size_t farthest = tracker->passed + (size_t)JP_PURSUIT_AHEAD;
    size_t i = tracker->passed;
    bool inside = true;

    while (inside && i < last && i < farthest) {
        const struct offset end = offset_of(position, &tracker->path[i + 1U]);
        inside = dot(end, end) < lookahead;
        i += inside ? 1U : 0U;
    }
    return i;
}

/* The line through a chord, seen from the robot. */
struct course {
    jp_angle direction;
    jp_q24 offset; /* of the line to the left of the robot, looking along it, m */
    jp_q24 left;   /* along the line from the robot to the chord's end, m; both saturated */
};

static struct course course_of(const struct jp_pure_pursuit *tracker, const struct jp_point *position, size_t index)
{
    const struct offset chord = chord_of(tracker, index);
    const struct offset end = offset_of(position, &tracker->path[index + 1U]);
    const jp_angle direction = jp_atan2(chord.y, chord.x);
    const jp_q31 cosine = jp_cos(direction);
    const jp_q31 sine = jp_sin(direction);

    return (struct course){
        .direction = direction,
        .offset = jp_round_shift(jp_multiply(end.y, cosine) - jp_multiply(end.x, sine), 23),
        .left = jp_round_shift(jp_multiply(end.x, cosine) + jp_multiply(end.y, sine), 23),
    };
}

/* The point to which the arc leads, seen from the robot: forward and to the left, m. */
struct target {
    jp_q24 x;
    jp_q24 y;
    jp_q24 distance;
};

/* Where the line leaves the circle, or the foot of the perpendicular when it is outside. */
static struct target target_on(const struct course *course, jp_angle heading, jp_q24 lookahead)
{
    const jp_angle angle = course->direction - heading;
    const jp_q31 cosine = jp_cos(angle);
    const jp_q31 sine = jp_sin(angle);
    const int64_t square_along =
        jp_multiply(lookahead, lookahead) - jp_multiply(course->offset, course->offset); /* Q48 */
    const jp_q24 along = square_along > 0 ? (jp_q24)jp_square_root((uint64_t)square_along) : 0;
    const jp_q24 foot = course->offset < 0 ? jp_sub(0, course->offset) : course->offset;

    return (struct target){
        .x = jp_round_shift(jp_multiply(along, cosine) - jp_multiply(course->offset, sine), 31),
        .y = jp_round_shift(jp_multiply(along, sine) + jp_multiply(course->offset, cosine), 31),
        .distance = foot > lookahead ? foot : lookahead,
    };
}

static jp_q24 curvature_to(const struct jp_pure_pursuit_config *config, const struct target *target)
{
    if (target->x < 0) {
        return target->y < 0 ? -config->curvature_max : config->curvature_max;
    }
    const int32_t sine = jp_divide((int64_t)target->y * ((int64_t)1 << 30), target->distance); /* Q30 */
    const jp_q24 curvature = jp_divide((int64_t)sine * ((int64_t)1 << 19), target->distance);

    return jp_clamp32(curvature, -config->curvature_max, config->curvature_max);
}

static jp_q24 lesser(jp_q24 a, jp_q24 b)
{
    return a < b ? a : b;
}

/* √(acceleration/|κ|) */
static jp_q24 speed_in_curve(const struct jp_pure_pursuit_config *config, jp_q24 curvature)
{
    const int64_t acceleration = (int64_t)config->lateral_acceleration * ((int64_t)1 << 22);
    const int32_t square_of_speed = jp_divide(acceleration, jp_absolute32(curvature)); /* Q22 */

    return (jp_q24)jp_square_root((uint64_t)square_of_speed << 26);
}

/* The speed v from which the robot stops within the remaining distance after one more tick at v, whose braking changes
 * the speed by `step`: v² + 2 v step = 2 a remaining. */
static jp_q24 speed_to_stop(const struct jp_pure_pursuit_config *config, int64_t remaining, jp_q24 step)
{
    const int64_t limited = remaining < STOPPING_MAX ? remaining : STOPPING_MAX;
    const int64_t braking = config->acceleration * limited; /* Q48 */
    const uint64_t square_of_speed = (uint64_t)jp_multiply(step, step) + 2U * (uint64_t)braking;

    return jp_saturate32((int64_t)jp_square_root(square_of_speed) - step);
}

/* While the robot is too fast for the curvature, it drives a smaller one. */
static jp_q24 tame_curvature(const struct jp_pure_pursuit_config *config, jp_q24 curvature, jp_q24 speed)
{
    const int64_t acceleration = (int64_t)config->lateral_acceleration * ((int64_t)1 << 22);
    const jp_q24 most = jp_divide(acceleration, jp_multiply_shift(speed, speed, 26));

    return jp_clamp32(curvature, -most, most);
}

static bool are_arguments(const struct jp_pure_pursuit *tracker, const struct jp_point *position, jp_q24 speed,
                          jp_q24 period)
{
    return tracker != NULL && position != NULL && jp_is_between(speed, -SPEED_MAX, SPEED_MAX) &&
           jp_is_between(period, 1, PERIOD_MAX);
}

enum jp_status jp_pure_pursuit_tick(struct jp_pure_pursuit *tracker, const struct jp_point *position, jp_angle heading,
                                    jp_q24 speed, jp_q24 period, struct jp_twist *twist)
{
    if (twist == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *twist = (struct jp_twist){0, 0, 0};
    if (!are_arguments(tracker, position, speed, period)) {
        return JP_ERR_ARGUMENT;
    }
    if (tracker->path == NULL) {
        return JP_ERR_NO_PLAN;
    }
    if (tracker->passed == tracker->count) {
        return JP_ARRIVED;
    }
    const struct jp_pure_pursuit_config *config = &tracker->config;
    const jp_q24 wanted = jp_q24_multiply(config->lookahead_time, jp_absolute32(speed));
    const jp_q24 lookahead = jp_clamp32(wanted, config->lookahead_min, config->lookahead_max);
    const struct path_place place = nearest_place(tracker, position, square(lookahead));
    if (place.distance > square(config->lookahead_max)) {
        return JP_ERR_OUTSIDE;
    }
    pass_to(tracker, place.chord);
    const struct course here = course_of(tracker, position, tracker->passed);
    const int64_t remaining = tracker->beyond + (here.left > 0 ? here.left : 0);
    if (remaining <= config->tolerance) {
        tracker->passed = tracker->count;
        return JP_ARRIVED;
    }
    const struct course ahead = course_of(tracker, position, leaving_chord(tracker, position, square(lookahead)));
    const struct target target = target_on(&ahead, heading, lookahead);
    const jp_q24 curvature = curvature_to(config, &target);
    const jp_q24 step = jp_q24_multiply(config->acceleration, period);
    const jp_q24 safe = lesser(speed_in_curve(config, curvature), speed_to_stop(config, remaining, step));

    twist->x = jp_clamp32(lesser(config->speed, safe), speed - step, speed + step);
    twist->turn_rate = jp_q24_multiply(twist->x, tame_curvature(config, curvature, twist->x));
    return JP_OK;
}
