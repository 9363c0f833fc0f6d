/** The HAL of a simulated robot: reads a world's instruments and drives its bridges. */
#ifndef JOULEPATH_SIM_BALANCER_HAL_SIM_H
#define JOULEPATH_SIM_BALANCER_HAL_SIM_H

#include "hal/hal.h"
#include "sim/balancer/world.h"

/** The HAL on this world, which must outlive it. Time is the world's ticks in µs; the caller steps the world. */
struct jp_hal jp_hal_sim(struct world *world);

#endif
