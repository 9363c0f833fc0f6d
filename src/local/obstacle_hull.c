/*
 * The distance of overlapping shapes is minus the least way along the normal of a side of one of both that brings them
 * apart. A way on which the robot's origin would pass through the hull is taken only if there is no other: a robot
 * whose nose is through a wall goes back, however much of it is beyond.
 */
#include "src/local/obstacle_hull.h"

#include "src/base/plane.h"

struct way_out {
    bool is_allowed;
    struct jp_separation separation;
};

/* Over a side of the hull. */
static struct way_out over(const struct jp_footprint *footprint, const struct jp_hull_side *side)
{
    const float scale = 1.0f / jp_plane_square_root(side->square);
    const struct jp_plane_point corner = jp_hull_lowest_corner(footprint, side);

    return (struct way_out){
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

/* Until the hull is beyond a side of the rectangle; `reach` is that side's distance from the origin. */
static struct way_out past(const struct jp_hull *hull, struct jp_plane_point normal, float reach)
{
    const struct jp_plane_point vertex = farthest(hull, normal);
    const float height = -(vertex.x * normal.x + vertex.y * normal.y);

    return (struct way_out){height >= 0.0f, {height - reach, normal, vertex}};
}

static void prefer(struct way_out *best, struct way_out way)
{
    const bool is_shorter = way.separation.distance > best->separation.distance;

    if (way.is_allowed == best->is_allowed ? is_shorter : way.is_allowed) {
        *best = way;
    }
}

/* Of ways equally long the first is taken: over a side of the hull, which turning changes less. */
struct jp_separation jp_hull_way_out(const struct jp_footprint *footprint, const struct jp_hull *hull)
{
    struct way_out best = {.is_allowed = false, .separation.distance = -FLT_MAX};

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
