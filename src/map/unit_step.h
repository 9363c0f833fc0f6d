/** The straight unit steps of a lattice. Private to the core. */
#ifndef JOULEPATH_MAP_UNIT_STEP_H
#define JOULEPATH_MAP_UNIT_STEP_H

#include <joulepath/lattice.h>

/** The straight primitive of one step along a heading; null: the lattice has none. Work: its primitives. */
const struct jp_primitive *jp_unit_step(const struct jp_lattice *lattice, unsigned heading);

#endif
