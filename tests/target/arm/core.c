/** Vector table of the emulated Cortex-M boards. */
#include "tests/target/board.h"

#define CPACR        (*(volatile uint32_t *)0xE000ED88)
#define CPACR_FPU_ON (UINT32_C(0xF) << 20)

extern uint32_t target_stack_top;

void target_core_start(void)
{
#ifdef __ARM_FP
    CPACR |= CPACR_FPU_ON; /* the C library saves its registers in setjmp() */
    __asm__ volatile("dsb\n isb");
#endif
}

/** A fault may have come of an overflowing stack: a new one. */
__attribute__((naked)) static void fault(void)
{
    __asm__ volatile("ldr r0, =target_stack_top\n mov sp, r0\n ldr r0, =target_fault\n bx r0\n .ltorg");
}

/** Stack, reset, then every exception of the core. */
__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    &target_stack_top, (void *)target_start, (void *)fault, (void *)fault, (void *)fault, (void *)fault,
    (void *)fault,     (void *)fault,        (void *)fault, (void *)fault, (void *)fault, (void *)fault,
    (void *)fault,     (void *)fault,        (void *)fault, (void *)fault,
};
