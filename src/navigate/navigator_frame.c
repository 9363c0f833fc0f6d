#include "src/navigate/navigator_frame.h"

#include <stddef.h>

#include "src/base/integer.h"

static struct jp_point rotated(struct jp_point point, jp_angle angle)
{
    const jp_q31 cosine = jp_cos(angle);
    const jp_q31 sine = jp_sin(angle);

    return (struct jp_point){jp_sub(jp_multiply_shift(point.x, cosine, 31), jp_multiply_shift(point.y, sine, 31)),
                             jp_add(jp_multiply_shift(point.x, sine, 31), jp_multiply_shift(point.y, cosine, 31))};
}

static struct jp_point sum(struct jp_point a, struct jp_point b)
{
    return (struct jp_point){jp_add(a.x, b.x), jp_add(a.y, b.y)};
}

static struct jp_point difference(struct jp_point a, struct jp_point b)
{
    return (struct jp_point){jp_sub(a.x, b.x), jp_sub(a.y, b.y)};
}

static struct jp_point on_map(const struct jp_place *origin, const struct jp_point *point)
{
    return sum(origin->point, rotated(*point, origin->heading));
}

struct jp_vehicle_view jp_frame_look(const struct jp_navigator *navigator)
{
    struct jp_vehicle_view view = {.phase = JP_VEHICLE_MOVING};

    navigator->config.vehicle->look(navigator->config.vehicle->context, &view);
    return view;
}

struct jp_place jp_frame_place(const struct jp_navigator *navigator, const struct jp_vehicle_view *view)
{
    const struct jp_place *origin = &navigator->internal.origin;

    return (struct jp_place){on_map(origin, &view->position), origin->heading + view->heading};
}

struct jp_point jp_frame_in_odometry(const struct jp_navigator *navigator, const struct jp_point *point)
{
    const struct jp_place *origin = &navigator->internal.origin;

    return rotated(difference(*point, origin->point), 0U - origin->heading);
}

static const struct jp_navigator *navigator_of(const void *context)
{
    return context;
}

static jp_q16 elevation_at(const void *context, const struct jp_point *point)
{
    const struct jp_navigator *navigator = navigator_of(context);
    const struct jp_point place = on_map(&navigator->internal.origin, point);

    return jp_terrain_height(jp_planner_terrain(navigator->config.planner), &place);
}

static uint8_t class_at(const void *context, const struct jp_point *point)
{
    const struct jp_navigator *navigator = navigator_of(context);
    const struct jp_terrain *terrain = jp_planner_terrain(navigator->config.planner);
    const struct jp_point place = on_map(&navigator->internal.origin, point);
    const jp_q16 cell = terrain->config.resolution;

    return jp_terrain_class(terrain, place.x / cell, place.y / cell);
}

struct jp_ground jp_frame_make_ground(const struct jp_navigator *navigator)
{
    const struct jp_terrain *terrain = jp_planner_terrain(navigator->config.planner);

    return (struct jp_ground){.elevation = elevation_at,
                              .class_at = class_at,
                              .context = navigator,
                              .spacing = terrain->config.resolution,
                              .margin = navigator->config.margin};
}

const struct jp_ground *jp_frame_ground(const struct jp_navigator *navigator)
{
    const struct jp_terrain *terrain = jp_planner_terrain(navigator->config.planner);

    return terrain->config.has_elevation || terrain->config.has_classes ? &navigator->internal.ground : NULL;
}

jp_angle jp_frame_direction(const struct jp_point *from, const struct jp_point *to)
{
    return jp_atan2(jp_sub(to->y, from->y), jp_sub(to->x, from->x));
}

struct jp_point jp_frame_leg_begin(const struct jp_navigator *navigator, unsigned leg)
{
    return jp_course_begin(&navigator->internal.course, leg);
}

jp_angle jp_frame_leg_direction(const struct jp_navigator *navigator, unsigned leg)
{
    const struct jp_point begin = jp_frame_leg_begin(navigator, leg);

    return jp_frame_direction(&begin, &navigator->config.legs[leg].end);
}

struct jp_point jp_frame_along_leg(const struct jp_navigator *navigator, unsigned leg, const struct jp_point *point)
{
    const struct jp_point *end = &navigator->config.legs[leg].end;

    return rotated(difference(*point, *end), 0U - jp_frame_leg_direction(navigator, leg));
}

struct jp_point jp_frame_left_of_leg(const struct jp_navigator *navigator, unsigned leg, const struct jp_point *point)
{
    const struct jp_point *end = &navigator->config.legs[leg].end;
    const struct jp_point ahead = {.x = jp_frame_along_leg(navigator, leg, point).x};

    return ahead.x < 0 ? sum(*end, rotated(ahead, jp_frame_leg_direction(navigator, leg))) : *end;
}

uint8_t jp_frame_nearest_heading(const struct jp_lattice *lattice, uint16_t headings, jp_angle heading)
{
    uint8_t best = 0;
    uint32_t least = UINT32_MAX;

    for (uint8_t i = 0; i < JP_HEADINGS; i++) {
        const uint32_t off = jp_magnitude32((int32_t)(lattice->heading[i] - heading));
        if ((((uint32_t)headings >> i) & 1U) != 0U && off < least) {
            least = off;
            best = i;
        }
    }
    return best;
}
