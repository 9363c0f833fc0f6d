/** What runs when the program cannot: bridges off, a record, a reset. */
#ifndef JOULEPATH_HAL_STM32F4_FAULT_H
#define JOULEPATH_HAL_STM32F4_FAULT_H

#include "hal/storage/post_mortem.h"

/** The record that outlives the reset. */
extern struct jp_post_mortem jp_post_mortem;

/** Tick of the application, for the record. */
extern volatile uint32_t jp_fault_tick;

/** Hard, memory, bus and usage fault. */
void jp_fault_handler(void);

#endif
