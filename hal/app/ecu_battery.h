/**
 * What a controller knows of the cells that feed it (battery.h), from the bus voltage that its robot measures and the
 * energy that it meters.
 *
 *   jp_ecu_battery_pass()  from the background, as often as it works: updates at the battery's own rate
 *
 * The charge that it begins with is that of the voltage while the motors are off. What the bus will lack is told for
 * the greatest power that the robot has taken, and at least for that of its highest speed: so its plans never ask for
 * what is not there. All calls are of the background.
 */
#ifndef JOULEPATH_HAL_APP_ECU_BATTERY_H
#define JOULEPATH_HAL_APP_ECU_BATTERY_H

#include <joulepath/battery.h>

#include "hal/app/ecu_robot.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The members but those with a comment are private. */
struct jp_ecu_battery {
    struct jp_battery_config config; /**< with the load that was seen so far, and the robot's unit of energy */
    struct jp_battery battery;       /**< holds once it has started */
    bool has_started;
    jp_energy drawn;  /* at the last sample, */
    jp_energy origin; /* and at the first */
    int64_t voltage;  /* sum of the samples since the last update, V in Q16 */
    uint32_t samples; /* of them */
    uint32_t tick;    /* of the last update */
    uint32_t updates; /* since it began, saturating */
    jp_energy before; /* drawn at the last update */
    jp_q16 power;     /* greatest mean between two updates, W */
};

/** Prepares it for energies in 2^unit_exponent J. What config->cells shows must stay. JP_ERR_CONFIG: *field names the
 *  first member of the configuration that is out of range, or is "cells": they are null. JP_ERR_ARGUMENT: a pointer is
 *  null. */
enum jp_status jp_ecu_battery_init(struct jp_ecu_battery *battery, const struct jp_battery_config *config,
                                   int32_t unit_exponent, const char **field);

/** Takes a sample at this tick, of `tick_rate` a second. True: it was an update. Work: that of jp_battery_update(). */
bool jp_ecu_battery_pass(struct jp_ecu_battery *battery, const struct jp_ecu_supply *supply, uint32_t tick,
                         uint32_t tick_rate);

/** What the bus will lack at most, V; after the first update. Work: that of jp_battery_lacks(). */
jp_q16 jp_ecu_battery_lacks(const struct jp_ecu_battery *battery, const struct jp_ecu_supply *supply);

/** For jp_home_config, with the battery as context: J in its unit, saturated. False: no voltage came yet. */
bool jp_ecu_battery_left(void *battery, struct jp_forecast *left);
jp_q16 jp_ecu_battery_given(void *battery);

/** What is left with its deviation, J in Q32, not saturated. Work: 15 times that of jp_battery_forecast_left() at most.
 */
void jp_ecu_battery_tell(const struct jp_ecu_battery *battery, jp_energy *left, jp_energy *deviation);

#ifdef __cplusplus
}
#endif

#endif
