#include "sim/skid_steer/skid_hills.h"

#include <math.h>

struct skid_ground_point skid_on_hills(const void *context, double x, double y)
{
    const struct skid_hills *hills = context;
    struct skid_ground_point point = {0, 0, 0};

    for (int i = 0; i < SKID_HILLS; i++) {
        const double ahead = hills->number[i] * cos(hills->turn[i]);
        const double across = hills->number[i] * sin(hills->turn[i]);
        const double phase = ahead * x + across * y;
        point.elevation += hills->height[i] * sin(phase);
        point.slope_x += hills->height[i] * ahead * cos(phase);
        point.slope_y += hills->height[i] * across * cos(phase);
    }
    return point;
}

struct skid_hills skid_random_hills(struct random *random, double steepest)
{
    struct skid_hills hills;

    for (int i = 0; i < SKID_HILLS; i++) {
        hills.number[i] = 2 * M_PI / random_uniform(random, 4, 12);
        hills.turn[i] = random_uniform(random, -M_PI, M_PI);
        hills.height[i] = random_uniform(random, 0, steepest / SKID_HILLS) / hills.number[i];
    }
    return hills;
}

struct skid_hills skid_random_hills_within(struct random *random, double degrees)
{
    struct skid_hills hills = skid_random_hills(random, 1);
    const double steepest = tan(random_uniform(random, 0, degrees) * M_PI / 180);
    double sum = 0;

    for (int i = 0; i < SKID_HILLS; i++) {
        sum += hills.height[i] * hills.number[i];
    }
    for (int i = 0; i < SKID_HILLS; i++) {
        hills.height[i] *= steepest / sum;
    }
    return hills;
}

struct skid_ground skid_ground_hills(const struct skid_hills *hills)
{
    return (struct skid_ground){skid_on_hills, hills};
}
