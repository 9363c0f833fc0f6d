#include "sim/skid_steer/skid_hal_sim.h"

static enum jp_status read_sensors(void *context, struct jp_sensors *sensors)
{
    struct skid_samples samples;

    skid_world_read(context, &samples);
    *sensors = (struct jp_sensors){
        .encoder_left = samples.encoder_left,
        .encoder_right = samples.encoder_right,
        .pitch_rate = samples.pitch_rate,
        .yaw_rate = samples.yaw_rate,
        .accel_x = samples.accel_x,
        .accel_z = samples.accel_z,
        .current_left = samples.current_left,
        .current_right = samples.current_right,
        .bus_voltage = samples.bus_voltage,
    };
    return JP_OK;
}

static enum jp_status write_actuation(void *context, const struct jp_actuation *actuation)
{
    struct skid_world *world = context;

    world->actuation = *actuation;
    return JP_OK;
}

struct jp_hal skid_hal_sim(struct skid_world *world)
{
    return (struct jp_hal){.context = world, .read = read_sensors, .write = write_actuation};
}
