#include "sim/lattice/lattice_symmetry.h"

#define QUARTER (JP_HEADINGS / 4)

/* Of headings and of directions of unit steps, which are numbered alike. */
static unsigned reflected(unsigned direction)
{
    return (JP_HEADINGS + QUARTER - direction) % JP_HEADINGS;
}

static unsigned turned(unsigned direction)
{
    return (direction + QUARTER) % JP_HEADINGS;
}

void lattice_reflect(struct lattice_primitive *primitive)
{
    const int dx = primitive->dx;

    primitive->dx = primitive->dy;
    primitive->dy = dx;
    primitive->start = reflected(primitive->start);
    primitive->end = reflected(primitive->end);
    for (size_t i = 0; i < primitive->move_count; i++) {
        primitive->moves[i] = (uint8_t)reflected(primitive->moves[i]);
    }
    for (size_t i = 0; i < primitive->path.count; i++) {
        const struct lattice_pose pose = primitive->path.poses[i];
        primitive->path.poses[i] = (struct lattice_pose){pose.y, pose.x, LATTICE_PI / 2 - pose.heading};
    }
}

void lattice_turn_quarter(struct lattice_primitive *primitive)
{
    const int dx = primitive->dx;

    primitive->dx = -primitive->dy;
    primitive->dy = dx;
    primitive->start = turned(primitive->start);
    primitive->end = turned(primitive->end);
    for (size_t i = 0; i < primitive->move_count; i++) {
        primitive->moves[i] = (uint8_t)turned(primitive->moves[i]);
    }
    for (size_t i = 0; i < primitive->path.count; i++) {
        const struct lattice_pose pose = primitive->path.poses[i];
        primitive->path.poses[i] = (struct lattice_pose){-pose.y, pose.x, pose.heading + LATTICE_PI / 2};
    }
}
