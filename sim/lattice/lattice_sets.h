/** The sets of cells of a lattice: what each primitive sweeps, and what the planner asks first. */
#ifndef JOULEPATH_SIM_LATTICE_LATTICE_SETS_H
#define JOULEPATH_SIM_LATTICE_LATTICE_SETS_H

#include "sim/lattice/lattice_primitive.h"

/** Fills the swept cells of all primitives, the footprints, reaches and the core. False after one line on stderr. */
bool lattice_cover(struct lattice *lattice);

/** Frees the sets and the primitives. */
void lattice_free(struct lattice *lattice);

#endif
