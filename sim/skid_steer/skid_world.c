#include "sim/skid_steer/skid_world.h"

#include "sim/base/digital.h"

void skid_world_init(struct skid_world *world, const struct skid_steer_model *model, const struct skid_ground *ground,
                     const struct planar_pose *pose, uint64_t seed)
{
    *world = (struct skid_world){.tick = 0};
    skid_plant_init(&world->plant, model, ground, pose);
    random_init(&world->random, seed);
}

double skid_world_tick_seconds(const struct skid_world *world)
{
    return 1.0 / world->plant.model.control.rate_hz;
}

void skid_world_step(struct skid_world *world)
{
    const int bits = world->plant.model.pwm.bits;
    const struct skid_input input = {
        .duty = {digital_duty(world->actuation.duty_left, bits), digital_duty(world->actuation.duty_right, bits)},
        .driven = world->actuation.enabled != 0,
    };

    skid_plant_step(&world->plant, &input, skid_world_tick_seconds(world));
    world->tick++;
}

void skid_world_read(struct skid_world *world, struct skid_samples *samples)
{
    skid_instruments_read(&world->plant, world->encoder_start, &world->random, samples);
}
