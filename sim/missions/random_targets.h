/** Random routes for robots that learn. */
#ifndef JOULEPATH_SIM_MISSIONS_RANDOM_TARGETS_H
#define JOULEPATH_SIM_MISSIONS_RANDOM_TARGETS_H

#include "sim/balancer/rig.h"

/** From where the robot is, legs of 1…10 m that turn by up to 1.6 rad from one to the next. */
void random_targets_draw(struct random *random, const struct rig *rig, struct jp_point *targets, size_t count);

#endif
