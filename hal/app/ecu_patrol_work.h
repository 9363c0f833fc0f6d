/** What the parts of ecu_patrol.h share. */
#ifndef JOULEPATH_HAL_APP_ECU_PATROL_WORK_H
#define JOULEPATH_HAL_APP_ECU_PATROL_WORK_H

#include "hal/app/ecu_patrol.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A slice of its work in the background, with the scan that waits. */
void jp_ecu_patrol_work(struct jp_ecu_patrol *patrol);

/** A number of at least 0 in steps of 1/one, saturated. */
static inline int32_t jp_ecu_fixed(float value, float one)
{
    const float scaled = value * one;

    return scaled >= 2147483520.0f ? INT32_MAX : (int32_t)scaled;
}

#ifdef __cplusplus
}
#endif

#endif
