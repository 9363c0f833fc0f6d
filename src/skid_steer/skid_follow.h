/** A path that the robot follows by its odometry: a set-point every third tick, and in those between
 *  what is ahead, and the way back to it.
 *  Private to the core. */
#ifndef JOULEPATH_SKID_STEER_SKID_FOLLOW_H
#define JOULEPATH_SKID_STEER_SKID_FOLLOW_H

#include <joulepath/skid_robot.h>

/** Begins a path, at rest. Constant time. */
void jp_skid_follow_begin(struct jp_skid_follow *follow, const struct jp_lattice_path *path);

/** Forgets it. Constant time. */
void jp_skid_follow_end(struct jp_skid_follow *follow);

/** What the next tick follows. Constant time; each tick, after the odometry's. */
void jp_skid_follow_work(struct jp_skid_follow *follow, const struct jp_skid_odometry *odometry,
                         const struct jp_skid_odometry_config *config);

static inline bool jp_skid_follow_is_under_way(const struct jp_skid_follow *follow)
{
    return follow->path != NULL;
}

#endif
