/** Curves of constant speed and linear turn rate, w(t) = a + b t, between the states of a lattice. */
#ifndef JOULEPATH_SIM_LATTICE_LATTICE_CURVE_H
#define JOULEPATH_SIM_LATTICE_LATTICE_CURVE_H

#include "sim/lattice/lattice_primitive.h"

/** A clothoid: its curvature bend + bend_rate·s is linear in the arc length s. */
struct lattice_curve {
    double heading;   /**< rad, at the start */
    double bend;      /**< rad/cell, at the start */
    double bend_rate; /**< rad/cell² */
    double length;    /**< cells */
};

/** The end of a curve that starts at the origin. */
struct lattice_pose lattice_curve_end(const struct lattice_curve *curve);

/** Largest |curvature|, rad/cell. */
double lattice_curve_sharpest(const struct lattice_curve *curve);

/** Changes bend, bend rate and length until the curve ends in `end`, whose heading counts unwrapped. False when it
 *  does not converge, or only to a curve that is not longer than 0. */
bool lattice_curve_solve(struct lattice_curve *curve, const struct lattice_pose *end);

/** Poses along the curve, at most `spacing` cells and `turn` rad apart. False when they are too many. */
bool lattice_curve_path(const struct lattice_curve *curve, double spacing, double turn, struct lattice_path *path);

#endif
