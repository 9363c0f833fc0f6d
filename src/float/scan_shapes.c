/* A scan becomes capsules: runs of points without a gap, split where they are farthest from their chord. */
#include <joulepath/obstacles.h>

#include "plane.h"

#define ANGLE_MAX     7.0f
#define LENGTH_MAX    1000.0f
#define TOLERANCE_MIN 0.001f

enum {
    DEPTH_MAX = 12,
    TRUSTED_PART = 4, /* one of so many beams must have worked */
};

/* What the parts of a scan are made of. */
struct seen {
    const struct jp_scan_config *config;
    const struct jp_scan *scan;
    struct jp_plane_pose first; /* of beam 0, from the sensor */
};

/* The points from a beam to another, both of which saw something. */
struct run {
    unsigned first;
    unsigned last;
};

/* Of a run: it ends at a beam and so many splits made it. */
struct part {
    unsigned last;
    unsigned depth;
};

/* Of a run from its chord. */
struct deviation {
    float square;
    unsigned beam; /* of the farthest point */
};

static bool is_config(const struct jp_scan_config *config)
{
    return config->range_max > 0.0f && config->range_max <= LENGTH_MAX && config->gap > 0.0f &&
           config->gap <= LENGTH_MAX && config->tolerance >= TOLERANCE_MIN && config->tolerance <= LENGTH_MAX &&
           config->beams_min > 0U;
}

static bool is_scan(const struct jp_scan *scan)
{
    return scan->ranges != NULL && scan->count >= 2U && jp_plane_is_within(scan->first_angle, ANGLE_MAX) &&
           scan->angle_step > 0.0f && scan->angle_step * (float)scan->count <= ANGLE_MAX;
}

static bool is_sensor(const struct jp_plane_pose *sensor)
{
    return jp_plane_is_within(sensor->x, JP_PLANE_MAX - LENGTH_MAX) &&
           jp_plane_is_within(sensor->y, JP_PLANE_MAX - LENGTH_MAX) &&
           jp_plane_is_within(sensor->heading, JP_PLANE_HEADING_MAX);
}

static bool is_trusted(const struct jp_scan *scan)
{
    unsigned working = 0;

    for (unsigned i = 0; i < scan->count; i++) {
        if (scan->ranges[i] >= 0.0f && jp_plane_is_finite(scan->ranges[i])) {
            working++;
        }
    }
    return working * TRUSTED_PART >= scan->count;
}

static bool is_point(const struct seen *seen, unsigned beam)
{
    return seen->scan->ranges[beam] > 0.0f && seen->scan->ranges[beam] <= seen->config->range_max;
}

static struct jp_plane_point point_of(const struct seen *seen, unsigned beam)
{
    const float range = seen->scan->ranges[beam];
    const struct jp_plane_point direction =
        jp_plane_direction(seen->first.heading + seen->scan->angle_step * (float)beam);

    return (struct jp_plane_point){seen->first.x + range * direction.x, seen->first.y + range * direction.y};
}

