#include "sim/missions/random_targets.h"

#include <math.h>

#include "sim/base/strict_math.h"

/* Legs in m, turns from leg to leg in rad. */
#define LEG_MIN  1.0
#define LEG_MAX  10.0
#define TURN_MAX 1.6

void random_targets_draw(struct random *random, const struct rig *rig, struct jp_point *targets, size_t count)
{
    const struct jp_point start = jp_robot_position(&rig->robot);
    double x = (double)start.x / JP_Q16_ONE;
    double y = (double)start.y / JP_Q16_ONE;
    double heading = rig->world.plant.state.yaw;

    for (size_t i = 0; i < count; i++) {
        const double length = random_uniform(random, LEG_MIN, LEG_MAX);

        heading += random_uniform(random, -TURN_MAX, TURN_MAX);
        x += length * strict_cos(heading);
        y += length * strict_sin(heading);
        targets[i] = (struct jp_point){(jp_q16)lround(x * JP_Q16_ONE), (jp_q16)lround(y * JP_Q16_ONE)};
    }
}
