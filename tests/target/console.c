/** Output and exit through semihosting, whose calls are the same on Arm and RISC-V. */
#include "tests/target/board.h"
#include "tests/target/target.h"

#include <stddef.h>

enum { SYS_WRITE0 = 0x04, SYS_EXIT_EXTENDED = 0x20, ADP_STOPPED_APPLICATION_EXIT = 0x20026 };

static char line[128];
static size_t length;

void target_flush(void)
{
    line[length] = '\0';
    length = 0;
    target_semihosting(SYS_WRITE0, line);
}

void target_putchar(int character)
{
    line[length++] = (char)character;
    if (character == '\n' || length == sizeof line - 1) {
        target_flush();
    }
}

void target_print(const char *text)
{
    while (*text != '\0') {
        target_putchar(*text++);
    }
}

void target_print_number(uint32_t number)
{
    char digits[11];
    size_t i = sizeof digits - 1;

    digits[i] = '\0';
    do {
        digits[--i] = (char)('0' + (char)(number % 10));
        number /= 10;
    } while (number != 0);
    target_print(&digits[i]);
}

_Noreturn void target_exit(int status)
{
    const uint32_t block[] = {ADP_STOPPED_APPLICATION_EXIT, (uint32_t)status};

    target_flush();
    target_semihosting(SYS_EXIT_EXTENDED, block);
    for (;;) {
    }
}
