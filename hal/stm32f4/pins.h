/** Pins: what each does. Not for ISRs but jp_pin_set(). */
#ifndef JOULEPATH_HAL_STM32F4_PINS_H
#define JOULEPATH_HAL_STM32F4_PINS_H

#include <stdbool.h>

#include "hal/stm32f4/stm32f405.h"

struct jp_pin {
    volatile struct stm32_gpio *port;
    uint8_t number;   /**< 0…15 */
    uint8_t function; /**< alternate function, 0…15; where it has one */
};

/** Clocks of the ports A to E. Before all others. */
void jp_pins_start(void);

/** An output of the peripheral of its alternate function. */
void jp_pin_drive(struct jp_pin pin);

/** An input of that peripheral, with a pull-up. */
void jp_pin_listen(struct jp_pin pin);

/** The converter's: no digital input. */
void jp_pin_analog(struct jp_pin pin);

/** An output that is high. */
void jp_pin_output(struct jp_pin pin);

/** An input with a pull-up. */
void jp_pin_input(struct jp_pin pin);

/** Level of an output. One write; for ISRs. */
void jp_pin_set(struct jp_pin pin, bool high);

/** Level at the pin. */
bool jp_pin_is_high(struct jp_pin pin);

#endif
