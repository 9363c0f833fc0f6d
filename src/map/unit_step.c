#include "src/map/unit_step.h"

#include <stddef.h>

const struct jp_primitive *jp_unit_step(const struct jp_lattice *lattice, unsigned heading)
{
    for (unsigned i = lattice->first_from[heading]; i < lattice->first_from[heading + 1U]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];

        if (primitive->end == heading && primitive->move_count == 1U &&
            lattice->moves[primitive->first_move] == heading) {
            return primitive;
        }
    }
    return NULL;
}
