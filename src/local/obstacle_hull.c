/*
 * The distance of overlapping shapes is minus the penetration depth: the least translation along the normal of a side
 * of one of both that separates them. A translation that passes the robot's origin through the hull is taken only if
 * there is no other: a robot whose front is through a wall moves back, however much of it is beyond the wall.
 */
#include "src/local/obstacle_hull.h"

#include "src/base/plane.h"

/* The outermost vertices. */
struct extremes {
    const struct jp_plane_point *ahead;  /* of the greatest x */
    const struct jp_plane_point *behind; /* of the least x */
    const struct jp_plane_point *left;   /* of the greatest y */
    const struct jp_plane_point *right;  /* of the least y */
};

static inline struct extremes extremes_of(const struct jp_hull *hull)
{
    const struct jp_plane_point *const first = hull->vertices;
    struct extremes extremes = {first, first, first, first};

    for (const struct jp_plane_point *vertex = &first[1]; vertex < &first[hull->count]; vertex++) {
        extremes.ahead = vertex->x > extremes.ahead->x ? vertex : extremes.ahead;
        extremes.behind = vertex->x < extremes.behind->x ? vertex : extremes.behind;
        extremes.left = vertex->y > extremes.left->y ? vertex : extremes.left;
        extremes.right = vertex->y < extremes.right->y ? vertex : extremes.right;
    }
    return extremes;
}

static inline bool are_apart(const struct jp_footprint *footprint, const struct extremes *extremes)
{
    return extremes->behind->x > footprint->front || extremes->ahead->x < -footprint->rear ||
           extremes->right->y > footprint->half_width || extremes->left->y < -footprint->half_width;
}

/* The best translation so far. */
struct translation {
    struct jp_separation *separation;
    bool is_allowed;
};

/* Whether a translation of so much is better: it is allowed, or shorter. */
static inline bool is_better(const struct translation *best, bool is_allowed, float distance)
{
    return is_allowed == best->is_allowed ? distance > best->separation->distance : is_allowed;
}

/* The translation over a side of the hull. */
static inline void try_over(struct translation *best, const struct jp_footprint *footprint,
                            const struct jp_hull_side *side, float square)
{
    const bool is_allowed = side->centre_height >= 0.0f;
    const float scale = 1.0f / jp_plane_square_root(square);
    const struct jp_plane_point corner = jp_hull_lowest_corner(footprint, side);
    const float distance = jp_hull_height(side, corner) * scale;

    if (is_better(best, is_allowed, distance)) {
        *best->separation = (struct jp_separation){distance, {side->edge.y * scale, -side->edge.x * scale}, corner};
        best->is_allowed = is_allowed;
    }
}

/* The translation until the hull is beyond a side of the rectangle, which is `reach` from the origin. `height` is that
 * of the hull's vertex farthest inside. */
static inline void try_past(struct translation *best, const struct jp_plane_point *vertex, float height,
                            struct jp_plane_point normal, float reach)
{
    const bool is_allowed = height >= 0.0f;

    if (is_better(best, is_allowed, height - reach)) {
        *best->separation = (struct jp_separation){height - reach, normal, *vertex};
        best->is_allowed = is_allowed;
    }
}

/* Of equal translations the first is taken: that over a side of the hull, which changes less with the heading. */
static inline void separate(const struct jp_footprint *footprint, const struct jp_hull *hull,
                            const struct extremes *extremes, struct jp_separation *separation)
{
    struct translation best = {separation, false};
    struct jp_plane_point last = hull->vertices[hull->count - 1U];

    separation->distance = -FLT_MAX;
    for (unsigned i = 0; i < hull->count; i++) {
        const struct jp_hull_side side = jp_hull_side(last, hull->vertices[i]);
        const float square = jp_hull_side_square(&side);

        last = hull->vertices[i];
        if (square > 0.0f) {
            try_over(&best, footprint, &side, square);
        }
    }
    try_past(&best, extremes->left, -extremes->left->y, (struct jp_plane_point){0.0f, 1.0f}, footprint->half_width);
    try_past(&best, extremes->right, extremes->right->y, (struct jp_plane_point){0.0f, -1.0f}, footprint->half_width);
    try_past(&best, extremes->ahead, -extremes->ahead->x, (struct jp_plane_point){1.0f, 0.0f}, footprint->rear);
    try_past(&best, extremes->behind, extremes->behind->x, (struct jp_plane_point){-1.0f, 0.0f}, footprint->front);
}

bool jp_hull_overlaps(const struct jp_footprint *footprint, const struct jp_hull *hull, bool is_touching,
                      struct jp_separation *separation)
{
    const struct extremes extremes = extremes_of(hull);

    if (!is_touching && are_apart(footprint, &extremes)) {
        return false;
    }
    separate(footprint, hull, &extremes, separation);
    return true;
}
