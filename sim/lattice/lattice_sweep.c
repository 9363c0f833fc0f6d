#include "sim/lattice/lattice_sweep.h"

#include <ccd/ccd.h>
#include <math.h>

#include "sim/base/strict_math.h"

/* The prisms' heights differ, so that no two faces coincide. */
#define ROBOT_HALF_HEIGHT 1.0
#define CELL_HALF_HEIGHT  0.75

/* An upright box, turned about the vertical, or a disc. */
struct prism {
    double x, y;
    double cosine, sine;
    double half_length, half_width, half_height;
    double radius; /* of the disc; 0: it is a box */
};

static void support(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const struct prism *prism = object;
    const double along = prism->cosine * direction->v[0] + prism->sine * direction->v[1];
    const double across = prism->cosine * direction->v[1] - prism->sine * direction->v[0];
    const double u = copysign(prism->half_length, along);
    const double v = copysign(prism->half_width, across);

    ccdVec3Set(point, prism->x + prism->cosine * u - prism->sine * v, prism->y + prism->sine * u + prism->cosine * v,
               copysign(prism->half_height, direction->v[2]));
}

static void centre(const void *object, ccd_vec3_t *point)
{
    const struct prism *prism = object;

    ccdVec3Set(point, prism->x, prism->y, 0);
}

static bool touches(const struct prism *robot, int x, int y)
{
    const struct prism cell = {x, y, 1, 0, 0.5, 0.5, CELL_HALF_HEIGHT, 0};
    ccd_t ccd;

    if (robot->radius > 0) {
        return strict_hypot(fmax(fabs(robot->x - x) - 0.5, 0), fmax(fabs(robot->y - y) - 0.5, 0)) < robot->radius;
    }
    CCD_INIT(&ccd);
    ccd.support1 = support;
    ccd.support2 = support;
    ccd.center1 = centre;
    ccd.center2 = centre;
    return ccdMPRIntersect(robot, &cell, &ccd) != 0;
}

/* The cells that one pose covers. */
static bool cover(const struct prism *robot, struct lattice_cells *cells)
{
    const double radius = fmax(strict_hypot(robot->half_length, robot->half_width), robot->radius);
    const int left = (int)floor(robot->x - radius);
    const int right = (int)ceil(robot->x + radius);
    const int low = (int)floor(robot->y - radius);
    const int high = (int)ceil(robot->y + radius);

    if (left < -LATTICE_REACH || right > LATTICE_REACH || low < -LATTICE_REACH || high > LATTICE_REACH) {
        return false;
    }
    for (int y = low; y <= high; y++) {
        for (int x = left; x <= right; x++) {
            bool *at = &cells->at[y + LATTICE_REACH][x + LATTICE_REACH];
            *at = *at || touches(robot, x, y);
        }
    }
    return true;
}

bool lattice_sweep(const struct lattice_path *path, const struct lattice_footprint *footprint,
                   struct lattice_cells *cells)
{
    /* Grown by how far a corner turns in half the largest step, so that nothing is missed between two poses. */
    const double corner = strict_hypot(footprint->length, footprint->width) / 2;
    const double margin = path->count > 1 ? corner * LATTICE_TURN / 2 : 0;

    for (size_t i = 0; i < path->count; i++) {
        const struct lattice_pose *pose = &path->poses[i];
        const struct strict_turn turn = strict_sin_cos(pose->heading);
        const struct prism robot = {.x = pose->x,
                                    .y = pose->y,
                                    .cosine = turn.cosine,
                                    .sine = turn.sine,
                                    .half_length = footprint->length / 2 + margin,
                                    .half_width = footprint->width / 2 + margin,
                                    .half_height = ROBOT_HALF_HEIGHT,
                                    .radius = footprint->radius};
        if (!cover(&robot, cells)) {
            return false;
        }
    }
    return true;
}
