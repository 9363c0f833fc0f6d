/** The robots with four steered wheels whose tables are built in. The Makefile writes the list. */
#ifndef JOULEPATH_SIM_FOUR_WHEEL_PATROL_ROBOTS_H
#define JOULEPATH_SIM_FOUR_WHEEL_PATROL_ROBOTS_H

#include <joulepath/patrol_pilot.h>

struct patrol_robot_entry {
    const char *name;
    const struct jp_four_wheel_robot_config *config;
    const struct jp_patrol_config *patrol;
    const struct jp_localiser_config *localiser;
    const struct jp_patrol_scanner *scanner;
    const struct jp_four_wheel_energy_model *energy;
    const struct jp_factor_learning *learning;
};

/** The last has no name. */
extern const struct patrol_robot_entry patrol_robots[];

/** The robot of this name, or NULL. */
const struct patrol_robot_entry *patrol_robot_built_in(const char *name);

/** The same, or NULL after one line on stderr that tells how to make its tables. */
const struct patrol_robot_entry *patrol_robot_find(const char *name);

#endif
