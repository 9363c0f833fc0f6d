/** Where a target lies and the segment of an arc to it. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_SEGMENT_GEOMETRY_H
#define JOULEPATH_TRAJECTORY_SEGMENT_GEOMETRY_H

#include <joulepath/segment.h>

/** Distance in 2⁻²² m and direction of `to`. Failures as jp_segment_optimise(). */
enum jp_status jp_segment_polar(const struct jp_point *from, const struct jp_point *to, uint32_t *distance,
                                jp_angle *direction);

/** The shortest duration of any arc of at least this chord, s, when segments last at least `least`. */
jp_q16 jp_segment_shortest(jp_q16 least, const struct jp_segment_limits *limits, uint32_t distance);

/**
 * The segment of an arc to a target at this distance and bearing, within the limits, without its energy. x as in
 * segment_arc.h, xi = time_min/T in Q30.
 */
void jp_segment_store(const struct jp_segment_limits *limits, uint32_t distance, jp_angle bearing, jp_q16 time_min,
                      int32_t x, int32_t xi, struct jp_segment *segment);

#endif
