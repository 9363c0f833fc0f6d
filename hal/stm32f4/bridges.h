/**
 * The motors' bridges: centre-aligned complementary PWM with dead time, TIM1 for the left motor and TIM8, in phase with
 * it, for the right one.
 *
 * A motor is between two half bridges whose high sides are on for (1 ± duty)/2 of the period, about its middle. Both
 * ends of the motor are then equally often and symmetrically high, so that its current in the middle of a period, when
 * the ADC samples it, is its mean. Compare values become active at the end of a period, those of both motors in the
 * same one.
 *
 * Outputs are low, and all switches off, from reset until jp_bridges_write() switches them on, and whenever the master
 * output enable (MOE) is off. The break inputs switch it off without the program.
 */
#ifndef JOULEPATH_HAL_STM32F4_BRIDGES_H
#define JOULEPATH_HAL_STM32F4_BRIDGES_H

#include <stdbool.h>

#include <joulepath/sensors.h>
#include <joulepath/status.h>

#include "hal/cortex_m/fault.h"

struct jp_bridges {
    uint16_t period; /**< timer counts for half a period: its frequency is timer_hz / (2 period) */
    uint16_t limit;  /**< largest |high - low| of a motor's compares, counts */
    bool on;         /**< switched on by the last write */
    bool tripped;    /**< a break has switched them off; until a write with `enabled` 0 */
};

/**
 * Starts both timers with outputs off, and TIM3, which triggers the ADC tick_rate times a second, a divisor of
 * BOARD_PWM_HZ from 100 on. `timer_hz` is that of TIM1: 16 or 168 MHz. Once after a reset. Not for ISRs.
 */
void jp_bridges_start(struct jp_bridges *bridges, uint32_t timer_hz, uint32_t tick_rate);

/**
 * Applies both duties at once, within 25 µs; |duty| beyond limit/period (0.955 at 168 MHz) is limited to it,
 * so that each low side is on for BOARD_LOW_SIDE_NS in every period. `enabled` 0 switches off at once.
 * JP_ERR_HARDWARE: a break has switched the bridges off; they stay off until they were written with `enabled` 0.
 * Constant time; for the control ISR.
 */
enum jp_status jp_bridges_write(struct jp_bridges *bridges, const struct jp_actuation *actuation);

/* jp_bridges_off() of hal/cortex_m/fault.h: two registers; also before the start, and any number of times. */

/** DTG: the shortest dead time of at least `counts` of the timer's clock that can be set; at most 1008. Pure. */
uint8_t jp_bridges_dead_time(uint32_t counts);

#endif
