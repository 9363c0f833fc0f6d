/** What the fields of a map have in common: a map and a lattice on it, and poses there. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_FIELD_H
#define JOULEPATH_TESTS_PROOF_ANY_FIELD_H

#include "tests/proof/any_lattice.h"

static struct jp_terrain *field_map;
static struct jp_lattice field_lattice;

static void any_field_map(void)
{
    field_map = any_terrain();
    any_lattice(&field_lattice);
}

static inline int32_t any_x(void)
{
    return any_between(0, field_map->config.width - 1);
}

static inline int32_t any_y(void)
{
    return any_between(0, field_map->config.height - 1);
}

static inline unsigned any_heading(void)
{
    return any_unsigned(JP_HEADINGS - 1U);
}

static inline enum jp_cost_kind any_kind_of_cost(void)
{
    return (enum jp_cost_kind)any_between(JP_COST_PHYSICAL, JP_COST_DISTANCE);
}

#endif
