#include "sim/four_wheel/patrol_robots.h"

#include <string.h>

#include "sim/base/error.h"

const struct patrol_robot_entry *patrol_robot_built_in(const char *name)
{
    for (const struct patrol_robot_entry *entry = patrol_robots; entry->name != NULL; entry++) {
        if (strcmp(entry->name, name) == 0) {
            return entry;
        }
    }
    return NULL;
}

const struct patrol_robot_entry *patrol_robot_find(const char *name)
{
    const struct patrol_robot_entry *entry = patrol_robot_built_in(name);

    if (entry == NULL) {
        error_line("%s: no tables of this robot are built in; run make robot ROBOT=%s", name, name);
    }
    return entry;
}
