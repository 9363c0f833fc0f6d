/** Reset and traps of QEMU's RISC-V board. */
#include "tests/target/board.h"

/** QEMU starts at the first byte of the image. */
__attribute__((naked, used, section(".vectors"))) static void reset(void)
{
    __asm__ volatile(".option push\n"
                     ".option arch, +zicsr\n"
                     "la sp, target_stack_top\n"
                     "la t0, trap\n"
                     "csrw mtvec, t0\n"
                     "tail target_start\n"
                     ".option pop");
}

/** A trap may have come of an overflowing stack: a new one. The lowest two bits of a handler's address are its mode. */
__attribute__((naked, used, aligned(4))) static void trap(void)
{
    __asm__ volatile("la sp, target_stack_top\n"
                     "tail target_fault");
}

void target_core_start(void)
{
}
