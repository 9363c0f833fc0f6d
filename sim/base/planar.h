/** Poses and convex shapes in the plane: m from the south-west corner of the map, rad counterclockwise from its x axis.
 */
#ifndef JOULEPATH_SIM_BASE_PLANAR_H
#define JOULEPATH_SIM_BASE_PLANAR_H

#include <math.h>

#include "sim/base/strict_math.h"

struct planar_point {
    double x;
    double y;
};

struct planar_pose {
    double x;
    double y;
    double heading;
};

enum planar_kind { PLANAR_DISC, PLANAR_BOX };

struct planar_shape {
    enum planar_kind kind;
    struct planar_pose pose; /**< of its centre */
    double radius;           /**< of a disc, m */
    double half_length;      /**< of a box, along its heading, m */
    double half_width;       /**< of a box, m */
};

/** The angle within −π…π. */
static inline double planar_wrap(double angle)
{
    return remainder(angle, 2 * M_PI);
}

/** From the frame of `pose` to the one that `pose` is in. */
static inline struct planar_point planar_place(const struct planar_pose *pose, struct planar_point point)
{
    const struct strict_turn turn = strict_sin_cos(pose->heading);

    return (struct planar_point){pose->x + turn.cosine * point.x - turn.sine * point.y,
                                 pose->y + turn.sine * point.x + turn.cosine * point.y};
}

/** `motion`, in the frame of `pose`, done from there. */
static inline struct planar_pose planar_compose(const struct planar_pose *pose, const struct planar_pose *motion)
{
    const struct planar_point end = planar_place(pose, (struct planar_point){motion->x, motion->y});

    return (struct planar_pose){end.x, end.y, planar_wrap(pose->heading + motion->heading)};
}

/** `motion` done from `pose` along an arc: to its heading the pose turns evenly. */
static inline struct planar_pose planar_bend(const struct planar_pose *pose, const struct planar_pose *motion)
{
    const struct planar_pose half_turn = {0, 0, motion->heading / 2};
    const struct planar_pose along = {motion->x, motion->y, motion->heading / 2};
    const struct planar_pose middle = planar_compose(pose, &half_turn);

    return planar_compose(&middle, &along);
}

/** The motion from `start` to `end`, in the frame of `start`. */
static inline struct planar_pose planar_between(const struct planar_pose *start, const struct planar_pose *end)
{
    const struct strict_turn turn = strict_sin_cos(start->heading);
    const double dx = end->x - start->x;
    const double dy = end->y - start->y;

    return (struct planar_pose){turn.cosine * dx + turn.sine * dy, turn.cosine * dy - turn.sine * dx,
                                planar_wrap(end->heading - start->heading)};
}

/** Radius of the circle about the shape's centre that encloses it, m. */
static inline double planar_reach(const struct planar_shape *shape)
{
    return shape->kind == PLANAR_DISC ? shape->radius : strict_hypot(shape->half_length, shape->half_width);
}

#endif
