/** A robot in the loop: the firmware's jp_robot on the simulated HAL of a world. Rigs are independent of each other. */
#ifndef JOULEPATH_SIM_BALANCER_RIG_H
#define JOULEPATH_SIM_BALANCER_RIG_H

#include "sim/balancer/energy_kind.h"
#include "sim/balancer/hal_sim.h"
#include "sim/balancer/robots.h"

struct rig {
    struct world world;
    struct jp_hal hal;
    struct jp_robot robot;
    enum jp_status written;
};

/** The built-in robot of this name, or NULL after one line on stderr that lists them. */
const struct robot_entry *rig_find_robot(const char *name);

/** The robot's identified model of this energy, or NULL after one line on stderr. */
const struct jp_energy_model *rig_energy_model(const struct robot_entry *entry, enum energy_kind kind);

/** Ready and held upright. Prints one line on stderr and returns false when the configuration is refused. A rig must
 * not be moved after it. */
bool rig_init(struct rig *rig, const struct robot_entry *entry, const struct robot_file *file, uint64_t seed);

/** One tick: control, physics. */
void rig_tick(struct rig *rig);

/** A hand holds the robot at this pitch while it measures the vertical, then lets go: it balances. */
void rig_release(struct rig *rig, double pitch_rad);

#endif
