/**
 * Exact instruction counts in QEMU with `-icount shift=0`. On the Arm mps2 boards an instruction then takes 1 ns and
 * SysTick, at 25 MHz, counts every 40th; on RISC-V the core counts each one that it retires.
 */
#ifndef CYCLES_H
#define CYCLES_H

#include <stdint.h>

#define TARGET_COUNT_OVERFLOW UINT32_MAX

/**
 * Instructions of function(argument), its return included, averaged over calls that must all do the same work.
 *
 * On Arm: off by less than one instruction up to 600 000 a call; above, by at most two. More than 16 million
 * give TARGET_COUNT_OVERFLOW. On RISC-V: one call, exact, less than 2³².
 */
uint32_t target_count_instructions(void (*function)(void *), void *argument);

/** The greater of `worst` and the instructions of function(argument); those that are clearly less are counted once. */
uint32_t target_count_worst(uint32_t worst, void (*function)(void *), void *argument);

/** Instructions of one call of function(argument). On Arm to 40; more than 600 million give TARGET_COUNT_OVERFLOW. */
uint32_t target_count_once(void (*function)(void *), void *argument);

#endif
