/** What the legs of trajectories take of a robot that differs from its file, beside what its model expects. */
#ifndef JOULEPATH_SIM_MISSIONS_LEG_DRIVE_H
#define JOULEPATH_SIM_MISSIONS_LEG_DRIVE_H

#include "sim/balancer/rig.h"
#include "sim/balancer/variation.h"

/** Legs of a route, from stand to stand. */
#define LEG_DRIVE_ROUTE 4

/** Legs of the routes to learn on, and of those to forecast. */
#define LEG_DRIVE_LEARNT   24
#define LEG_DRIVE_FORECAST 12
#define LEG_DRIVE_LEGS     (LEG_DRIVE_LEARNT + LEG_DRIVE_FORECAST)

struct driven_leg {
    struct jp_leg_energy expected;
    double measured; /**< J, electronics included */
};

struct leg_drive {
    uint64_t seed;
    struct variation variation;
    const struct jp_energy_model *model; /**< of what is expected */
    struct driven_leg legs[LEG_DRIVE_LEGS];
};

/** Drives the robot of a seed, at the speed that spends the least of this energy; other robots than trip_run() has for
 * it. False after one line on stderr. */
bool leg_drive_run(struct leg_drive *legs, const struct robot_entry *entry, enum energy_kind kind,
                   const struct robot_file *file, uint64_t seed);

#endif
