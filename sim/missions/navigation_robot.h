/** A simulated robot, of any kind, that the navigator drives. */
#ifndef JOULEPATH_SIM_MISSIONS_NAVIGATION_ROBOT_H
#define JOULEPATH_SIM_MISSIONS_NAVIGATION_ROBOT_H

#include <joulepath/battery.h>
#include <joulepath/vehicle.h>

#include "sim/base/cell_pack.h"
#include "sim/base/clearance.h"

/** What feeds it: the constant supply of its file until it is fed by cells. */
struct navigation_supply {
    const struct jp_battery_config *battery; /**< that its firmware knows; NULL: none */
    double standing_w;                       /**< that it takes while it stands */
    double voltage_min_v;                    /**< of the bus: below, it switches its motors off */
    /** From now on cells feed it. */
    void (*feed)(void *self, const struct cell_constants *cell, const struct cell_wiring *wiring,
                 const struct cell_condition *condition);
    const struct cell_pack *pack; /**< these */
    /** Its own meter and its measured bus voltage. */
    jp_energy (*metered)(const void *self);
    jp_q16 (*bus_voltage)(const void *self);
    double cruise_w; /**< that it takes at its highest speed on level ground, as its model has it */
    /** What it plans from now on gets by with so many volts less than it was designed for. */
    void (*lack)(void *self, jp_q16 lacking);
};

/** Switched on and standing. */
struct navigation_robot {
    const char *name;
    struct jp_vehicle vehicle;
    double rate_hz;              /**< of its ticks */
    struct clearance_robot body; /**< its rectangle */
    double margin_m;             /**< that it leaves its trajectory by at most */
    int32_t unit_exponent;       /**< of the energies of its vehicle (joulepath/energy.h) */
    struct navigation_supply supply;
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
