/**
 * Waiting for hardware, with an end. Each driver that polls does it here, so that a test can stand in for the hardware.
 */
#ifndef JOULEPATH_HAL_STM32F4_WAIT_H
#define JOULEPATH_HAL_STM32F4_WAIT_H

#include <stdbool.h>
#include <stdint.h>

/** Reads *reg until the bits of `mask` are `value`; false: not within `polls` reads, of 4…10 core cycles each. */
bool jp_wait_for(const volatile uint32_t *reg, uint32_t mask, uint32_t value, uint32_t polls);

/** Waits for at least so long by the clock of timer.h; if that stands, for at most 64 reads of it a microsecond. */
void jp_wait_us(uint32_t us);

#endif
