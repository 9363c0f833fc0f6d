#include "sim/missions/script.h"

#include <math.h>
#include <stdlib.h>

#include "sim/base/strict_math.h"

/** A Bézier path is followed in steps of this length. */
#define BEZIER_STEP_SECONDS 0.02

/* Of a speed over its limit. */
#define EXCESS_MAX 1.01

static bool allocate(struct script *script, size_t count)
{
    *script = (struct script){NULL, 0};
    if (count == 0) {
        return false;
    }
    script->steps = calloc(count, sizeof *script->steps);
    return script->steps != NULL;
}

static void append(struct script *script, const struct experiment_segment *segment, double seconds, size_t leg)
{
    script->steps[script->count++] = (struct script_step){experiment_command(segment, seconds), leg};
}

/** The turn from one heading to another, −π…π. */
static double turn_between(double from, double to)
{
    return remainder(to - from, 2 * M_PI);
}

static double bearing(struct bezier_point from, struct bezier_point to)
{
    return strict_atan2(to.y - from.y, to.x - from.x);
}

/** Where a robot that drives on by `way` while it turns would have turned at once. */
static struct bezier_point turning_point(struct bezier_point from, double way, double heading, double turned)
{
    return (struct bezier_point){from.x + way * (strict_cos(heading) - strict_cos(turned)),
                                 from.y + way * (strict_sin(heading) - strict_sin(turned))};
}

bool script_straight(struct script *script, const struct bezier_point *waypoints, size_t count, const double *durations,
                     double turn_lag)
{
    double heading = 0;
    double speed = 0;

    if (!allocate(script, count - 1)) {
        return false;
    }
    for (size_t leg = 0; leg + 1 < count; leg++) {
        const struct bezier_point to = waypoints[leg + 1];
        struct bezier_point from =
            turning_point(waypoints[leg], turn_lag * speed, heading, bearing(waypoints[leg], to));
        struct experiment_segment segment = {.turn = turn_between(heading, bearing(from, to))};

        speed = strict_hypot(to.x - from.x, to.y - from.y) / durations[leg];
        segment.speed = speed;
        append(script, &segment, durations[leg], leg);
        heading = bearing(from, to);
    }
    return true;
}

static size_t steps_of(double duration)
{
    return (size_t)fmax(round(duration / BEZIER_STEP_SECONDS), 1);
}

bool script_bezier(struct script *script, const struct bezier_path *path)
{
    size_t steps = 0;
    double heading = bezier_motion(path, 0, 0).heading;
    double turn = turn_between(0, heading);

    for (size_t curve = 0; curve < path->curves; curve++) {
        steps += steps_of(path->duration[curve]);
    }
    if (!allocate(script, steps)) {
        return false;
    }
    for (size_t curve = 0; curve < path->curves; curve++) {
        size_t count = steps_of(path->duration[curve]);

        for (size_t k = 0; k < count; k++) {
            double middle =
                BEZIER_STEP_SECONDS * ((double)k + 0.5) * path->duration[curve] / (BEZIER_STEP_SECONDS * (double)count);
            double end = path->duration[curve] * (double)(k + 1) / (double)count;
            double end_heading = bezier_motion(path, curve, end).heading;
            struct experiment_segment segment = {bezier_motion(path, curve, middle).speed,
                                                 turn_between(heading, end_heading) / BEZIER_STEP_SECONDS, turn};

            append(script, &segment, BEZIER_STEP_SECONDS, curve);
            heading = end_heading;
            turn = 0;
        }
    }
    return true;
}

void script_keep_limit(struct script *script, jp_q24 speed_max)
{
    for (size_t i = 0; i < script->count; i++) {
        struct jp_segment_command *command = &script->steps[i].command;
        const double ratio = (double)command->motion.speed / speed_max;

        if (ratio > 1 && ratio <= EXCESS_MAX) {
            command->motion.speed = speed_max;
            command->motion.turn_rate = (jp_q24)lround(command->motion.turn_rate / ratio);
            command->duration = (jp_q16)lround(command->duration * ratio);
        }
    }
}

void script_free(struct script *script)
{
    free(script->steps);
    script->steps = NULL;
}
