/**
 * Obstacles around the robot as a bounded set of convex shapes, and how near a robot's footprint is to them.
 *
 * Single-precision floating point; part of libjoulepath_float. Lengths and distances are in m, angles in rad. All is in
 * the frame of the robot's poses. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_OBSTACLES_H
#define JOULEPATH_OBSTACLES_H

#include <joulepath/plane.h>
#include <joulepath/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_OBSTACLES_MAX         20
#define JP_OBSTACLE_VERTICES_MAX 4

/** Fastest along x or y, m/s, and largest margin, m. */
#define JP_OBSTACLE_SPEED_MAX  1000.0f
#define JP_OBSTACLE_MARGIN_MAX 1000.0f

/** All points within `radius` of the convex hull of the vertices: disc, capsule, or a polygon with round corners. */
struct jp_obstacle {
    struct jp_plane_point vertices[JP_OBSTACLE_VERTICES_MAX]; /**< of a polygon counterclockwise */
    uint8_t vertex_count;                                     /**< 1…JP_OBSTACLE_VERTICES_MAX */
    float radius;                                             /**< 0…32 767 */
    struct jp_plane_point velocity; /**< m/s, each ±JP_OBSTACLE_SPEED_MAX; (0, 0): it stands */
    float margin; /**< how far it may be after a second from where its velocity leads, m; 0…JP_OBSTACLE_MARGIN_MAX */
};

/** The nearest obstacles. The members may be read. */
struct jp_obstacles {
    struct jp_obstacle shapes[JP_OBSTACLES_MAX];
    float distance[JP_OBSTACLES_MAX]; /**< of each from the centre of interest, ascending; below 0 if around it */
    uint8_t count;
    uint32_t dropped; /**< shapes since the last clear that were too far away to be kept */
    struct jp_plane_point centre;
};

/** The robot's footprint: a rectangle along its heading, from −rear to front and `half_width` to both sides. */
struct jp_footprint {
    float front;      /**< 0 or more */
    float rear;       /**< 0 or more */
    float half_width; /**< above 0 */
};

/** A scan of distances taken at one instant from one place. */
struct jp_scan {
    const float *ranges; /**< 0: nothing was seen by this beam; below 0 or not finite: the beam dropped out */
    uint16_t count;      /**< of the beams; 2 or more */
    float first_angle;   /**< of beam 0, counterclockwise from the sensor's heading; −7…7 */
    float angle_step;    /**< to the next beam, counterclockwise; above 0, all beams within 7 */
};

/** How a scan becomes shapes. */
struct jp_scan_config {
    float range_max; /**< what is farther away is left out; above 0, at most 1 000 */
    float gap;       /**< points farther apart belong to different shapes; above 0, at most 1 000 */
    float tolerance; /**< of points from the chord that stands for them, and radius of a single point; 0.001…1 000 */
    uint16_t beams_min; /**< fewer points side by side are noise; 1 or more */
};

/** Removes all obstacles. From now on those nearest to `centre` are kept. Constant time. */
void jp_obstacles_clear(struct jp_obstacles *obstacles, const struct jp_plane_point *centre);

/**
 * Adds a shape, in order of distance; drops the farthest and counts it when there is no room. JP_ERR_ARGUMENT: a null
 * pointer, no vertex or too many, a value out of its range, or a polygon that is not convex or not counterclockwise;
 * then nothing changes. Work: one distance, and one comparison with each of the others.
 */
enum jp_status jp_obstacles_add(struct jp_obstacles *obstacles, const struct jp_obstacle *shape);

/**
 * Adds what a scan sees: points side by side without a gap are split until each part lies within the tolerance of its
 * chord (Douglas and Peucker). A part becomes a capsule through the middle of its points, just wide enough for all of
 * them; a single point becomes a disc. At most 12 splits are nested in each other.
 * JP_ERR_ARGUMENT: a null pointer, a value out of its range or a sensor beyond ±31 767 m. JP_ERR_UNRELIABLE: fewer than
 * a quarter of the beams worked, so that the scan cannot be trusted. Then nothing is added. Work: sine and cosine of
 * each beam, once for each split that it is within and twice more: at most 14 times.
 */
enum jp_status jp_obstacles_add_scan(struct jp_obstacles *obstacles, const struct jp_scan_config *config,
                                     const struct jp_scan *scan, const struct jp_plane_pose *sensor);

/**
 * Distance of the footprint at a pose from a shape that jp_obstacles_add() would take, and in *gradient, where not
 * null, its derivatives by the pose's x, y and heading. To about 10⁻⁶ of the largest coordinate.
 *
 * Where footprint and hull overlap, the distance is minus the penetration depth, less the radius: the least translation
 * along a normal of one of their sides that separates them without passing the pose through the hull. Constant time:
 * two sines and, on a Cortex-M7, about 270 instructions for a separate capsule and at most 1 100 for any shape.
 */
float jp_obstacle_distance(const struct jp_footprint *footprint, const struct jp_plane_pose *pose,
                           const struct jp_obstacle *shape, struct jp_plane_pose *gradient);

/** In place of a distance: there is no shape. */
#define JP_OBSTACLE_NONE 1.0e9f

/** Distance of the footprint at a pose from the nearest shape; JP_OBSTACLE_NONE without any. Work: at most all shapes.
 */
float jp_obstacles_distance(const struct jp_obstacles *obstacles, const struct jp_footprint *footprint,
                            const struct jp_plane_pose *pose);

#ifdef __cplusplus
}
#endif

#endif
