/**
 * One skid-steered or differential-drive robot on its ground: plant, instruments and noise. Time runs in control ticks.
 * Worlds in one process do not disturb each other; one may be copied, and both go on alike.
 */
#ifndef JOULEPATH_SIM_SKID_STEER_SKID_WORLD_H
#define JOULEPATH_SIM_SKID_STEER_SKID_WORLD_H

#include <joulepath/sensors.h>

#include "sim/skid_steer/skid_instruments.h"

struct skid_world {
    struct skid_plant plant;
    struct random random;
    uint32_t encoder_start[SKID_SIDES];
    struct jp_actuation actuation; /**< of the next steps */
    uint64_t tick;
};

/** At rest at a pose of the middle between its axles, bridges off, tick 0. The model is copied; what `ground` points to
 *  stays in use. */
void skid_world_init(struct skid_world *world, const struct skid_steer_model *model, const struct skid_ground *ground,
                     const struct planar_pose *pose, uint64_t seed);

/** One tick of 1/control.rate_hz under world->actuation, at its PWM's resolution, from the sagging battery. */
void skid_world_step(struct skid_world *world);

/** Measures now. */
void skid_world_read(struct skid_world *world, struct skid_samples *samples);

/** Length of a tick, s. */
double skid_world_tick_seconds(const struct skid_world *world);

#endif
