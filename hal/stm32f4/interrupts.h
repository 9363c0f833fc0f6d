/** Priorities of the firmware's interrupts; 0 is the highest and the faults' alone. */
#ifndef JOULEPATH_HAL_STM32F4_INTERRUPTS_H
#define JOULEPATH_HAL_STM32F4_INTERRUPTS_H

#include "hal/stm32f4/stm32f405.h"

/** The control interrupt: the end of the IMU's transfer or, when sensors and bridges are simulated, pended by software.
 */
#define CONTROL_IRQ DMA2_Stream0_IRQn

/** A byte of the serial line must be fetched within 10 µs. Frames and the control tick share one level, so that neither
 *  interrupts the other. */
#define PRIORITY_SUPPLY  1U
#define PRIORITY_SERIAL  1U
#define PRIORITY_CONTROL 2U

#endif
