/** The board's timer, which the tick comes from. */
#ifndef JOULEPATH_HAL_MPS2_TIMER_H
#define JOULEPATH_HAL_MPS2_TIMER_H

#include <stdint.h>

/** From now on TIMER0_Handler() is called `rate` times a second, once its interrupt is enabled. */
void jp_timer_start(uint32_t rate);

/** In its interrupt. */
void jp_timer_clear(void);

#endif
