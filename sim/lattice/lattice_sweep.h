/** The cells that a robot's footprint covers on its way, each of a rectangle's decided by libccd. */
#ifndef JOULEPATH_SIM_LATTICE_LATTICE_SWEEP_H
#define JOULEPATH_SIM_LATTICE_LATTICE_SWEEP_H

#include "sim/lattice/lattice_primitive.h"

/** Poses of a path must not be farther apart than this, cells and rad. */
#define LATTICE_SPACING (1.0 / 16)
#define LATTICE_TURN    (0.25 * LATTICE_PI / 180)

/** In cells. */
struct lattice_footprint {
    double length;
    double width;
    double radius; /**< of a disc instead of the rectangle, if it is above 0 */
};

/** Adds the cells that a footprint covers along a path. False when they do not fit the set. */
bool lattice_sweep(const struct lattice_path *path, const struct lattice_footprint *footprint,
                   struct lattice_cells *cells);

#endif
