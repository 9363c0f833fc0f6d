/** Newton steps of the interior-point method over all legs. Private to libjoulepath_float. */
#ifndef JOULEPATH_TRAJECTORY_ROUTE_STEP_H
#define JOULEPATH_TRAJECTORY_ROUTE_STEP_H

#include <joulepath/route.h>

/** Slacks and multipliers of legs that were evaluated. */
void jp_route_enter(struct jp_route *route);

/** One step of all legs, which are evaluated before and after it; the barrier falls. */
void jp_route_step(struct jp_route *route);

#endif
