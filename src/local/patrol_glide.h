/** Turning while the robot drives, its wheels askew. Private to the patrol. */
#ifndef JOULEPATH_LOCAL_PATROL_GLIDE_H
#define JOULEPATH_LOCAL_PATROL_GLIDE_H

#include "src/local/patrol_path.h"

/** At a stand whose path leads off by more than turn_first: begins what is cheapest of a glide along the path, and of
 *  a turn in place to where such a glide can begin. False: to turn in place all the way is, or nothing else is free. */
bool jp_patrol_set_off(struct jp_patrol *patrol, const struct jp_patrol_window *window);

/** Near a goal that wants another heading: begins the glide into it. False: it is too early, or not free. */
bool jp_patrol_glide_in(struct jp_patrol *patrol, const struct jp_patrol_window *window);

/** Largest angle between heading and way at which a glide begins or ends, rad. */
float jp_patrol_askew_max(const struct jp_patrol_config *config);

/** The part of an angle, with its sign, that a robot which sets off glides, where that costs less than to turn in place
 * all the way; 0 where it does not. */
float jp_patrol_set_off_part(const struct jp_patrol_config *config, float angle);

/** What is left of an angle to turn in place before, when such a glide takes a part of it: 0 or more, rad; what a turn
 * to the way may be off by is not. */
float jp_patrol_set_off_rest(const struct jp_patrol_config *config, float angle, float part);

/** The way, m, on which it glides such a part. */
float jp_patrol_set_off_length(float part);

/** The part of an angle, with its sign, that a robot glides into a goal at the end of a way of a length, m; none below
 * 0. */
float jp_patrol_glide_in_part(const struct jp_patrol_config *config, float angle, float length);

/** Whether, by what scans have shown, such a glide from the path's end leads to the goal's heading. */
bool jp_patrol_can_glide_in(const struct jp_patrol *patrol);

/** A cycle of the state GLIDING. */
void jp_patrol_glide(struct jp_patrol *patrol);

/** Poses of the glide that is under way, a tenth of a metre apart, from the next one until the robot follows its path
 * for `most` of them or is at the goal. Returns how many. */
unsigned jp_patrol_foresee_glide(const struct jp_patrol *patrol, struct jp_plane_pose *poses, unsigned most);

#endif
