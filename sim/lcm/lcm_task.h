/** Goals and routes that come in LCM packets, from anybody: judged whole before anything is done with them. And what is
 *  wrong with packets, those of lcm_map.h too. */
#ifndef JOULEPATH_SIM_LCM_LCM_TASK_H
#define JOULEPATH_SIM_LCM_LCM_TASK_H

#include <jp_point_t.h>
#include <stddef.h>

#include "hal/can/route_link.h"

enum lcm_task_result {
    LCM_TASK_OK,
    LCM_TASK_TYPE,       /**< the fingerprint is that of another type */
    LCM_TASK_COUNT,      /**< not 1…JP_ROUTE_LENGTH_MAX points */
    LCM_TASK_LENGTH,     /**< cut off, or followed by more */
    LCM_TASK_NUMBER,     /**< a coordinate is not finite */
    LCM_TASK_FAR,        /**< a point is not within ±512 m */
    LCM_TASK_SIDE,       /**< a map's side is not 1…JP_TERRAIN_SIDE_MAX cells */
    LCM_TASK_CELL,       /**< not an enum jp_cell */
    LCM_TASK_MAP_ID,     /**< not 1…15 */
    LCM_TASK_RESOLUTION, /**< below 2^-16 m, or 32 768 m and more */
    LCM_TASK_STREAM,     /**< the map takes too many bytes on the bus */
    LCM_TASK_MEMORY,     /**< there is not enough for the map */
    LCM_TASK_CELLS,      /**< not 1…LCM_CELLS_MAX of them */
    LCM_TASK_NO_MAP,     /**< none has come yet */
    LCM_TASK_OTHER_MAP,  /**< the id is not that of the last map */
    LCM_TASK_OUTSIDE,    /**< a place is not on the map */
    LCM_TASK_RESULTS
};

/** Read a jp_goal_t, a jp_route_t. *route, whose id is not set, is valid only with LCM_TASK_OK. */
enum lcm_task_result lcm_task_goal(const void *packet, size_t size, struct jp_route_message *route);
enum lcm_task_result lcm_task_route(const void *packet, size_t size, struct jp_route_message *route);

/** Whether a packet is of the type of a sample, and at least as long: LCM_TASK_OK, else LCM_TASK_TYPE or
 * LCM_TASK_LENGTH.
 */
enum lcm_task_result lcm_task_begins(const void *packet, size_t size, const uint8_t *sample, size_t sample_size);

/** LCM_TASK_NUMBER, LCM_TASK_FAR: *point is not written. */
enum lcm_task_result lcm_task_point(const jp_point_t *from, struct jp_point *point);

/** What is wrong, for people. */
const char *lcm_task_text(enum lcm_task_result result);

#endif
