/** The balancers and lattices built into the host programs: one for each src/tables/robot_<name>.c and
 * lattice_<name>.c. The Makefile writes the lists, and those of the other kinds. */
#ifndef JOULEPATH_SIM_BALANCER_ROBOTS_H
#define JOULEPATH_SIM_BALANCER_ROBOTS_H

#include <stddef.h>

#include <joulepath/lattice.h>
#include <joulepath/learner.h>

struct jp_battery_config;
struct jp_navigator_body;
struct jp_robot_config;

struct robot_entry {
    const char *name;
    const struct jp_robot_config *config;
    const struct jp_energy_model *energy;         /**< of the motors */
    const struct jp_energy_model *energy_battery; /**< of the battery; NULL: not identified */
    const struct jp_horizon *horizon;             /**< these four: NULL when there is no table */
    const struct jp_learning *learning;
    const struct jp_horizon *horizon_battery;
    const struct jp_learning *learning_battery;
    const struct jp_lattice *lattice; /**< these three, likewise */
    const struct jp_navigator_body *navigation;
    const struct jp_battery_config *battery;
};

/** `robot_count` entries, then one with null pointers. */
extern const struct robot_entry robots[];
extern const size_t robot_count;

/** The last is null. */
extern const struct jp_lattice *const lattices[];

#endif
