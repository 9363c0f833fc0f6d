#include "sim/balancer/hal_sim.h"

static enum jp_status read_sensors(void *context, struct jp_sensors *sensors)
{
    return world_read(context, sensors) ? JP_OK : JP_ERR_HARDWARE;
}

static enum jp_status write_actuation(void *context, const struct jp_actuation *actuation)
{
    return world_write(context, actuation) ? JP_OK : JP_ERR_HARDWARE;
}

struct jp_hal jp_hal_sim(struct world *world)
{
    return (struct jp_hal){.context = world, .read = read_sensors, .write = write_actuation};
}
