/** A shape's hull against the footprint's rectangle, in the robot's frame, where that is upright. Private to
 *  libjoulepath_float. */
#ifndef JOULEPATH_LOCAL_OBSTACLE_HULL_H
#define JOULEPATH_LOCAL_OBSTACLE_HULL_H

#include <joulepath/obstacles.h>
#include <stdbool.h>

/** The hull of a shape in the robot's frame. */
struct jp_hull {
    struct jp_plane_point vertices[JP_OBSTACLE_VERTICES_MAX];
    unsigned count;
};

/** A side of the hull, from a vertex to the next. Heights over it point outward and are multiplied by its length. */
struct jp_hull_side {
    struct jp_plane_point first;
    struct jp_plane_point edge;
    float centre_height; /**< of the robot's origin */
};

/** How far rectangle and hull are apart along a direction. */
struct jp_separation {
    float distance;               /**< below 0 where they overlap */
    struct jp_plane_point normal; /**< of length 1, towards the robot */
    struct jp_plane_point point;  /**< in the robot's frame, where they touch or would touch */
};

static inline struct jp_hull_side jp_hull_side(struct jp_plane_point first, struct jp_plane_point second)
{
    const struct jp_plane_point edge = {second.x - first.x, second.y - first.y};

    return (struct jp_hull_side){first, edge, edge.x * first.y - edge.y * first.x};
}

static inline float jp_hull_side_square(const struct jp_hull_side *side)
{
    return side->edge.x * side->edge.x + side->edge.y * side->edge.y;
}

static inline float jp_hull_height(const struct jp_hull_side *side, struct jp_plane_point point)
{
    return side->centre_height + side->edge.y * point.x - side->edge.x * point.y;
}

/** The corner of the rectangle that is lowest over a side. */
static inline struct jp_plane_point jp_hull_lowest_corner(const struct jp_footprint *footprint,
                                                          const struct jp_hull_side *side)
{
    return (struct jp_plane_point){side->edge.y > 0.0f ? -footprint->rear : footprint->front,
                                   side->edge.x > 0.0f ? footprint->half_width : -footprint->half_width};
}

/** False when a side of the rectangle separates the two and they do not touch either. Otherwise their penetration, if
 * no side of the hull separates them: the least translation that does, as a distance of 0 or less. It does not pass the
 *  robot's origin through the hull, unless the origin is inside. */
bool jp_hull_overlaps(const struct jp_footprint *footprint, const struct jp_hull *hull, bool is_touching,
                      struct jp_separation *separation);

#endif
