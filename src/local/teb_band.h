/** The band's poses: from the path, from the last cycle, more or fewer of them, and what is near them. Private to the
 *  TEB. */
#ifndef JOULEPATH_LOCAL_TEB_BAND_H
#define JOULEPATH_LOCAL_TEB_BAND_H

#include <joulepath/teb.h>

/** Cuts the band of the last cycle to the task, or lays a new one along the path. */
void jp_teb_fit_band(struct jp_teb *teb);

/** Splits intervals above interval + hysteresis, joins those below interval − hysteresis. Work: poses, at most twice
 *  JP_TEB_POSES_MAX changes. */
void jp_teb_resize(struct jp_teb *teb);

/** Finds the foot of each pose on the path. Work: poses + points of the path. */
void jp_teb_find_feet(struct jp_teb *teb);

/** Work on obstacles in a cycle, counted in distances whose nearest feature stays. Where it is used up the optimisation
 *  ends; it is more than the first search takes at most, and is exceeded by one step's at most. */
#define JP_TEB_WORK_MAX 3100U

/** Finds the obstacles near each pose; where the work is used up, those found before stay. Work: poses × obstacles. */
void jp_teb_find_obstacles(struct jp_teb *teb);

/** At most this much nearer to or farther from any obstacle is the footprint at one pose than at the other, m. */
float jp_teb_sweep(const struct jp_footprint *footprint, const struct jp_plane_pose *a, const struct jp_plane_pose *b);

/** Distance of the footprint at a pose of the band from where a shape will be after `time`, as jp_obstacle_distance();
 *  *feature as in jp_obstacle_distance_along(). */
float jp_teb_distance(struct jp_teb *teb, unsigned i, unsigned shape, float time, uint8_t *feature,
                      struct jp_plane_pose *gradient);

/** Sets a pose with its sine and cosine. */
void jp_teb_set_pose(struct jp_teb_pose *pose, const struct jp_plane_pose *to);

#endif
