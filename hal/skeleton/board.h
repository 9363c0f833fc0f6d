/**
 * The board of a new port, as main.c beside it sees it. Copy this directory and fill in board.c; hal/README.md explains
 * each function. What is not filled in yet keeps the motors off.
 */
#ifndef JOULEPATH_HAL_SKELETON_BOARD_H
#define JOULEPATH_HAL_SKELETON_BOARD_H

#include "hal/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Switches the bridges off, then starts clocks, watchdog, PWM and sensors. JP_ERR_HARDWARE: one did not start; the
 *  bridges are off. Bounded: no wait without an end. */
enum jp_status board_start(void);

/** From now on control_tick() runs `rate` times a second, in an interrupt. JP_ERR_HARDWARE: the timer cannot. */
enum jp_status board_start_ticks(uint32_t rate);

/** The HAL's functions, as hal.h says. */
enum jp_status board_read(void *context, struct jp_sensors *sensors);
enum jp_status board_write(void *context, const struct jp_actuation *actuation);

/** Both bridges off at once, from any context: fault handlers call it too. */
void board_bridges_off(void);

/** The operator wants the robot to balance. */
bool board_is_switched_on(void);

/** Sleeps until an interrupt came. */
void board_wait(void);

/** Called only when the tick and the loop are both alive. */
void board_feed_watchdog(void);

/** Stands in main.c: one control tick, for the timer's interrupt. */
void control_tick(void);

#ifdef __cplusplus
}
#endif

#endif
