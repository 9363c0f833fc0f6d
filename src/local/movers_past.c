#include "src/local/movers_past.h"

#include "src/base/plane.h"

/* The earlier one of two scans is one to two of these old, s: in less, somebody has not left a place as wide as they
 * are. */
#define SPAN 1.0f

/* Beams that did not work. */
#define UNKNOWN (-1.0f)

/* Nothing is nearer than this in the direction of some beams, m. */
static float least_range(const struct jp_scan_view *view, unsigned first, unsigned beams)
{
    float least = view->config->range_max;

    for (unsigned i = first; i < first + beams && i < view->scan->count; i++) {
        if (!(view->scan->ranges[i] >= 0.0f) || !jp_plane_is_finite(view->scan->ranges[i])) {
            return UNKNOWN;
        }
        if (view->scan->ranges[i] > 0.0f) {
            least = jp_plane_smaller(least, view->scan->ranges[i]);
        }
    }
    return least;
}

static void take_scan(struct jp_movers_past *past, const struct jp_scan_view *view)
{
    const unsigned beams = ((unsigned)view->scan->count + JP_MOVERS_PAST_BEAMS - 1U) / JP_MOVERS_PAST_BEAMS;
    unsigned count = 0;

    for (unsigned first = 0; first < view->scan->count; first += beams) {
        past->ranges[count] = least_range(view, first, beams);
        count++;
    }
    past->first = view->first;
    past->step = (float)beams * view->scan->angle_step;
    past->count = (uint16_t)count;
}

void jp_movers_keep_scan(struct jp_movers *movers, const struct jp_scan_view *view, float period)
{
    movers->past_age += period;
    if (movers->past[0].count == 0U || movers->past_age >= SPAN) {
        movers->past[1] = movers->past[0];
        take_scan(&movers->past[0], view);
        movers->past_age = 0.0f;
    }
}

bool jp_movers_has_come(const struct jp_movers *movers, const struct jp_scan_config *config,
                        const struct jp_mover_thing *thing)
{
    const struct jp_movers_past *const past = &movers->past[1];
    const struct jp_scan scan = {.ranges = past->ranges, .count = past->count, .angle_step = past->step};
    const struct jp_scan_view view = {config, &scan, past->first};

    for (unsigned i = 0; i < JP_MOVER_POINTS; i++) {
        if (past->count == 0U || !jp_mover_is_empty(&view, thing->seen[i])) {
            return false;
        }
    }
    return true;
}
