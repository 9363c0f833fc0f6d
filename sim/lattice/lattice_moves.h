/** Unit steps of the map along a primitive. */
#ifndef JOULEPATH_SIM_LATTICE_LATTICE_MOVES_H
#define JOULEPATH_SIM_LATTICE_LATTICE_MOVES_H

#include "sim/lattice/lattice_primitive.h"

/** Finds the chain of unit steps from start to end that stays closest to the primitive's path and is hardly longer
 *  than need be. False when there is none of at most LATTICE_MOVES_MAX steps. */
bool lattice_find_moves(struct lattice_primitive *primitive);

/** Length of the unit steps of one kind, cells. */
double lattice_move_length(enum jp_move_kind kind);

#endif
