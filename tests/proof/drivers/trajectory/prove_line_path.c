// eva: -eva-slevel-function main:20
/** Any route, on level ground or on any other, into any number of places. */
#include <joulepath/line_path.h>

#include "tests/proof/any.h"

#define TARGETS 3U
#define PLACES  8U

static jp_q16 any_elevation(const void *context, const struct jp_point *point)
{
    (void)context;
    (void)point;
    return any_between(-JP_Q16(16383), JP_Q16(16383));
}

static uint8_t any_class(const void *context, const struct jp_point *point)
{
    (void)context;
    (void)point;
    return (uint8_t)any_unsigned(JP_GROUND_CLASSES - 1U);
}

int main(void)
{
    static struct jp_path_piece pieces[PLACES];
    static struct jp_point targets[TARGETS];
    const struct jp_ground ground = {.elevation = any_elevation,
                                     .class_at = any_bool() ? any_class : NULL,
                                     .spacing = any_between(1, INT32_MAX),
                                     .margin = any_between(0, JP_Q16(2))};
    struct jp_line_route route;
    struct jp_lattice_path path;

    ANY(targets);
    ANY(route);
    route.targets = targets;
    route.count = (uint16_t)any_unsigned(TARGETS);
    route.ground = any_bool() ? &ground : NULL;
    route.half_track = any_between(0, JP_Q16(2));
    (void)jp_line_path(&path, pieces, (uint16_t)any_unsigned(PLACES), &route);
    (void)jp_turn_path(&path, pieces, (uint16_t)any_unsigned(PLACES), &route, any_unsigned(UINT32_MAX));
    ARRIVED();
    return 0;
}
