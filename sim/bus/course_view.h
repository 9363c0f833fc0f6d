/** The course of a navigator as its legs come in CourseLeg, one after the other. */
#ifndef JOULEPATH_SIM_BUS_COURSE_VIEW_H
#define JOULEPATH_SIM_BUS_COURSE_VIEW_H

#include <stdbool.h>

#include <joulepath/point.h>

#include "hal/can/jp_can.h"

/** Legs of a course that the bus can tell. */
#define COURSE_VIEW_LEGS 255

/** Zero-initialised: none has come. */
struct course_view {
    struct jp_point ends[COURSE_VIEW_LEGS]; /**< by the number of legs after them */
    bool has[COURSE_VIEW_LEGS];
    uint8_t course;
};

/** Takes a leg; that of another course begins anew. */
void course_view_take(struct course_view *view, const struct jp_can_course_leg_t *leg);

/** Ends of the legs that are left, the next one first, m from the south-west corner of the map; returns their number.
 *  0: there is no course, or not all of it has come. */
unsigned course_view_read(const struct course_view *view, const struct jp_can_navigation_status_t *status,
                          struct jp_point ends[COURSE_VIEW_LEGS]);

#endif
