/** Paths for the patrol robot: any-angle A* over the map and the marks of a scan, smoothed. */
#ifndef JOULEPATH_SIM_PATROL_PATH_H
#define JOULEPATH_SIM_PATROL_PATH_H

#include <joulepath/grid_planner.h>
#include <joulepath/obstacles.h>

#include "four_wheel_file.h"
#include "laser.h"

#define PATROL_PATH_POINTS_MAX 4096
#define PATROL_PATH_SPACING    0.1 /* m */

struct patrol_path {
    struct jp_path_point points[PATROL_PATH_POINTS_MAX]; /**< smoothed */
    size_t count;
    struct jp_path_point way[PATROL_PATH_POINTS_MAX]; /**< turning points */
    size_t way_count;
    double length;    /**< of the points, m */
    double clearance; /**< that the planner could keep, m */
    struct jp_grid_counts counts;
};

struct patrol_planner;

/** A planner for a map, which is copied. NULL without memory. */
struct patrol_planner *patrol_planner_new(const struct jp_terrain *map, const struct four_wheel_file *robot);

void patrol_planner_free(struct patrol_planner *planner);

/** Adds what a scan saw from a pose; what its beams went through is as the given map says again. */
void patrol_planner_mark(struct patrol_planner *planner, const struct laser_scan *scan,
                         const struct planar_pose *scanner);

/** A path from one place to another: with the largest clearance of a few for which there is one. False: none. */
bool patrol_planner_find(struct patrol_planner *planner, const struct planar_point *from, const struct planar_point *to,
                         struct patrol_path *path);

/** Whether the robot's shape with a margin, m, is free on the map at a pose. */
bool patrol_planner_fits(const struct patrol_planner *planner, const struct planar_pose *pose, double margin);

#endif
