#include "src/local/movers_things.h"

#include "src/base/plane.h"

/* From a beam to the one before it; unsigned numbers wrap. */
#define BACK 0xFFFFFFFFU

/* As much farther away a surface may go on than its last two points say, which err by centimetres. */
#define STEEPER 1.5f

/* A shorter run is a point, m. */
#define LEAST 1.0e-4f

/* Which tell how a surface goes on. */
#define POINTS_MIN 2U

/* Whether the surface that ends at a beam may go on beyond the next one that works: a wall along which the scanner
 * looks has no rim where its points lie far apart. The beam meets the line through the last two points at some range,
 * or never; one that ends clearly behind it has passed it. */
static bool may_go_on(const struct jp_scan_view *view, unsigned end, unsigned step, float range)
{
    unsigned inner = end - step;

    while (!jp_scan_is_point(view, inner)) {
        inner -= step;
    }

    const struct jp_plane_point from = jp_scan_point(view, inner);
    const struct jp_plane_point rim = jp_scan_point(view, end);
    const struct jp_plane_point beam =
        jp_plane_direction(view->first.heading + (float)(end + step) * view->scan->angle_step);
    const struct jp_plane_point along = {rim.x - from.x, rim.y - from.y};
    const float nearing = beam.x * along.y - beam.y * along.x;
    const float away = (rim.x - view->first.x) * along.y - (rim.y - view->first.y) * along.x;
    const float beyond = range - view->scan->ranges[end] - JP_MOVER_CLEARLY;

    /* Both sides times `nearing`, above 0 where the beam meets the line in front of the sensor. */
    return nearing * away <= 0.0f ||
           beyond * jp_plane_magnitude(nearing) <=
               STEEPER * (jp_plane_magnitude(away) - view->scan->ranges[end] * jp_plane_magnitude(nearing));
}

/* Whether the next beam beside a run that works, in the direction of a step, sees past it: farther away, or nothing.
 * The ends of a scan hide what is beside them. */
static bool is_past(const struct jp_scan_view *view, unsigned end, unsigned step)
{
    unsigned beside = end + step;

    while (beside < view->scan->count && !(view->scan->ranges[beside] >= 0.0f)) {
        beside += step;
    }
    if (beside >= view->scan->count) {
        return false;
    }

    const float range = jp_scan_is_point(view, beside) ? view->scan->ranges[beside] : view->config->range_max;

    return range > view->scan->ranges[end] && !may_go_on(view, end, step, range);
}

/* Evenly within it. */
static void take_points(const struct jp_scan_view *view, const struct jp_scan_run *run,
                        struct jp_plane_point points[JP_MOVER_POINTS])
{
    for (unsigned i = 0; i < JP_MOVER_POINTS; i++) {
        unsigned beam = run->first + (i + 1U) * (run->last - run->first) / (JP_MOVER_POINTS + 1U);

        while (!jp_scan_is_point(view, beam)) {
            beam++;
        }
        points[i] = jp_scan_point(view, beam);
    }
}

/* Along what is seen of a thing; nowhere where that is a point. */
static struct jp_plane_point across_of(struct jp_plane_point first, struct jp_plane_point last)
{
    const float length = jp_plane_larger(jp_plane_length(last.x - first.x, last.y - first.y), LEAST);

    return (struct jp_plane_point){(last.x - first.x) / length, (last.y - first.y) / length};
}

bool jp_mover_find_thing(const struct jp_scan_view *view, const struct jp_scan_run *run, float extent,
                         struct jp_mover_thing *thing)
{
    const struct jp_plane_point first = jp_scan_point(view, run->first);
    const struct jp_plane_point last = jp_scan_point(view, run->last);
    const float square = jp_plane_square_between(first, last);

    if (run->points < view->config->beams_min || run->points < POINTS_MIN || square > extent * extent) {
        return false;
    }
    thing->is_free[0] = is_past(view, run->first, BACK);
    thing->is_free[1] = is_past(view, run->last, 1U);
    if (!thing->is_free[0] && !thing->is_free[1]) {
        return false;
    }
    thing->centre = (struct jp_plane_point){0.5f * (first.x + last.x), 0.5f * (first.y + last.y)};
    thing->radius = 0.5f * jp_plane_square_root(square);
    thing->across = across_of(first, last);
    take_points(view, run, thing->seen);
    thing->has_come = false;
    return true;
}

bool jp_mover_thing_is_whole(const struct jp_mover_thing *thing)
{
    return thing->is_free[0] && thing->is_free[1];
}

bool jp_mover_is_empty(const struct jp_scan_view *view, struct jp_plane_point place)
{
    const float distance = jp_plane_length(place.x - view->first.x, place.y - view->first.y) + JP_MOVER_CLEARLY;
    const uint32_t beam = jp_scan_beam_towards(view, place);

    return beam + 1U < view->scan->count && jp_scan_reaches(view, beam, distance) &&
           jp_scan_reaches(view, beam + 1U, distance);
}
