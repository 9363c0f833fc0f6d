#include "sim/base/clearance.h"

#include <math.h>

#include "sim/base/strict_math.h"

/** Poses along an arc are so near each other that no point of the footprint moves farther between two of them, cells.
 */
#define STEP_CELLS 0.1

/** The footprint in units of cells. */
struct box {
    double x, y;
    double cosine, sine;
    double half_length, half_width;
};

static double resolution_of(const struct jp_terrain *terrain)
{
    return (double)terrain->config.resolution / JP_Q16_ONE;
}

static struct box box_at(const struct jp_terrain *terrain, const struct clearance_robot *robot,
                         const struct clearance_pose *pose)
{
    const double cell = resolution_of(terrain);

    return (struct box){pose->x / cell,
                        pose->y / cell,
                        strict_cos(pose->heading),
                        strict_sin(pose->heading),
                        (robot->length_m / 2 + robot->margin_m) / cell,
                        (robot->width_m / 2 + robot->margin_m) / cell};
}

static bool is_free(const struct jp_terrain *terrain, int left, int right, int y)
{
    const struct jp_span row = {0, 0, (int8_t)(right - left)};

    return jp_terrain_is_clear(terrain, &row, 1, left, y);
}

/* Separating axes of two rectangles: those of the map, then those of the robot. */
static bool touches(const struct box *box, int x, int y)
{
    const double dx = x + 0.5 - box->x;
    const double dy = y + 0.5 - box->y;
    const double cosine = fabs(box->cosine);
    const double sine = fabs(box->sine);
    const double cell_reach = (cosine + sine) / 2;

    return fabs(dx) < 0.5 + box->half_length * cosine + box->half_width * sine &&
           fabs(dy) < 0.5 + box->half_length * sine + box->half_width * cosine &&
           fabs(dx * box->cosine + dy * box->sine) < box->half_length + cell_reach &&
           fabs(dy * box->cosine - dx * box->sine) < box->half_width + cell_reach;
}

static bool touches_row(const struct jp_terrain *terrain, const struct box *box, int left, int right, int y)
{
    for (int x = left; x <= right; x++) {
        if (!is_free(terrain, x, x, y) && touches(box, x, y)) {
            return true;
        }
    }
    return false;
}

bool clearance_at(const struct jp_terrain *terrain, const struct clearance_robot *robot,
                  const struct clearance_pose *pose)
{
    const struct box box = box_at(terrain, robot, pose);
    const double radius = strict_hypot(box.half_length, box.half_width);
    const int left = (int)floor(box.x - radius);
    const int right = (int)floor(box.x + radius);

    for (int y = (int)floor(box.y - radius); y <= (int)floor(box.y + radius); y++) {
        if (!is_free(terrain, left, right, y) && touches_row(terrain, &box, left, right, y)) {
            return false;
        }
    }
    return true;
}

struct clearance_pose clearance_arc_pose(const struct clearance_arc *arc, double share)
{
    const double angle = arc->angle * share;
    const double half = angle / 2;
    const double chord = arc->length_m * share * (half == 0 ? 1 : strict_sin(half) / half);
    const double bearing = arc->start.heading + half;

    return (struct clearance_pose){arc->start.x + chord * strict_cos(bearing),
                                   arc->start.y + chord * strict_sin(bearing), arc->start.heading + angle};
}

unsigned clearance_steps(const struct jp_terrain *terrain, const struct clearance_robot *robot,
                         const struct clearance_arc *arc)
{
    const double radius = strict_hypot(robot->length_m, robot->width_m) / 2 + robot->margin_m;
    const double way = fabs(arc->length_m) + radius * fabs(arc->angle);

    return (unsigned)ceil(way / (STEP_CELLS * resolution_of(terrain)));
}
