/** The robots built into the host programs: one for each src/tables/robot_<name>.c. The Makefile writes the list. */
#ifndef SIM_ROBOTS_H
#define SIM_ROBOTS_H

#include <stddef.h>

#include <joulepath/energy.h>

struct jp_robot_config;

struct robot_entry {
    const char *name;
    const struct jp_robot_config *config;
    const struct jp_energy_model *energy;
};

/** `robot_count` entries, then one with null pointers. */
extern const struct robot_entry robots[];
extern const size_t robot_count;

#endif
