#include "sim/missions/navigation_balancer.h"

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

    return (double)jp_robot_meter(&balancer->rig.robot)->model / JOULE;
}

bool navigation_balancer_init(struct navigation_balancer *balancer, const struct robot_entry *entry,
                              const struct robot_file *file, const struct clearance_pose *start, uint64_t seed,
                              struct navigation_robot *robot)
{
    const struct jp_pilot_config config = {.model = entry->energy, .learning = entry->learning};
    const char *field;

    balancer->start = *start;
    *robot = (struct navigation_robot){.name = entry->name,
                                       .rate_hz = file->control.rate_hz,
                                       .body = navigation_body(file),
                                       .margin_m = file->navigation.margin_m / 2,
                                       .unit_exponent = entry->energy->unit_exponent,
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
