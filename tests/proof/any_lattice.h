/** The shapes of a robot's lattice with any prices that pass. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_LATTICE_H
#define JOULEPATH_TESTS_PROOF_ANY_LATTICE_H

#include <joulepath/tables.h>

#include "tests/proof/any_terrain.h"

static void any_lattice(struct jp_lattice *lattice)
{
    *lattice = jp_lattice_burger;
    for (unsigned kind = 0; kind < (unsigned)JP_COST_KINDS; kind++) {
        for (unsigned move = 0; move < (unsigned)JP_MOVE_KINDS; move++) {
            do {
                ANY(lattice->move_costs[kind][move]);
            } while (!jp_slope_cost_is_valid(&lattice->move_costs[kind][move]));
        }
    }
    for (unsigned i = 0; i < JP_GROUND_CLASSES; i++) {
        lattice->ground[i].straight = (uint16_t)any_unsigned(JP_GROUND_SHARE_MAX);
        lattice->ground[i].turning = (uint16_t)any_unsigned(JP_GROUND_SHARE_MAX);
    }
}

#endif
