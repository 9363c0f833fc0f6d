/** What each core does in its own way, and the start that is common to all. */
#ifndef TARGET_BOARD_H
#define TARGET_BOARD_H

#include <stdint.h>

/** Asks the emulator for a semihosting operation. */
void target_semihosting(uint32_t operation, const void *argument);

/** From the reset handler, on a fresh stack: makes memory ready, runs main() and ends the emulator with its status. */
_Noreturn void target_start(void);

/** From the handlers of all exceptions: a program on a target has none that it expects. */
_Noreturn void target_fault(void);

/** Makes the core ready for compiled code; nothing in memory is initialised yet. */
void target_core_start(void);

#endif
