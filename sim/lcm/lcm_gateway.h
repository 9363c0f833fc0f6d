/**
 * Between LCM and a robot on CAN: goals, routes and maps from LCM go to the robot as an operator's frames, its
 * telemetry comes back as messages. Channels: JP_GOAL, JP_ROUTE, JP_MAP, JP_CELLS and JP_MAP_GOAL in; those of
 * lcm_telemetry.h out.
 *
 * A packet that is not whole and sensible is counted, named in one line on stderr, at most one a second
 * for each kind, and not acted on.
 */
#ifndef JOULEPATH_SIM_LCM_LCM_GATEWAY_H
#define JOULEPATH_SIM_LCM_LCM_GATEWAY_H

#include "hal/linux/can_link.h"
#include "sim/lcm/lcm_operator.h"
#include "sim/lcm/lcm_telemetry.h"

struct lcm_gateway {
    struct jp_can_link link;
    lcm_t *lcm;
    struct lcm_operator operator;
    struct lcm_telemetry telemetry;
    uint64_t time_us;     /**< of the messages */
    uint64_t operator_us; /**< the operator's, which never falls */
    uint64_t wall_us;
    bool lockstep;                      /**< SimTime was heard: it is the clock */
    uint64_t dropped[LCM_TASK_RESULTS]; /**< packets, by what is wrong with them */
    uint64_t said_us[LCM_TASK_RESULTS]; /**< when that was last named */
};

/** Subscribes. False: LCM does not let it. What the pointers show must stay; the gateway must not be moved after it. */
bool lcm_gateway_start(struct lcm_gateway *gateway, const struct jp_can_link *link, lcm_t *lcm);

/** Takes what has arrived on both sides and sends what is due, without waiting. To be called about once a millisecond.
 *  wall_us never falls; once SimTime frames come, their time counts in its place. */
void lcm_gateway_pass(struct lcm_gateway *gateway, uint64_t wall_us);

/** Gives its memory back; bus and LCM stay open. */
void lcm_gateway_free(struct lcm_gateway *gateway);

#endif
