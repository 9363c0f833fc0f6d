/** Random ground for the plant of skid steer and differential drive: hills. */
#ifndef JOULEPATH_SIM_SKID_STEER_SKID_HILLS_H
#define JOULEPATH_SIM_SKID_STEER_SKID_HILLS_H

#include "sim/base/random.h"
#include "sim/skid_steer/skid_ground.h"

#define SKID_HILLS 3

/** Waves of 4 to 12 m. */
struct skid_hills {
    double height[SKID_HILLS];
    double along_x[SKID_HILLS]; /**< rad/m */
    double along_y[SKID_HILLS];
};

/** `steepest`: the slope that they cannot exceed. */
struct skid_hills skid_random_hills(struct random *random, double steepest);

/** Hills whose waves' slopes add up to that of an angle from 0 to `degrees`, evenly drawn. */
struct skid_hills skid_random_hills_within(struct random *random, double degrees);

/** The ground at a place of the struct skid_hills at `context`. */
struct skid_ground_point skid_on_hills(const void *context, double x, double y);

/** The ground of hills, which stay in use. */
struct skid_ground skid_ground_hills(const struct skid_hills *hills);

#endif
