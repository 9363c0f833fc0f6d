/**
 * Chooses the primitives of a lattice in the manner of SBMPO (section 2.2 of Zhang et al.): controls are drawn from a
 * Halton sequence, integrated, the end is snapped to a cell's centre and a heading, and the control that leads exactly
 * there is solved for.
 */
#ifndef JOULEPATH_SIM_LATTICE_LATTICE_GENERATE_H
#define JOULEPATH_SIM_LATTICE_LATTICE_GENERATE_H

#include "sim/lattice/lattice_primitive.h"

/** Moving primitives of each heading: B of the paper. */
#define LATTICE_BRANCHES 7

/** Fills headings and primitives of a lattice whose robot and resolution are set; paths, moves and level costs
 *  included. False after one line on stderr. */
bool lattice_generate(struct lattice *lattice);

#endif
