#include "sim/bus/course_view.h"

/** Fraction bits of Q16 that CourseLeg leaves out. */
#define POINT_BITS 9

void course_view_take(struct course_view *view, const struct jp_can_course_leg_t *leg)
{
    if (leg->course != view->course) {
        *view = (struct course_view){.course = leg->course};
    }
    if (leg->after < COURSE_VIEW_LEGS) {
        view->ends[leg->after] = (struct jp_point){leg->x << POINT_BITS, leg->y << POINT_BITS};
        view->has[leg->after] = true;
    }
}

unsigned course_view_read(const struct course_view *view, const struct jp_can_navigation_status_t *status,
                          struct jp_point ends[COURSE_VIEW_LEGS])
{
    const unsigned count = status->legs_left;

    if (status->has_course == 0U || status->course != view->course) {
        return 0;
    }
    for (unsigned i = 0; i < count; i++) {
        if (!view->has[count - 1U - i]) {
            return 0;
        }
        ends[i] = view->ends[count - 1U - i];
    }
    return count;
}
