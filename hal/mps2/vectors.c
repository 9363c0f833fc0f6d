/** The vector table of the AN500 image. */
#include "hal/cortex_m/fault.h"
#include "hal/cortex_m/start.h"
#include "hal/mps2/mps2_an500.h"

__attribute__((naked)) void jp_unexpected_handler(void)
{
    __asm__ volatile("b jp_fault_handler\n");
}

void SVC_Handler(void) JP_WEAK_HANDLER;
void PendSV_Handler(void) JP_WEAK_HANDLER;
void UART0_RX_Handler(void) JP_WEAK_HANDLER;
void TIMER0_Handler(void) JP_WEAK_HANDLER;

/** Exceptions of the core, then the 32 interrupts of the board (AN500, table of interrupts). The watchdog's is the NMI:
 *  the record of the crash then tells where the program hung. */
__attribute__((section(".vectors"), used)) void (*const jp_vectors[16 + 32])(void) = {
    (void (*)(void))firmware_handler_stack_top,
    jp_reset_handler,
    jp_unexpected_handler, /* watchdog */
    jp_fault_handler,      /* hard fault */
    jp_fault_handler,      /* memory management */
    jp_fault_handler,      /* bus fault */
    jp_fault_handler,      /* usage fault */
    jp_unexpected_handler,
    jp_unexpected_handler,
    jp_unexpected_handler,
    jp_unexpected_handler,
    SVC_Handler,
    jp_unexpected_handler,
    jp_unexpected_handler,
    PendSV_Handler,
    jp_unexpected_handler,
    [16 + UART0_RX_IRQn] = UART0_RX_Handler,
    JP_UNUSED_IRQS(UART0_RX_IRQn + 1, TIMER0_IRQn - 1),
    [16 + TIMER0_IRQn] = TIMER0_Handler,
    JP_UNUSED_IRQS(TIMER0_IRQn + 1, 31),
};
