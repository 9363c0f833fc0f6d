#include "src/local/scan_runs.h"

#include "src/base/plane.h"

#define ANGLE_MAX     7.0f
#define LENGTH_MAX    1000.0f
#define TOLERANCE_MIN 0.001f

/* One of so many beams must have worked. */
#define TRUSTED_PART 4U

static bool is_config(const struct jp_scan_config *config)
{
    return config->range_max > 0.0f && config->range_max <= LENGTH_MAX && config->gap > 0.0f &&
           config->gap <= LENGTH_MAX && config->tolerance >= TOLERANCE_MIN && config->tolerance <= LENGTH_MAX &&
           config->beams_min > 0U;
}

bool jp_scan_is_sound(const struct jp_scan *scan)
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

enum jp_status jp_scan_open(struct jp_scan_view *view, const struct jp_scan_config *config, const struct jp_scan *scan,
                            const struct jp_plane_pose *sensor)
{
    if (config == NULL || scan == NULL || sensor == NULL || !is_config(config) || !jp_scan_is_sound(scan) ||
        !is_sensor(sensor)) {
        return JP_ERR_ARGUMENT;
    }
    view->config = config;
    view->scan = scan;
    view->first = (struct jp_plane_pose){sensor->x, sensor->y, jp_plane_wrap(sensor->heading + scan->first_angle)};
    return is_trusted(scan) ? JP_OK : JP_ERR_UNRELIABLE;
}

bool jp_scan_is_point(const struct jp_scan_view *view, unsigned beam)
{
    return view->scan->ranges[beam] > 0.0f && view->scan->ranges[beam] <= view->config->range_max;
}

struct jp_plane_point jp_scan_point(const struct jp_scan_view *view, unsigned beam)
{
    const float range = view->scan->ranges[beam];
    const struct jp_plane_point direction =
        jp_plane_direction(view->first.heading + view->scan->angle_step * (float)beam);

    return (struct jp_plane_point){view->first.x + range * direction.x, view->first.y + range * direction.y};
}

/* The first point from a beam on; the number of beams if there is none. */
static unsigned next_point(const struct jp_scan_view *view, unsigned beam)
{
    unsigned next = beam;

    while (next < view->scan->count && !jp_scan_is_point(view, next)) {
        next++;
    }
    return next;
}

bool jp_scan_next_run(const struct jp_scan_view *view, unsigned beam, struct jp_scan_run *run)
{
    const unsigned first = next_point(view, beam);

    if (first == view->scan->count) {
        return false;
    }
    *run = (struct jp_scan_run){first, first, 1};

    struct jp_plane_point last = jp_scan_point(view, first);

    for (unsigned i = next_point(view, first + 1U); i < view->scan->count; i = next_point(view, i + 1U)) {
        const struct jp_plane_point point = jp_scan_point(view, i);

        if (jp_plane_square_between(point, last) > view->config->gap * view->config->gap) {
            break;
        }
        last = point;
        run->last = i;
        run->points++;
    }
    return true;
}

uint32_t jp_scan_beam_towards(const struct jp_scan_view *view, struct jp_plane_point place)
{
    const float bearing = jp_plane_bearing(place.x - view->first.x, place.y - view->first.y);
    const float angle = jp_plane_wrap(bearing - view->first.heading);
    const float turned = angle < 0.0f ? angle + 2.0f * JP_PLANE_PI : angle;

    return (uint32_t)(turned / view->scan->angle_step);
}

bool jp_scan_reaches(const struct jp_scan_view *view, uint32_t beam, float distance)
{
    const float range = view->scan->ranges[beam] == 0.0f ? view->config->range_max : view->scan->ranges[beam];

    return range > distance && jp_plane_is_finite(range);
}
