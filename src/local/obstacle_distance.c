/*
 * The footprint's rectangle against a shape's hull, in the robot's frame; only the result is turned back. Apart, the
 * nearest points are a vertex of the hull and the rectangle, or a corner and a side of the hull.
 */
#include "src/local/obstacle_distance.h"

#include "src/base/plane.h"
#include "src/local/obstacle_hull.h"

/* Below this squared distance, m², rounding would determine the direction between two points. */
#define TOUCH_SQUARE 1.0e-8f

/* The sides of the rectangle. */
enum {
    AHEAD = 1,
    BEHIND = 2,
    LEFT = 4,
    RIGHT = 8,
};

/* The points of rectangle and hull nearest to each other. */
struct nearest {
    float square;                 /* of their distance */
    struct jp_plane_point offset; /* from the hull's point to the rectangle's */
    struct jp_plane_point point;  /* the rectangle's */
    bool is_apart;                /* a side of one of both separates them */
};

static void see(struct jp_hull *hull, const struct jp_plane_pose *pose, struct jp_plane_point direction,
                const struct jp_obstacle *shape)
{
    hull->count = shape->vertex_count;
    for (unsigned i = 0; i < hull->count; i++) {
        const float dx = shape->vertices[i].x - pose->x;
        const float dy = shape->vertices[i].y - pose->y;

        hull->vertices[i].x = direction.x * dx + direction.y * dy;
        hull->vertices[i].y = direction.x * dy - direction.y * dx;
    }
}

/* Offset from a vertex to the rectangle, and the sides of the rectangle that the vertex is beyond. */
static inline struct jp_plane_point offset_from(struct jp_plane_point vertex, const struct jp_footprint *footprint,
                                                unsigned *beyond)
{
    struct jp_plane_point offset = {0.0f, 0.0f};

    *beyond = 0;
    if (vertex.x > footprint->front) {
        offset.x = footprint->front - vertex.x;
        *beyond = AHEAD;
    } else if (vertex.x < -footprint->rear) {
        offset.x = -footprint->rear - vertex.x;
        *beyond = BEHIND;
    } else {
        /* between them */
    }
    if (vertex.y > footprint->half_width) {
        offset.y = footprint->half_width - vertex.y;
        *beyond |= LEFT;
    } else if (vertex.y < -footprint->half_width) {
        offset.y = -footprint->half_width - vertex.y;
        *beyond |= RIGHT;
    } else {
        /* between them */
    }
    return offset;
}

static inline struct nearest nearest_vertex(const struct jp_footprint *footprint, const struct jp_hull *hull)
{
    struct nearest nearest = {.square = FLT_MAX};
    unsigned common = AHEAD | BEHIND | LEFT | RIGHT;

    for (unsigned i = 0; i < hull->count; i++) {
        const struct jp_plane_point vertex = hull->vertices[i];
        unsigned beyond;
        const struct jp_plane_point offset = offset_from(vertex, footprint, &beyond);
        const float square = offset.x * offset.x + offset.y * offset.y;

        common &= beyond;
        if (square < nearest.square) {
            nearest.square = square;
            nearest.offset = offset;
            nearest.point = (struct jp_plane_point){vertex.x + offset.x, vertex.y + offset.y};
        }
    }
    nearest.is_apart = common != 0U;
    return nearest;
}

/* A corner beyond the ends of the side is not nearer to it than to a vertex, which was compared before. */
static inline void compare_side(const struct jp_footprint *footprint, const struct jp_hull_side *side,
                                struct nearest *nearest)
{
    const struct jp_plane_point corner = jp_hull_lowest_corner(footprint, side);
    const float height = jp_hull_height(side, corner);

    if (height > 0.0f) {
        const float along = side->edge.x * (corner.x - side->first.x) + side->edge.y * (corner.y - side->first.y);

        nearest->is_apart = true;
        if (along > 0.0f && along < side->square) {
            const float scale = height / side->square;

            if (height * scale < nearest->square) {
                nearest->square = height * scale;
                nearest->offset = (struct jp_plane_point){side->edge.y * scale, -side->edge.x * scale};
                nearest->point = corner;
            }
        }
    }
}

/* Only sides that face the robot's origin can be nearest: of two vertices one of the two sides. */
static inline struct nearest find_nearest(const struct jp_footprint *footprint, const struct jp_hull *hull)
{
    struct nearest nearest = nearest_vertex(footprint, hull);

    for (unsigned i = 0; i < hull->count; i++) {
        const struct jp_hull_side side = jp_hull_side(hull, i);

        if (side.centre_height > 0.0f) {
            compare_side(footprint, &side, &nearest);
        }
    }
    return nearest;
}

static inline struct jp_separation separation(const struct jp_footprint *footprint, const struct jp_hull *hull)
{
    const struct nearest nearest = find_nearest(footprint, hull);

    if (!nearest.is_apart || nearest.square < TOUCH_SQUARE) {
        return jp_hull_separate(footprint, hull);
    }

    const float distance = jp_plane_square_root(nearest.square);
    const float scale = 1.0f / distance;

    return (struct jp_separation){distance, {nearest.offset.x * scale, nearest.offset.y * scale}, nearest.point};
}

float jp_obstacle_distance_along(const struct jp_footprint *footprint, const struct jp_plane_pose *pose,
                                 struct jp_plane_point direction, const struct jp_obstacle *shape,
                                 struct jp_plane_pose *gradient)
{
    struct jp_hull hull;

    see(&hull, pose, direction, shape);

    const struct jp_separation apart = separation(footprint, &hull);

    if (gradient != NULL) {
        gradient->x = direction.x * apart.normal.x - direction.y * apart.normal.y;
        gradient->y = direction.y * apart.normal.x + direction.x * apart.normal.y;
        gradient->heading = apart.point.x * apart.normal.y - apart.point.y * apart.normal.x;
    }
    return apart.distance - shape->radius;
}

float jp_obstacle_distance(const struct jp_footprint *footprint, const struct jp_plane_pose *pose,
                           const struct jp_obstacle *shape, struct jp_plane_pose *gradient)
{
    return jp_obstacle_distance_along(footprint, pose, jp_plane_direction(pose->heading), shape, gradient);
}
