#include "sim/missions/plan_lattice.h"

#include <stdio.h>
#include <string.h>

#include "sim/balancer/robots.h"
#include "sim/base/error.h"
#include "sim/files/config_fields.h"

const struct jp_lattice *plan_lattice_find(const char *name)
{
    for (size_t i = 0; lattices[i] != NULL; i++) {
        if (strcmp(lattices[i]->name, name) == 0) {
            return lattices[i];
        }
    }
    return NULL;
}

const struct jp_lattice *plan_lattice_for_navigation(const char *name)
{
    char own[CONFIG_NAME_SIZE + sizeof "_navigation"];

    (void)snprintf(own, sizeof own, "%s_navigation", name);
    const struct jp_lattice *lattice = plan_lattice_find(own);

    return lattice != NULL ? lattice : plan_lattice_find(name);
}

bool plan_lattice_fits(const char *path, const struct map_file *map, const struct jp_lattice *lattice)
{
    const double cell = (double)lattice->resolution / JP_Q16_ONE;

    if (map->terrain.config.resolution == lattice->resolution) {
        return true;
    }
    error_line("%s: cells of %.4g m, but the lattice of %s has %.4g m; import the map again with "
               "python -m tools.design.import_map … --resolution %.4g",
               path, (double)map->terrain.config.resolution / JP_Q16_ONE, lattice->name, cell, cell);
    return false;
}
