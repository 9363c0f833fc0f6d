#include "sim/balancer/energy_kind.h"

#include <string.h>

#define KINDS 2

static const char *const names[KINDS] = {[ENERGY_MOTOR] = "motor", [ENERGY_BATTERY] = "battery"};

const char *energy_kind_name(enum energy_kind kind)
{
    return names[kind];
}

bool energy_kind_parse(const char *name, enum energy_kind *kind)
{
    for (int i = 0; i < KINDS; i++) {
        if (strcmp(name, names[i]) == 0) {
            *kind = (enum energy_kind)i;
            return true;
        }
    }
    return false;
}
