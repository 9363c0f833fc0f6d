#include "sim/skid_steer/skid_robots.h"

#include <joulepath/tables.h>
#include <stddef.h>
#include <string.h>

#include "sim/base/error.h"

#define ENTRY(name, lattice_to_goals)                                                                                  \
    {                                                                                                                  \
#name, &jp_skid_robot_##name, &jp_skid_energy_##name, &jp_skid_learning_##name, &jp_path_limits_##name,        \
            &jp_lattice_##name, &jp_skid_steer_##name, &jp_navigation_##name, &(lattice_to_goals),                     \
            &jp_battery_config_##name                                                                                  \
    }

static const struct skid_robot_entry entries[] = {ENTRY(burger, jp_lattice_burger),
                                                  ENTRY(zhang2018, jp_lattice_zhang2018_navigation)};

const struct skid_robot_entry *skid_robot_built_in(const char *name)
{
    for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++) {
        if (strcmp(entries[i].name, name) == 0) {
            return &entries[i];
        }
    }
    return NULL;
}

const struct skid_robot_entry *skid_robot_find(const char *name)
{
    const struct skid_robot_entry *entry = skid_robot_built_in(name);

    if (entry == NULL) {
        error_line("%s: no tables of this robot are built in; run make skid-robot and make identify with ROBOT=%s, and "
                   "name it in sim/skid_steer/skid_robots.c",
                   name, name);
    }
    return entry;
}
