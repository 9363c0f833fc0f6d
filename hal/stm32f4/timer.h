/** Time: TIM5 counts microseconds since its start. */
#ifndef JOULEPATH_HAL_STM32F4_TIMER_H
#define JOULEPATH_HAL_STM32F4_TIMER_H

#include <stdint.h>

/** From 0; `timer_hz` is that of the APB1 timers, a multiple of 1 MHz. */
void jp_timer_start(uint32_t timer_hz);

/** µs, wrapping at 2³². One read; for ISRs. */
uint32_t jp_timer_us(void);

#endif
