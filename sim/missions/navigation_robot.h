/** A simulated robot, of any kind, that the navigator drives. */
#ifndef JOULEPATH_SIM_MISSIONS_NAVIGATION_ROBOT_H
#define JOULEPATH_SIM_MISSIONS_NAVIGATION_ROBOT_H

#include <joulepath/vehicle.h>

#include "sim/base/clearance.h"

/** Switched on and standing. */
struct navigation_robot {
    const char *name;
    struct jp_vehicle vehicle;
    double rate_hz;              /**< of its ticks */
    struct clearance_robot body; /**< its rectangle */
    double margin_m;             /**< that it leaves its trajectory by at most */
    int32_t unit_exponent;       /**< of the energies of its vehicle (joulepath/energy.h) */
    void *self;
    /** One tick: control, physics. */
    void (*tick)(void *self);
    /** Where it truly is, m from the south-west corner of the map. */
    struct clearance_pose (*pose)(const void *self);
    /** J that it spent since it was switched on, as its vehicle's model counts them. */
    double (*joules)(const void *self);
    /** J that its battery gave at its terminals since then: what a robot's model learns, without what the battery burns
     * inside. NULL: `joules`. */
    double (*given)(const void *self);
    /** Standard deviation of its position as its odometry tells, m, in the worst direction; NULL: it does not tell. */
    double (*deviation)(const void *self);
};

#endif
