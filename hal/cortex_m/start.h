/** What a port's vector table names. */
#ifndef JOULEPATH_HAL_CORTEX_M_START_H
#define JOULEPATH_HAL_CORTEX_M_START_H

#include <stdint.h>

/** Of the handlers: the first entry of the table. */
extern uint8_t firmware_handler_stack_top[];

/** The port's, in the section .vectors. */
extern void (*const jp_vectors[])(void);

void jp_reset_handler(void);

/** The port's, too, because only there it can stand in for handlers that an image need not have: an exception that
 *  nobody asked for. It branches to jp_fault_handler(). */
void jp_unexpected_handler(void);

#define JP_WEAK_HANDLER __attribute__((weak, alias("jp_unexpected_handler")))

#define JP_UNUSED_IRQS(first, last) [16 + (first)... 16 + (last)] = jp_unexpected_handler

#endif
