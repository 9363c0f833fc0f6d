/**
 * The baseline that the paper compares with: cubic Bézier curves in time through the waypoints, smooth in position and
 * velocity, with the arrival times and the velocities at the waypoints optimised for energy (Liu and Sun, IEEE/ASME
 * T-Mechatronics 19(2), 2014, as the paper describes it).
 *
 * The energy that it minimises is the steady and inertial motor power of the robot without its controller's transient,
 *   ∫ (ul² + ur²)/Rm + Ps dt,   uc = ((β+fw) θ̇ + ½ Iθ θ̈)/α,   ud likewise for yaw,
 * or of the battery ∫ ul il + ur ir + Ps dt, so that the baseline is planned with the best knowledge that such a
 * planner has, and then driven like the others.
 */
#ifndef JOULEPATH_SIM_MISSIONS_BEZIER_H
#define JOULEPATH_SIM_MISSIONS_BEZIER_H

#include <stdbool.h>
#include <stddef.h>

#include "sim/balancer/energy_kind.h"
#include "sim/balancer/robot_file.h"

#define BEZIER_WAYPOINTS_MAX 128

struct bezier_point {
    double x; /**< m */
    double y; /**< m */
};

/** Curve i leads from waypoint i to i + 1 in duration[i], with velocity[i] at its start. */
struct bezier_path {
    size_t curves;
    struct bezier_point waypoint[BEZIER_WAYPOINTS_MAX];
    struct bezier_point velocity[BEZIER_WAYPOINTS_MAX]; /**< m/s */
    double duration[BEZIER_WAYPOINTS_MAX];              /**< s */
};

enum bezier_scope {
    BEZIER_SEGMENT, /**< one curve after the other, as a local planner works (and ours); smooth from rest */
    BEZIER_ROUTE    /**< all curves together, and the first may start with a step of speed, as ours does */
};

struct bezier_motion {
    double speed;     /**< m/s */
    double turn_rate; /**< rad/s */
    double heading;   /**< rad */
};

/**
 * Optimises the path through `count` waypoints (2…BEZIER_WAYPOINTS_MAX) for this energy within the robot's limit of
 * speed. That of its turn rate is for arcs: curves may turn as sharply as a robot does that begins a segment. False
 * when the optimiser fails.
 */
bool bezier_optimise(struct bezier_path *path, const struct robot_file *robot, enum energy_kind energy,
                     const struct bezier_point *waypoints, size_t count, enum bezier_scope scope);

/** Motion on curve `curve` at `seconds` after its start. */
struct bezier_motion bezier_motion(const struct bezier_path *path, size_t curve, double seconds);

#endif
