#include "sim/four_wheel/patrol_robots.h"

#include <joulepath/tables.h>
#include <string.h>

#include "sim/base/error.h"

#define ENTRY(name)                                                                                                    \
    {                                                                                                                  \
#name, &jp_four_wheel_robot_##name, &jp_patrol_config_##name, &jp_localiser_config_##name,                     \
            &jp_patrol_scanner_##name, &jp_four_wheel_energy_##name, &jp_four_wheel_learning_##name                    \
    }

static const struct patrol_robot_entry entries[] = {ENTRY(patrol)};

const struct patrol_robot_entry *patrol_robot_built_in(const char *name)
{
    for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++) {
        if (strcmp(entries[i].name, name) == 0) {
            return &entries[i];
        }
    }
    return NULL;
}

const struct patrol_robot_entry *patrol_robot_find(const char *name)
{
    const struct patrol_robot_entry *entry = patrol_robot_built_in(name);

    if (entry == NULL) {
        error_line("%s: no tables of this robot are built in; run make patrol-config and make identify with ROBOT=%s, "
                   "and name it in sim/four_wheel/patrol_robots.c",
                   name, name);
    }
    return entry;
}
