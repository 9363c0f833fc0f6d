/** How a trajectory by rule rounds a waypoint. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_TRAJECTORY_CORNER_H
#define JOULEPATH_TRAJECTORY_TRAJECTORY_CORNER_H

#include <joulepath/trajectory_rule.h>

/** The leg to target `index` after one in direction `before`, or from the heading at the start, at the speed that
 * leaves its blends time enough for the turns at its ends. JP_ERR_ZERO_LENGTH, JP_ERR_ARGUMENT: as jp_segment_polar().
 *  JP_ERR_INFEASIBLE: no speed does. */
enum jp_status jp_chord_to(const struct jp_trajectory_task *task, uint16_t index, jp_angle before,
                           struct jp_chord *chord);

/** The motion at the waypoint between two chords. */
struct jp_waypoint_motion jp_corner_between(const struct jp_trajectory_task *task, const struct jp_chord *before,
                                            const struct jp_chord *after);

#endif
