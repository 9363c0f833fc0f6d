/* The one question that the simulator asks libccd (patrol_world.c), for the page, which has no libccd: whether two
 * upright prisms touch. They overlap in height, so it is one of the plane: whether the difference of the two holds the
 * origin, by the algorithm of Gilbert, Johnson and Keerthi. */
#include <ccd/ccd.h>
#include <stdbool.h>
#include <stddef.h>

/* More turns than rectangles and discs take; then they all but touch. */
#define TURNS_MAX 64

struct vector {
    double x;
    double y;
};

/* Points of the difference that may hold the origin between them, the newest last. */
struct simplex {
    struct vector points[3];
    size_t count;
};

static double dot(struct vector a, struct vector b)
{
    return a.x * b.x + a.y * b.y;
}

static struct vector minus(struct vector a, struct vector b)
{
    return (struct vector){a.x - b.x, a.y - b.y};
}

/* At right angles to a line, on the side of a point of which `towards` leads. */
static struct vector across(struct vector line, struct vector towards)
{
    const struct vector left = {-line.y, line.x};

    return dot(left, towards) >= 0 ? left : (struct vector){line.y, -line.x};
}

/* The point of the difference that is farthest in a direction. */
static struct vector farthest(const void *first, const void *second, const ccd_t *ccd, struct vector direction)
{
    ccd_vec3_t forth;
    ccd_vec3_t back;
    ccd_vec3_t a;
    ccd_vec3_t b;

    ccdVec3Set(&forth, direction.x, direction.y, 0);
    ccdVec3Set(&back, -direction.x, -direction.y, 0);
    ccd->support1(first, &forth, &a);
    ccd->support2(second, &back, &b);
    return (struct vector){a.v[0] - b.v[0], a.v[1] - b.v[1]};
}

/* Leaves the part that is nearest to the origin and says where to look next; true: the origin is within. */
static bool turn_to_origin(struct simplex *simplex, struct vector *direction)
{
    const struct vector newest = simplex->points[simplex->count - 1];
    const struct vector home = {-newest.x, -newest.y};

    if (simplex->count == 2) {
        *direction = across(minus(simplex->points[0], newest), home);
        return false;
    }
    for (size_t i = 0; i < 2; i++) {
        const struct vector edge = minus(simplex->points[i], newest);
        const struct vector inward = across(edge, minus(simplex->points[1 - i], newest));

        if (dot(inward, home) < 0) {
            simplex->points[0] = simplex->points[i];
            simplex->points[1] = newest;
            simplex->count = 2;
            *direction = (struct vector){-inward.x, -inward.y};
            return false;
        }
    }
    return true;
}

int ccdMPRIntersect(const void *first, const void *second, const ccd_t *ccd)
{
    struct vector direction = {1, 0};
    struct simplex simplex = {.points = {farthest(first, second, ccd, direction)}, .count = 1};

    direction = (struct vector){-simplex.points[0].x, -simplex.points[0].y};
    for (int i = 0; i < TURNS_MAX; i++) {
        const struct vector point = farthest(first, second, ccd, direction);

        if (dot(point, direction) < 0) {
            return 0;
        }
        simplex.points[simplex.count++] = point;
        if (turn_to_origin(&simplex, &direction)) {
            return 1;
        }
    }
    return 1;
}

/* CCD_INIT() names it; it is not called. */
void ccdFirstDirDefault(const void *first, const void *second, ccd_vec3_t *direction)
{
    (void)first;
    (void)second;
    ccdVec3Set(direction, 1, 0, 0);
}
