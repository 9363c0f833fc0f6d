/** Symmetries of the map: a primitive's image costs the same and sweeps the image of its cells. */
#ifndef JOULEPATH_SIM_LATTICE_LATTICE_SYMMETRY_H
#define JOULEPATH_SIM_LATTICE_LATTICE_SYMMETRY_H

#include "sim/lattice/lattice_primitive.h"

/** Across the diagonal: (x, y) becomes (y, x). */
void lattice_reflect(struct lattice_primitive *primitive);

/** By a quarter turn to the left: (x, y) becomes (−y, x). */
void lattice_turn_quarter(struct lattice_primitive *primitive);

#endif
