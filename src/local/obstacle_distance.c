/*
 * The footprint's rectangle against a shape's hull, in the robot's frame; only the result is turned back. Apart, the
 * nearest points are a vertex of the hull and the rectangle, or a corner and a side of the hull.
 */
#include "src/local/obstacle_distance.h"

#include "src/base/plane.h"
#include "src/local/obstacle_hull.h"

/* Below this squared distance, m², rounding would determine the direction between two points. */
#define TOUCH_SQUARE 1.0e-8f

/* Of features: below, sides by the vertex that they end at; from there on, vertices. */
#define FIRST_VERTEX ((unsigned)JP_OBSTACLE_VERTICES_MAX)

/* The points of rectangle and hull nearest to each other. */
struct nearest {
    float square;                 /* of their distance */
    struct jp_plane_point offset; /* from the hull's point to the rectangle's */
    struct jp_plane_point point;  /* the rectangle's */
    uint8_t feature;              /* of the hull */
};

/* What is seen from where. */
struct view {
    const struct jp_footprint *footprint;
    const struct jp_plane_pose *pose;
    const struct jp_plane_point *direction;
    const struct jp_obstacle *shape;
};

static inline struct jp_plane_point seen(const struct view *view, unsigned vertex)
{
    const float dx = view->shape->vertices[vertex].x - view->pose->x;
    const float dy = view->shape->vertices[vertex].y - view->pose->y;

    return (struct jp_plane_point){view->direction->x * dx + view->direction->y * dy,
                                   view->direction->x * dy - view->direction->y * dx};
}

/* From a coordinate to the rectangle's −low…high. */
static inline float offset_of(float coordinate, float low, float high)
{
    return coordinate > high ? high - coordinate : coordinate < -low ? -low - coordinate : 0.0f;
}

static inline void compare_vertex(const struct jp_footprint *footprint, struct jp_plane_point vertex, unsigned index,
                                  struct nearest *nearest)
{
    const float x = offset_of(vertex.x, footprint->rear, footprint->front);
    const float y = offset_of(vertex.y, footprint->half_width, footprint->half_width);
    const float square = x * x + y * y;

    if (square < nearest->square) {
        *nearest = (struct nearest){square, {x, y}, {vertex.x + x, vertex.y + y}, (uint8_t)(FIRST_VERTEX + index)};
    }
}

/* Turns the shape into the robot's frame, and finds the vertex that is nearest to the rectangle. */
static inline struct nearest see(const struct view *view, struct jp_hull *hull)
{
    struct nearest nearest = {.square = FLT_MAX};

    hull->count = view->shape->vertex_count;
    for (unsigned i = 0; i < hull->count; i++) {
        hull->vertices[i] = seen(view, i);
        compare_vertex(view->footprint, hull->vertices[i], i, &nearest);
    }
    return nearest;
}

/* Only sides that face the robot's origin can be nearest: of two vertices one of the two sides. A corner beyond the
 * ends of the side is not nearer to it than to a vertex. True when the side is between rectangle and hull. */
static inline bool compare_side(const struct jp_footprint *footprint, const struct jp_hull_side *side, unsigned index,
                                struct nearest *nearest)
{
    const struct jp_plane_point corner = jp_hull_lowest_corner(footprint, side);
    const float height = jp_hull_height(side, corner);

    if (side->centre_height <= 0.0f || height <= 0.0f) {
        return false;
    }

    const float along = side->edge.x * (corner.x - side->first.x) + side->edge.y * (corner.y - side->first.y);
    const float square = jp_hull_side_square(side);

    if (along > 0.0f && along < square) {
        const float scale = height / square;

        if (height * scale < nearest->square) {
            nearest->square = height * scale;
            nearest->offset = (struct jp_plane_point){side->edge.y * scale, -side->edge.x * scale};
            nearest->point = corner;
            nearest->feature = (uint8_t)index;
        }
    }
    return true;
}

/* True when a side is between rectangle and hull. */
static inline bool compare_sides(const struct jp_footprint *footprint, const struct jp_hull *hull,
                                 struct nearest *nearest)
{
    struct jp_plane_point last = hull->vertices[hull->count - 1U];
    bool is_apart = false;

    for (unsigned i = 0; i < hull->count; i++) {
        const struct jp_hull_side side = jp_hull_side(last, hull->vertices[i]);

        last = hull->vertices[i];
        is_apart = compare_side(footprint, &side, i, nearest) || is_apart;
    }
    return is_apart;
}

/* Whether a line between a vertex and the rectangle leaves another vertex on its side. */
static inline bool is_behind(const struct nearest *nearest, struct jp_plane_point vertex, struct jp_plane_point other)
{
    return nearest->offset.x * (other.x - vertex.x) + nearest->offset.y * (other.y - vertex.y) <= 0.0f;
}

/* Compares with the feature alone; true when it is the nearest: a line separates it and all of the hull behind it from
 * the rectangle. */
static inline bool look_again(const struct view *view, uint8_t feature, struct nearest *nearest)
{
    const unsigned last = view->shape->vertex_count - 1U;
    const unsigned index = feature % FIRST_VERTEX;
    const struct jp_plane_point vertex = seen(view, index);
    const struct jp_plane_point before = seen(view, index > 0U ? index - 1U : last);

    if (feature < FIRST_VERTEX) {
        const struct jp_hull_side side = jp_hull_side(before, vertex);

        return compare_side(view->footprint, &side, index, nearest) && nearest->square < FLT_MAX;
    }
    compare_vertex(view->footprint, vertex, index, nearest);
    return is_behind(nearest, vertex, before) && is_behind(nearest, vertex, seen(view, index < last ? index + 1U : 0U));
}

/* Searches all features. False: the two overlap, or touch; *apart tells how. */
static bool look(const struct view *view, struct nearest *nearest, struct jp_separation *apart)
{
    struct jp_hull hull;

    *nearest = see(view, &hull);

    const bool is_apart = compare_sides(view->footprint, &hull, nearest);
    const bool is_touching = nearest->square < TOUCH_SQUARE;

    return (is_apart && !is_touching) || !jp_hull_overlaps(view->footprint, &hull, is_touching, apart);
}

float jp_obstacle_distance_along(const struct jp_footprint *footprint, const struct jp_plane_pose *pose,
                                 struct jp_plane_point direction, const struct jp_obstacle *shape, uint8_t *feature,
                                 struct jp_plane_pose *gradient)
{
    const struct view view = {footprint, pose, &direction, shape};
    struct nearest nearest = {.square = FLT_MAX, .feature = JP_FEATURE_UNKNOWN};
    struct jp_separation apart;
    const bool is_same =
        *feature != JP_FEATURE_UNKNOWN && look_again(&view, *feature, &nearest) && nearest.square >= TOUCH_SQUARE;

    if (is_same || look(&view, &nearest, &apart)) {
        const float distance = jp_plane_square_root(nearest.square);
        const float scale = 1.0f / distance;

        apart = (struct jp_separation){distance, {nearest.offset.x * scale, nearest.offset.y * scale}, nearest.point};
        *feature = nearest.feature;
    } else {
        *feature = JP_FEATURE_UNKNOWN;
    }
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
    uint8_t feature = JP_FEATURE_UNKNOWN;

    return jp_obstacle_distance_along(footprint, pose, jp_plane_direction(pose->heading), shape, &feature, gradient);
}
