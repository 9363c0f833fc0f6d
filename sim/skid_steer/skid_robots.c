#include "sim/skid_steer/skid_robots.h"

#include <stddef.h>
#include <string.h>

#include "sim/base/error.h"

const struct skid_robot_entry *skid_robot_built_in(const char *name)
{
    for (const struct skid_robot_entry *entry = skid_robots; entry->name != NULL; entry++) {
        if (strcmp(entry->name, name) == 0) {
            return entry;
        }
    }
    return NULL;
}

const struct skid_robot_entry *skid_robot_find(const char *name)
{
    const struct skid_robot_entry *entry = skid_robot_built_in(name);

    if (entry == NULL) {
        error_line("%s: no tables of this robot are built in; run make robot ROBOT=%s", name, name);
    }
    return entry;
}
