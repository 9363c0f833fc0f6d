/** Where a robot is along its path. Private to the patrol. */
#ifndef JOULEPATH_LOCAL_PATROL_PATH_H
#define JOULEPATH_LOCAL_PATROL_PATH_H

#include <joulepath/patrol.h>

/** A piece of the path ahead of the robot. */
struct jp_patrol_window {
    uint16_t first;
    uint16_t count;           /**< 2 or more points */
    struct jp_plane_pose end; /**< its last point and the path's direction there */
    bool is_goal;             /**< the piece ends where the path does */
    float distance;           /**< of the robot from the path, m */
    float direction;          /**< from the robot to the path a little ahead, rad */
};

/** Moves path_next on to what the robot has not passed; true when it moved. */
bool jp_patrol_advance(struct jp_patrol *patrol);

/** The path from the robot to the horizon, m; above 0. Work: points of the path within it. */
void jp_patrol_look_ahead(const struct jp_patrol *patrol, float horizon, struct jp_patrol_window *window);

/** Point of the path in m. */
struct jp_plane_point jp_patrol_path_point(const struct jp_point *point);

#endif
