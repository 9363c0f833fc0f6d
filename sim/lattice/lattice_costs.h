/** What primitives cost, in the form of joulepath/lattice.h: moves by their rise, and what turning costs on top. */
#ifndef JOULEPATH_SIM_LATTICE_LATTICE_COSTS_H
#define JOULEPATH_SIM_LATTICE_LATTICE_COSTS_H

#include "sim/lattice/lattice_primitive.h"

/** Drives a primitive's path at the speed that takes the least energy: its length, duration and level costs, the
 *  costs times its factor. `sharpest` is the largest |curvature| of the path, rad/cell. */
void lattice_drive(const struct lattice *lattice, struct lattice_primitive *primitive, double sharpest);

/** Costs of straight unit steps and bases of all primitives, which must have been driven and have their moves. False
 *  after one line on stderr: a step is too dear or too steep for the tables. */
bool lattice_price(struct lattice *lattice);

#endif
