/** The objects that stand free in a scan. Private to libjoulepath_float. */
#ifndef JOULEPATH_LOCAL_MOVERS_THINGS_H
#define JOULEPATH_LOCAL_MOVERS_THINGS_H

#include <joulepath/movers.h>

#include "src/local/scan_runs.h"

/** A beam that ends so far behind a place, or a place so far before what was seen, is beyond what pose and laser err
 * by, m. */
#define JP_MOVER_CLEARLY 0.15f

/** An object in this scan. */
struct jp_mover_thing {
    struct jp_plane_point centre;
    float radius;
    struct jp_plane_point across;                /**< from its right end to the left one, of length 1 */
    bool is_free[2];                             /**< on the right, on the left */
    struct jp_plane_point seen[JP_MOVER_POINTS]; /**< of its surface, from right to left */
    bool has_come;                               /**< all of it is where nothing was a while ago */
};

/** What is seen in a run of points. False: it is not an object that stands free. Work: some beams. */
bool jp_mover_find_thing(const struct jp_scan_view *view, const struct jp_scan_run *run, float extent,
                         struct jp_mover_thing *thing);

/** Whether nothing is at a place, clearly: the beams on both sides of it end behind it. */
bool jp_mover_is_empty(const struct jp_scan_view *view, struct jp_plane_point place);

/** Whether nothing hides an end of it. */
bool jp_mover_thing_is_whole(const struct jp_mover_thing *thing);

#endif
