#include "sim/missions/navigation_balancer.h"

#include <math.h>

#include "sim/base/error.h"
#include "sim/missions/navigation_sight.h"

#define JOULE 4294967296.0

/** It stands before it is told where to go, s. */
#define STAND_SECONDS 2.0

static void tick(void *self)
{
    struct navigation_balancer *balancer = self;

    rig_tick(&balancer->rig);
}

static struct clearance_pose pose(const void *self)
{
    const struct navigation_balancer *balancer = self;

    return navigation_pose(&balancer->start, &balancer->rig.world.plant);
}

static double joules(const void *self)
{
    const struct navigation_balancer *balancer = self;

    const struct jp_meter *meter = jp_robot_meter(&balancer->rig.robot);

    return (double)(balancer->meter == JP_PILOT_BATTERY ? meter->battery : meter->model) / JOULE;
}

static void feed(void *self, const struct cell_constants *cell, const struct cell_wiring *wiring,
                 const struct cell_condition *condition)
{
    struct navigation_balancer *balancer = self;

    world_feed(&balancer->rig.world, cell, wiring, condition);
}

static jp_energy metered(const void *self)
{
    const struct navigation_balancer *balancer = self;

    return jp_robot_meter(&balancer->rig.robot)->battery;
}

static jp_q16 bus_voltage(const void *self)
{
    const struct navigation_balancer *balancer = self;
    const struct jp_sensors *frame = jp_robot_good_frame(&balancer->rig.robot);

    return frame != NULL ? frame->bus_voltage : 0;
}

static double cruise_power(const struct robot_file *file, const struct jp_energy_model *model)
{
    const double speed = file->limits.speed_m_s;

    return ldexp(model->b[0] * speed * speed + model->electronics_power, model->unit_exponent - 16);
}

static void lack(void *self, jp_q16 lacking)
{
    struct navigation_balancer *balancer = self;

    (void)jp_pilot_lack_voltage(&balancer->pilot, lacking);
}

bool navigation_balancer_init(struct navigation_balancer *balancer, const struct robot_entry *entry,
                              const struct robot_file *file, const struct clearance_pose *start, uint64_t seed,
                              enum jp_pilot_meter meter, struct navigation_robot *robot)
{
    const bool is_battery = meter == JP_PILOT_BATTERY;
    const struct jp_pilot_config config = {.model = is_battery ? entry->energy_battery : entry->energy,
                                           .learning = is_battery ? entry->learning_battery : entry->learning,
                                           .meter = meter};
    const char *field;

    if (config.model == NULL) {
        error_line("%s: no energy model of its battery is built in; run make identify ROBOT=%s", entry->name,
                   entry->name);
        return false;
    }
    balancer->start = *start;
    balancer->meter = meter;
    *robot = (struct navigation_robot){.name = entry->name,
                                       .rate_hz = file->control.rate_hz,
                                       .body = navigation_body(file),
                                       .margin_m = file->navigation.margin_m / 2,
                                       .unit_exponent = config.model->unit_exponent,
                                       .supply = {.battery = entry->battery,
                                                  .standing_w = file->electronics.power_w,
                                                  .voltage_min_v = file->control.voltage_min_v,
                                                  .feed = feed,
                                                  .pack = &balancer->rig.world.pack,
                                                  .metered = metered,
                                                  .bus_voltage = bus_voltage,
                                                  .cruise_w = cruise_power(file, config.model),
                                                  .lack = lack},
                                       .self = balancer,
                                       .tick = tick,
                                       .pose = pose,
                                       .joules = joules};
    if (!rig_init(&balancer->rig, entry, file, seed)) {
        return false;
    }
    rig_release(&balancer->rig, 0);
    if (jp_pilot_init(&balancer->pilot, &config, &balancer->rig.robot, &field) != JP_OK) {
        error_line("%s: the energy model is refused: %s; run make identify", entry->name, field);
        return false;
    }
    (void)jp_balancer_vehicle_init(&balancer->vehicle, &balancer->pilot, &robot->vehicle);
    for (int i = 0; i < (int)(STAND_SECONDS * file->control.rate_hz); i++) {
        rig_tick(&balancer->rig);
    }
    return true;
}
