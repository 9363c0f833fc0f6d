/*
 * The distance of overlapping shapes is minus the penetration depth: the least translation along the normal of a side
 * of one of both that separates them. A translation that passes the robot's origin through the hull is taken only if
 * there is no other: a robot whose front is through a wall moves back, however much of it is beyond the wall.
 */
#include "src/local/obstacle_hull.h"

#include "src/base/plane.h"

struct translation {
    bool is_allowed;
    struct jp_separation separation;
};

/* The translation over a side of the hull. */
static struct translation over(const struct jp_footprint *footprint, const struct jp_hull_side *side)
{
    const float scale = 1.0f / jp_plane_square_root(side->square);
    const struct jp_plane_point corner = jp_hull_lowest_corner(footprint, side);

    return (struct translation){
        side->centre_height >= 0.0f,
        {jp_hull_height(side, corner) * scale, {side->edge.y * scale, -side->edge.x * scale}, corner},
    };
}

/* The vertex that is farthest along a direction. */
static struct jp_plane_point farthest(const struct jp_hull *hull, struct jp_plane_point direction)
{
    struct jp_plane_point best = hull->vertices[0];

    for (unsigned i = 1; i < hull->count; i++) {
        const struct jp_plane_point vertex = hull->vertices[i];

        if ((vertex.x - best.x) * direction.x + (vertex.y - best.y) * direction.y > 0.0f) {
            best = vertex;
        }
    }
    return best;
}

/* The translation until the hull is beyond a side of the rectangle, whose distance from the origin is `reach`. */
static struct translation past(const struct jp_hull *hull, struct jp_plane_point normal, float reach)
{
    const struct jp_plane_point vertex = farthest(hull, normal);
    const float height = -(vertex.x * normal.x + vertex.y * normal.y);

    return (struct translation){height >= 0.0f, {height - reach, normal, vertex}};
}

static void prefer(struct translation *best, struct translation way)
{
    const bool is_shorter = way.separation.distance > best->separation.distance;

    if (way.is_allowed == best->is_allowed ? is_shorter : way.is_allowed) {
        *best = way;
    }
}

/* Of equal translations the first is taken: that over a side of the hull, which changes less with the heading. */
struct jp_separation jp_hull_separate(const struct jp_footprint *footprint, const struct jp_hull *hull)
{
    struct translation best = {.is_allowed = false, .separation.distance = -FLT_MAX};

    for (unsigned i = 0; i < hull->count; i++) {
        const struct jp_hull_side side = jp_hull_side(hull, i);

        if (side.square > 0.0f) {
            prefer(&best, over(footprint, &side));
        }
    }
    prefer(&best, past(hull, (struct jp_plane_point){0.0f, 1.0f}, footprint->half_width));
    prefer(&best, past(hull, (struct jp_plane_point){0.0f, -1.0f}, footprint->half_width));
    prefer(&best, past(hull, (struct jp_plane_point){1.0f, 0.0f}, footprint->rear));
    prefer(&best, past(hull, (struct jp_plane_point){-1.0f, 0.0f}, footprint->front));
    return best.separation;
}
