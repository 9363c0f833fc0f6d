/** A balancer that the navigator drives. */
#ifndef JOULEPATH_SIM_MISSIONS_NAVIGATION_BALANCER_H
#define JOULEPATH_SIM_MISSIONS_NAVIGATION_BALANCER_H

#include <joulepath/balancer_vehicle.h>

#include "sim/balancer/rig.h"
#include "sim/missions/navigation_robot.h"

struct navigation_balancer {
    struct rig rig;
    struct jp_pilot pilot;
    struct jp_balancer_vehicle vehicle;
    struct clearance_pose start;
    enum jp_pilot_meter meter;
};

/** Switches on at `start` and lets it stand; it learns by that meter. `entry`, `file` and *balancer stay in use. False
 * after one line on stderr: a configuration is refused. */
bool navigation_balancer_init(struct navigation_balancer *balancer, const struct robot_entry *entry,
                              const struct robot_file *file, const struct clearance_pose *start, uint64_t seed,
                              enum jp_pilot_meter meter, struct navigation_robot *robot);

#endif
