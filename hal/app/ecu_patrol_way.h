/** The way on a map of a robot with four steered wheels (ecu_patrol.h). */
#ifndef JOULEPATH_HAL_APP_ECU_PATROL_WAY_H
#define JOULEPATH_HAL_APP_ECU_PATROL_WAY_H

#include "hal/app/ecu_patrol.h"
#include "hal/app/navigation.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Finds its way on maps, for jp_navigation_init_with(). */
struct jp_wayfinder jp_ecu_patrol_wayfinder(struct jp_ecu_patrol *patrol);

#ifdef __cplusplus
}
#endif

#endif
