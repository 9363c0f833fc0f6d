/** What a program on an emulated microcontroller has instead of an operating system. */
#ifndef TARGET_H
#define TARGET_H

#include <stdint.h>

/** Writes one character to the terminal of the emulator; a line at a time, because each write stops the core. */
void target_putchar(int character);

/** Writes what target_putchar() still holds. */
void target_flush(void);

void target_print(const char *text);
void target_print_number(uint32_t number);

/** Ends the emulator with this exit status. */
_Noreturn void target_exit(int status);

#endif
