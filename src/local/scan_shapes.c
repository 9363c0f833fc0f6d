/* A scan becomes capsules: runs of points without a gap, split where they are farthest from their chord. */
#include <joulepath/obstacles.h>

#include "src/base/plane.h"
#include "src/local/scan_runs.h"

/* Splits of a run. */
#define DEPTH_MAX 12U

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

/* Of a point from the chord between two others. */
static float square_from_chord(struct jp_plane_point point, struct jp_plane_point begin, struct jp_plane_point end)
{
    const struct jp_plane_point chord = {end.x - begin.x, end.y - begin.y};
    const struct jp_plane_point way = {point.x - begin.x, point.y - begin.y};
    const float length_square = chord.x * chord.x + chord.y * chord.y;
    const float along = way.x * chord.x + way.y * chord.y;

    if (along <= 0.0f) {
        return jp_plane_square_between(point, begin);
    }
    if (along >= length_square) {
        return jp_plane_square_between(point, end);
    }

    const float across = way.x * chord.y - way.y * chord.x;

    return across * across / length_square;
}

static struct deviation deviation_of(const struct jp_scan_view *view, const struct jp_scan_run *run)
{
    const struct jp_plane_point begin = jp_scan_point(view, run->first);
    const struct jp_plane_point end = jp_scan_point(view, run->last);
    struct deviation worst = {0.0f, run->first};

    for (unsigned i = run->first + 1U; i < run->last; i++) {
        if (jp_scan_is_point(view, i)) {
            const float square = square_from_chord(jp_scan_point(view, i), begin, end);

            if (square > worst.square) {
                worst = (struct deviation){square, i};
            }
        }
    }
    return worst;
}

/* How far the points of a run lie to the left of their chord, and beyond its ends. */
struct offsets {
    struct jp_plane_point normal; /* of the chord, to the left */
    float mean;
    float least;
    float most;
    float beyond;
};

static struct offsets offsets_of(const struct jp_scan_view *view, const struct jp_scan_run *run)
{
    const struct jp_plane_point begin = jp_scan_point(view, run->first);
    const struct jp_plane_point end = jp_scan_point(view, run->last);
    const float length = jp_plane_square_root(jp_plane_square_between(begin, end));
    const struct jp_plane_point along = {(end.x - begin.x) / length, (end.y - begin.y) / length};
    struct offsets offsets = {.normal = {-along.y, along.x}};
    float count = 0.0f;

    for (unsigned i = run->first; i <= run->last; i++) {
        if (jp_scan_is_point(view, i)) {
            const struct jp_plane_point point = jp_scan_point(view, i);
            const struct jp_plane_point way = {point.x - begin.x, point.y - begin.y};
            const float offset = way.x * offsets.normal.x + way.y * offsets.normal.y;
            const float distance = way.x * along.x + way.y * along.y;

            offsets.mean += offset;
            offsets.least = -jp_plane_larger(-offset, -offsets.least);
            offsets.most = jp_plane_larger(offset, offsets.most);
            offsets.beyond = jp_plane_larger(jp_plane_larger(-distance, distance - length), offsets.beyond);
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

/* A chord through the middle of its points, wide enough for all of them; around one place a disc. */
static void add_chord(struct jp_obstacles *obstacles, const struct jp_scan_view *view, const struct jp_scan_run *run,
                      float deviation_square)
{
    const struct jp_plane_point begin = jp_scan_point(view, run->first);
    const struct jp_plane_point end = jp_scan_point(view, run->last);
    struct jp_obstacle shape = {.vertex_count = 1};

    if (jp_plane_square_between(begin, end) > 0.0f) {
        const struct offsets offsets = offsets_of(view, run);
        const float beside = jp_plane_larger(offsets.most - offsets.mean, offsets.mean - offsets.least);

        shape.vertices[0] = shifted(begin, &offsets);
        shape.vertices[1] = shifted(end, &offsets);
        shape.vertex_count = 2;
        shape.radius = jp_plane_length(beside, offsets.beyond);
    } else {
        shape.vertices[0] = begin;
        shape.radius = view->config->tolerance + jp_plane_square_root(deviation_square);
    }
    (void)jp_obstacles_add(obstacles, &shape); /* with the limits of scan and sensor it fits */
}

/* Splits a run until its parts are straight, the first part first. Each part that waits begins where the one before it
 * ends. */
static void add_run(struct jp_obstacles *obstacles, const struct jp_scan_view *view, const struct jp_scan_run *run)
{
    struct part parts[DEPTH_MAX + 1U];
    unsigned count = 1;
    unsigned first = run->first;

    parts[0] = (struct part){run->last, 0};
    while (count > 0U) {
        const struct jp_scan_run piece = {first, parts[count - 1U].last, 0};
        const unsigned depth = parts[count - 1U].depth;
        const struct deviation worst = deviation_of(view, &piece);

        if (worst.square > view->config->tolerance * view->config->tolerance && depth < DEPTH_MAX) {
            parts[count - 1U].depth = depth + 1U;
            parts[count] = (struct part){worst.beam, depth + 1U};
            count++;
        } else {
            add_chord(obstacles, view, &piece, worst.square);
            first = piece.last;
            count--;
        }
    }
}

enum jp_status jp_obstacles_add_scan(struct jp_obstacles *obstacles, const struct jp_scan_config *config,
                                     const struct jp_scan *scan, const struct jp_plane_pose *sensor)
{
    struct jp_scan_view view;
    struct jp_scan_run run;
    const enum jp_status status = obstacles == NULL ? JP_ERR_ARGUMENT : jp_scan_open(&view, config, scan, sensor);

    if (status != JP_OK) {
        return status;
    }
    for (unsigned beam = 0; jp_scan_next_run(&view, beam, &run); beam = run.last + 1U) {
        if (run.points >= config->beams_min) {
            add_run(obstacles, &view, &run);
        }
    }
    return JP_OK;
}
