/** Where the robot turns into a goal at which it has no room to turn. Private to the patrol. */
#ifndef JOULEPATH_LOCAL_PATROL_APPROACH_H
#define JOULEPATH_LOCAL_PATROL_APPROACH_H

#include <joulepath/obstacles.h>
#include <joulepath/terrain.h>

/** True when there is less room to turn at the goal than at a pose straight behind it, from which the way in is free:
 *  *approach is the nearest such. False where the robot can turn at the goal, or nowhere before it. Work: as said of
 *  jp_patrol_mission_work(). */
bool jp_patrol_choose_approach(const struct jp_terrain *map, const struct jp_footprint *footprint,
                               const struct jp_plane_pose *goal, struct jp_plane_pose *approach);

#endif
