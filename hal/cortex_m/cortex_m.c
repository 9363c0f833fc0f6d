#include "hal/cortex_m/cortex_m.h"

void jp_interrupts_off(void)
{
    __asm__ volatile("cpsid i" ::: "memory");
}

void jp_interrupts_on(void)
{
    __asm__ volatile("cpsie i" ::: "memory");
}

void jp_wait_for_interrupt(void)
{
    __asm__ volatile("dsb\n wfi" ::: "memory");
}

void jp_finish_writes(void)
{
    __asm__ volatile("dsb\n isb" ::: "memory");
}

void jp_nvic_enable(unsigned irq, unsigned level)
{
    NVIC.IPR[irq] = NVIC_PRIORITY(level);
    NVIC.ISER[irq / 32U] = 1U << (irq % 32U);
}

void jp_nvic_pend(unsigned irq)
{
    NVIC.ISPR[irq / 32U] = 1U << (irq % 32U);
}

_Noreturn void jp_system_reset(void)
{
    jp_finish_writes();
    SCB.AIRCR = AIRCR_VECTKEY | AIRCR_SYSRESETREQ;
    for (;;) {
    }
}
