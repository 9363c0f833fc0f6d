#include "sim/skid_steer/skid_hills.h"

#include <math.h>

#include "sim/base/strict_math.h"

struct skid_ground_point skid_on_hills(const void *context, double x, double y)
{
    const struct skid_hills *hills = context;
    struct skid_ground_point point = {0, 0, 0};

    for (int i = 0; i < SKID_HILLS; i++) {
        const double phase = hills->along_x[i] * x + hills->along_y[i] * y;
        const struct strict_turn turn = strict_sin_cos(phase);
        const double rise = hills->height[i] * turn.cosine;
        point.elevation += hills->height[i] * turn.sine;
        point.slope_x += rise * hills->along_x[i];
        point.slope_y += rise * hills->along_y[i];
    }
    return point;
}

struct skid_hills skid_random_hills(struct random *random, double steepest)
{
    struct skid_hills hills;

    for (int i = 0; i < SKID_HILLS; i++) {
        const double number = 2 * M_PI / random_uniform(random, 4, 12);
        const double turn = random_uniform(random, -M_PI, M_PI);
        hills.along_x[i] = number * strict_cos(turn);
        hills.along_y[i] = number * strict_sin(turn);
        hills.height[i] = random_uniform(random, 0, steepest / SKID_HILLS) / number;
    }
    return hills;
}

struct skid_hills skid_random_hills_within(struct random *random, double degrees)
{
    struct skid_hills hills = skid_random_hills(random, 1);
    const double steepest = strict_tan(random_uniform(random, 0, degrees) * M_PI / 180);
    double sum = 0;

    for (int i = 0; i < SKID_HILLS; i++) {
        sum += hills.height[i] * strict_hypot(hills.along_x[i], hills.along_y[i]);
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
