/** What runs when the program cannot: bridges off, a record, a reset. */
#ifndef JOULEPATH_HAL_CORTEX_M_FAULT_H
#define JOULEPATH_HAL_CORTEX_M_FAULT_H

#include "hal/storage/post_mortem.h"

/** The record that outlives the reset. */
extern struct jp_post_mortem jp_post_mortem;

/** Tick of the application, for the record. */
extern volatile uint32_t jp_fault_tick;

/** Hard, memory, bus and usage fault, and whatever interrupt is not expected. */
void jp_fault_handler(void);

/** The port's: both bridges off at once, from any context. Nothing to do where they are on a bus, which switches them
 *  off when no command comes. */
void jp_bridges_off(void);

#endif
