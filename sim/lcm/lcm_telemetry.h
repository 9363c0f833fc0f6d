/**
 * What the robot says on CAN, said again over LCM: JP_STATE, JP_PLAN, JP_ENERGY, JP_IDENTIFICATION and JP_NAVIGATION,
 * in the types of sim/lcm. The frames of operators are heard too, so that a plan tells which route it belongs to.
 */
#ifndef JOULEPATH_SIM_LCM_LCM_TELEMETRY_H
#define JOULEPATH_SIM_LCM_LCM_TELEMETRY_H

#include <jp_residual_t.h>
#include <jp_segment_t.h>
#include <lcm/lcm.h>

#include "sim/bus/course_view.h"
#include "sim/bus/ecu_view.h"
#include "sim/lcm/lcm_operator.h"

/** Segment numbers are of 8 bits, from 1. */
#define LCM_SEGMENTS_MAX 255

/** Parameters of an energy model in EnergyParameter. */
#define LCM_PARAMETERS 20

struct lcm_telemetry {
    lcm_t *lcm;
    const struct lcm_operator *operator; /**< whose task JP_STATE tells of */
    uint64_t unsent;                     /**< messages that LCM did not take */

    struct ecu_view view;
    struct jp_can_current_sensors_t currents;
    struct jp_can_battery_status_t battery;
    uint64_t state_due_us;
    uint64_t energy_due_us;
    uint64_t result_due_us; /**< JP_ENERGY when a segment has ended */

    struct jp_operator_link commands; /**< what the ECU hears */
    struct jp_route_link routes;
    bool route_is_new;     /**< no segment of it was planned yet */
    int16_t route_segment; /**< that leads to its first point */

    uint8_t announced; /**< the segment whose plan is coming in; 0: none */
    int16_t planned;   /**< segments since the robot last stood */
    jp_segment_t segments[LCM_SEGMENTS_MAX];
    int16_t ended;
    jp_residual_t residuals[LCM_SEGMENTS_MAX]; /**< of those that ended */
    double last_drawn;                         /**< by the last segment that ended, J */

    struct course_view course;

    double parameters[LCM_PARAMETERS];
    uint32_t parameters_heard; /**< a bit for each */
};

/** Nothing heard yet. What the pointers show must stay. */
void lcm_telemetry_start(struct lcm_telemetry *telemetry, lcm_t *lcm, const struct lcm_operator *operator);

/** Takes a frame that was on the bus, from whomever, and publishes what it completes. Times never fall. */
void lcm_telemetry_accept(struct lcm_telemetry *telemetry, const struct jp_can_frame *frame, uint64_t time_us);

#endif
