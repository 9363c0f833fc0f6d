/**
 * The robot's operator for what comes over LCM: of a route or goal, as operator.h, or of a map and goals on it, as
 * navigation_operator.h. A new task replaces the present one, whichever of both has it; the other one is silent.
 */
#ifndef JOULEPATH_SIM_LCM_LCM_OPERATOR_H
#define JOULEPATH_SIM_LCM_LCM_OPERATOR_H

#include "hal/app/navigation_operator.h"
#include "hal/app/operator.h"
#include "sim/lcm/lcm_map.h"

/** Zero-initialised it is idle and silent. The members after `map` are private. */
struct lcm_operator {
    struct jp_operator commander;
    struct jp_navigation_operator navigator;
    bool navigates; /**< the navigator has the task, not the commander */
    struct lcm_map map;
    uint8_t streams[2][UINT16_MAX]; /* of maps: the robot may still be getting one when the next is made */
    unsigned stream;                /* the last one made */
    bool is_given;                  /* the navigator has the map */
};

/** Each reads a packet; unless the result is LCM_TASK_OK the task is as before. */
typedef enum lcm_task_result lcm_operator_take(struct lcm_operator *self, const void *packet, size_t size);
lcm_operator_take lcm_operator_goal;
lcm_operator_take lcm_operator_route;
lcm_operator_take lcm_operator_map; /**< another map: the robot brakes to a balanced stand */
lcm_operator_take lcm_operator_cells;
lcm_operator_take lcm_operator_map_goal;

/** The robot brakes to a balanced stand. Stays silent if nothing was asked yet. */
void lcm_operator_stop(struct lcm_operator *self);

/** It sends commands. */
bool lcm_operator_is_commanding(const struct lcm_operator *self);

/** As operator.h has them. */
void lcm_operator_accept(struct lcm_operator *self, const struct jp_can_frame *frame);
void lcm_operator_tick(struct lcm_operator *self, uint32_t time_ms, const struct jp_can_port *port);

/** Of the task, whoever has it. */
enum jp_operator_phase lcm_operator_phase(const struct lcm_operator *self);

/** Why it has failed and what to do; empty unless it has. */
const char *lcm_operator_failure_text(const struct lcm_operator *self);

/** Gives the memory of the map back. */
void lcm_operator_free(struct lcm_operator *self);

#endif
