/** The tracks of objects from scan to scan: Kalman filters of constant velocity. Private to libjoulepath_float. */
#ifndef JOULEPATH_LOCAL_MOVERS_TRACK_H
#define JOULEPATH_LOCAL_MOVERS_TRACK_H

#include "src/local/movers_things.h"

/** A period on, s; of each no object of the scan is known yet. Work: movers. */
void jp_movers_predict(struct jp_movers *movers, float period);

/** The nearest track without an object in this scan; null when none is within the gate, m. Work: movers. */
struct jp_mover *jp_movers_match(struct jp_movers *movers, const struct jp_mover_thing *thing, float gate);

/** Takes an object for the track's in this scan. */
void jp_mover_correct(struct jp_mover *mover, const struct jp_mover_thing *thing, float speed_max);

/** The track of an object that is new; of the nearest where there are more than tracks. Work: movers, twice. */
void jp_movers_begin(struct jp_movers *movers, const struct jp_mover_thing *thing, struct jp_plane_point sensor);

/** Counts more misses of those through whose place the beams look. Work: movers. */
void jp_movers_miss(struct jp_movers *movers, const struct jp_scan_view *view);

/** Drops the tracks that have been missed for long. Work: movers. */
void jp_movers_forget(struct jp_movers *movers);

#endif
