/** Calls of the emulator. */
#include "tests/target/board.h"

/** The three instructions that mark the call must not be compressed nor stand on two pages. */
__attribute__((naked)) void target_semihosting(uint32_t operation, const void *argument)
{
    (void)operation;
    (void)argument;
    __asm__ volatile(".option push\n"
                     ".option norvc\n"
                     ".balign 16\n"
                     "slli zero, zero, 0x1f\n"
                     "ebreak\n"
                     "srai zero, zero, 7\n"
                     ".option pop\n"
                     "ret");
}
