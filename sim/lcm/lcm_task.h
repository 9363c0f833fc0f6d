/** Goals and routes that come in LCM packets, from anybody: judged whole before anything is done with them. */
#ifndef JOULEPATH_SIM_LCM_LCM_TASK_H
#define JOULEPATH_SIM_LCM_LCM_TASK_H

#include <stddef.h>

#include "hal/can/route_link.h"

enum lcm_task_result {
    LCM_TASK_OK,
    LCM_TASK_TYPE,   /**< the fingerprint is that of another type */
    LCM_TASK_COUNT,  /**< not 1…JP_ROUTE_LENGTH_MAX points */
    LCM_TASK_LENGTH, /**< cut off, or followed by more */
    LCM_TASK_NUMBER, /**< a coordinate is not finite */
    LCM_TASK_FAR,    /**< a point is not within ±512 m */
    LCM_TASK_RESULTS
};

/** Read a jp_goal_t, a jp_route_t. *route, whose id is not set, is valid only with LCM_TASK_OK. */
enum lcm_task_result lcm_task_goal(const void *packet, size_t size, struct jp_route_message *route);
enum lcm_task_result lcm_task_route(const void *packet, size_t size, struct jp_route_message *route);

/** What is wrong, for people. */
const char *lcm_task_text(enum lcm_task_result result);

#endif
