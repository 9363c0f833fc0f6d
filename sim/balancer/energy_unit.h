/** Joules and the unit of a robot's energy model (joulepath/energy.h), in real numbers. */
#ifndef JOULEPATH_SIM_BALANCER_ENERGY_UNIT_H
#define JOULEPATH_SIM_BALANCER_ENERGY_UNIT_H

#include <joulepath/energy.h>

/** J; also J per whatever a number of the model counts by. */
double energy_unit_joules(const struct jp_energy_model *model, jp_q16 energy);

/** The Q16 number of the unit that so many joules are, not rounded. */
double energy_unit_number(const struct jp_energy_model *model, double joules);

/** Number of a1…a13 that does not count energy: a13 is a time. */
#define ENERGY_UNIT_TIME_TERM (JP_ENERGY_TERMS - 1)

#endif
