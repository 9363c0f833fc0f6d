// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:200,any_terrain:30,jp_terrain_init:30,is_side:10,jp_course_init:50
// eva: -eva-slevel-function jp_capsule_is_clear:50,find_line:50,find_place:50,is_along:20
/** Any map, any disc and margin that pass, legs whose members are any within their ranges, any points: whether they are
 *  clear, and how much room there is. */
#include <joulepath/course.h>

#include "tests/proof/any_terrain.h"

#define LEGS 3U

static struct jp_course course;
static struct jp_course_leg legs[LEGS];

/** As the search and its caller leave them: with the margin of the course or less. */
static void fill(const struct jp_point *point)
{
    for (unsigned i = 0; i < LEGS; i++) {
        ANY(legs[i]);
        legs[i].margin = any_bool() ? any_between(0, course.config.margin) : jp_course_room(&course, point);
        legs[i].aside = any_between(0, INT32_MAX);
        legs[i].is_stop = any_bool();
    }
    ANY(course.internal.start);
}

int main(void)
{
    struct jp_terrain *map = any_terrain();
    const struct jp_course_config config = {.terrain = map,
                                            .radius = any_int(),
                                            .margin = any_int(),
                                            .legs = legs,
                                            .legs_max = (uint16_t)any_unsigned(LEGS)};
    struct jp_point point;
    const char *field;

    while (map->config.resolution < 1) {
        /* It has refused these; the analyser forgets that. */
    }
    if (jp_course_init(&course, &config, &field) != JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        const unsigned leg = any_unsigned(LEGS - 1U);

        ANY(point);
        fill(&point);
        jp_course_begin_at(&course, leg, &point);
        (void)jp_course_begin(&course, leg);
        (void)jp_course_is_clear(&course, leg, &point);
    }
    ARRIVED();
    return 0;
}