static float square_between(struct jp_plane_point a, struct jp_plane_point b)
{
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

/* Of a point from the chord between two others. */
static float square_from_chord(struct jp_plane_point point, struct jp_plane_point begin, struct jp_plane_point end)
{
    const struct jp_plane_point chord = {end.x - begin.x, end.y - begin.y};
    const struct jp_plane_point way = {point.x - begin.x, point.y - begin.y};
    const float length_square = chord.x * chord.x + chord.y * chord.y;
    const float along = way.x * chord.x + way.y * chord.y;

    if (along <= 0.0f) {
        return square_between(point, begin);
    }
    if (along >= length_square) {
        return square_between(point, end);
    }

    const float across = way.x * chord.y - way.y * chord.x;

    return across * across / length_square;
}

static struct deviation deviation_of(const struct seen *seen, const struct run *run)
{
    const struct jp_plane_point begin = point_of(seen, run->first);
    const struct jp_plane_point end = point_of(seen, run->last);
    struct deviation worst = {0.0f, run->first};

    for (unsigned i = run->first + 1U; i < run->last; i++) {
        if (is_point(seen, i)) {
            const float square = square_from_chord(point_of(seen, i), begin, end);

            if (square > worst.square) {
                worst = (struct deviation){square, i};
            }
        }
    }
    return worst;
}

/* How far the points of a run lie to the left of their chord. */
struct offsets {
    struct jp_plane_point normal; /* of the chord, to the left */
    float mean;
    float least;
    float most;
};

static struct offsets offsets_of(const struct seen *seen, const struct run *run)
{
    const struct jp_plane_point begin = point_of(seen, run->first);
    const struct jp_plane_point end = point_of(seen, run->last);
    const float inverse = 1.0f / jp_plane_square_root(square_between(begin, end));
    struct offsets offsets = {{(begin.y - end.y) * inverse, (end.x - begin.x) * inverse}, 0.0f, 0.0f, 0.0f};
    float count = 0.0f;

    for (unsigned i = run->first; i <= run->last; i++) {
        if (is_point(seen, i)) {
            const struct jp_plane_point point = point_of(seen, i);
            const float offset = (point.x - begin.x) * offsets.normal.x + (point.y - begin.y) * offsets.normal.y;

            offsets.mean += offset;
            offsets.least = offset < offsets.least ? offset : offsets.least;
            offsets.most = offset > offsets.most ? offset : offsets.most;
            count += 1.0f;
        }
    }
    offsets.mean /= count;
    return offsets;
}

static struct jp_plane_point shifted(struct jp_plane_point point, const struct offsets *offsets)
{
    return (struct jp_plane_point){point.x + offsets->mean * offsets->normal.x,
                                   point.y + offsets->mean * offsets->normal.y};
}

/* A chord through the middle of its points, wide enough for all of them. */
static void add_chord(struct jp_obstacles *obstacles, const struct seen *seen, const struct run *run,
                      float deviation_square)
{
    const struct jp_plane_point begin = point_of(seen, run->first);
    const struct jp_plane_point end = point_of(seen, run->last);
    struct jp_obstacle shape = {.vertices = {begin}, .vertex_count = 1, .radius = seen->config->tolerance};

    if (square_between(begin, end) > 0.0f) {
        const struct offsets offsets = offsets_of(seen, run);
        const float to_left = offsets.most - offsets.mean;
        const float to_right = offsets.mean - offsets.least;

        shape.vertices[0] = shifted(begin, &offsets);
        shape.vertices[1] = shifted(end, &offsets);
        shape.vertex_count = 2;
        shape.radius = to_left > to_right ? to_left : to_right;
    }
    /* Points may lie beyond the ends of a chord that could not be split farther. */
    if (deviation_square > seen->config->tolerance * seen->config->tolerance) {
        shape.radius += jp_plane_square_root(deviation_square);
    }
    (void)jp_obstacles_add(obstacles, &shape); /* with the limits of scan and sensor it fits */
}

/* Splits a run until its parts are straight, the first part first. Each part that waits begins where the one before it
 * ends. */
static void add_run(struct jp_obstacles *obstacles, const struct seen *seen, const struct run *run)
{
    struct part parts[DEPTH_MAX + 1];
    unsigned count = 1;
    unsigned first = run->first;

    parts[0] = (struct part){run->last, 0};
    while (count > 0U) {
        const struct run piece = {first, parts[count - 1U].last};
        const unsigned depth = parts[count - 1U].depth;
        const struct deviation worst = deviation_of(seen, &piece);

        if (worst.square > seen->config->tolerance * seen->config->tolerance && depth < DEPTH_MAX) {
            parts[count - 1U].depth = depth + 1U;
            parts[count] = (struct part){worst.beam, depth + 1U};
            count++;
        } else {
            add_chord(obstacles, seen, &piece, worst.square);
            first = piece.last;
            count--;
        }
    }
}

/* The first point from a beam on; the number of beams if there is none. */
static unsigned next_point(const struct seen *seen, unsigned beam)
{
    unsigned next = beam;

    while (next < seen->scan->count && !is_point(seen, next)) {
        next++;
    }
    return next;
}

/* The run that begins at a point, and of how many points it is. */
static struct run run_from(const struct seen *seen, unsigned first, unsigned *points)
{
    struct run run = {first, first};
    struct jp_plane_point last = point_of(seen, first);
    bool is_end = false;

    *points = 1;
    while (!is_end) {
        const unsigned beam = next_point(seen, run.last + 1U);

        is_end = beam == seen->scan->count;
        if (!is_end) {
            const struct jp_plane_point point = point_of(seen, beam);

            is_end = square_between(point, last) > seen->config->gap * seen->config->gap;
            last = point;
        }
        if (!is_end) {
            run.last = beam;
            *points += 1U;
        }
    }
    return run;
}

enum jp_status jp_obstacles_add_scan(struct jp_obstacles *obstacles, const struct jp_scan_config *config,
                                     const struct jp_scan *scan, const struct jp_plane_pose *sensor)
{
    if (obstacles == NULL || config == NULL || scan == NULL || sensor == NULL || !is_config(config) || !is_scan(scan) ||
        !is_sensor(sensor)) {
        return JP_ERR_ARGUMENT;
    }
    if (!is_trusted(scan)) {
        return JP_ERR_EMPTY;
    }

    const struct seen seen = {config, scan, {sensor->x, sensor->y, jp_plane_wrap(sensor->heading + scan->first_angle)}};
    unsigned first = next_point(&seen, 0);

    while (first < scan->count) {
        unsigned points;
        const struct run run = run_from(&seen, first, &points);

        if (points >= config->beams_min) {
            add_run(obstacles, &seen, &run);
        }
        first = next_point(&seen, run.last + 1U);
    }
    return JP_OK;
}
