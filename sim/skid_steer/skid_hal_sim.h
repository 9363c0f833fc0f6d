/** The HAL of a simulated skid-steered or differential-drive robot: reads a world's instruments and drives its bridges.
 */
#ifndef JOULEPATH_SIM_SKID_STEER_SKID_HAL_SIM_H
#define JOULEPATH_SIM_SKID_STEER_SKID_HAL_SIM_H

#include "hal/hal.h"
#include "sim/skid_steer/skid_world.h"

/** The HAL on this world, which must outlive it; the caller steps the world. */
struct jp_hal skid_hal_sim(struct skid_world *world);

#endif
