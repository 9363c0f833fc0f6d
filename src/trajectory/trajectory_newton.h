/** Newton's step of the optimiser, whose waypoints meet their neighbours alone. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_TRAJECTORY_NEWTON_H
#define JOULEPATH_TRAJECTORY_TRAJECTORY_NEWTON_H

#include <joulepath/trajectory_optimiser.h>

/** From slope, curve and coupling of each place its step, of curvatures that are taken to be positive; a variable
 *  without slope and curvature keeps. Slopes, curvatures and couplings become factors. Returns what the steps save. */
float jp_newton_step(struct jp_optimiser_place *places, uint16_t count);

#endif
