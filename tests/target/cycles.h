/**
 * Exact instruction counts on QEMU's mps2 boards with `-icount shift=0`, where an instruction takes 1 ns and SysTick,
 * at 25 MHz, counts every 40th.
 */
#ifndef CYCLES_H
#define CYCLES_H

#include <stdint.h>

#define TARGET_COUNT_OVERFLOW UINT32_MAX

/**
 * Instructions of function(argument), its return included, averaged over calls that must all do the same work.
 *
 * Off by less than one instruction up to 600 000 a call; above, by at most two. More than 16 million
 * give TARGET_COUNT_OVERFLOW.
 */
uint32_t target_count_instructions(void (*function)(void *), void *argument);

/** Instructions of one call of function(argument), to 40; more than 600 million give TARGET_COUNT_OVERFLOW. */
uint32_t target_count_once(void (*function)(void *), void *argument);

#endif
