/** Vector table and start-up: memory, stacks with their guards, then main() on the main stack. */
#include <string.h>

#include "hal/stm32f4/cortex_m.h"
#include "hal/stm32f4/fault.h"
#include "hal/stm32f4/stack_guard.h"

/* Addresses that the linker script gives. */
extern uint8_t firmware_data_start[], firmware_data_end[], firmware_data_load[];
extern uint8_t firmware_bss_start[], firmware_bss_end[];
extern uint8_t firmware_main_stack_guard[], firmware_handler_stack_guard[], firmware_handler_stack_top[];

int main(void);

extern void (*const jp_vectors[])(void);

/** As SIZE of the MPU: 256 bytes, for fields behind a null pointer. */
#define NULL_SIZE 7U

static uint32_t address_of(const void *symbol)
{
    return (uint32_t)(uintptr_t)symbol;
}

/** No access for anybody. */
static void forbid(uint32_t region, uint32_t address, uint32_t size)
{
    MPU.RBAR = address | RBAR_VALID | region;
    MPU.RASR = RASR_XN | (size << RASR_SIZE_POS) | RASR_ENABLE;
}

/** A stack that grows into its guard, and an access through a null pointer, end in the fault handler. */
static void guard_memory(void)
{
    forbid(0, address_of(firmware_main_stack_guard), STACK_GUARD_SIZE);
    forbid(1, address_of(firmware_handler_stack_guard), STACK_GUARD_SIZE);
    forbid(2, 0, NULL_SIZE);
    MPU.CTRL = MPU_PRIVDEFENA | MPU_ENABLE;
    SCB.CCR |= CCR_DIV_0_TRP;
    SCB.SHCSR |= SHCSR_MEMFAULTENA | SHCSR_BUSFAULTENA | SHCSR_USGFAULTENA;
    jp_finish_writes();
}

/** Not static: the reset handler branches to it once the stacks are set. */
_Noreturn void jp_startup(void);

_Noreturn void jp_startup(void)
{
    memcpy(firmware_data_start, firmware_data_load, address_of(firmware_data_end) - address_of(firmware_data_start));
    memset(firmware_bss_start, 0, address_of(firmware_bss_end) - address_of(firmware_bss_start));
    SCB.VTOR = address_of(jp_vectors);
    guard_memory();
    (void)main();
    jp_system_reset();
}

/** Handlers keep the stack that the core starts with; the thread gets its own. */
__attribute__((naked)) void jp_reset_handler(void)
{
    __asm__ volatile("ldr r0, =firmware_main_stack_top\n"
                     "msr psp, r0\n"
                     "movs r0, #2\n"
                     "msr control, r0\n"
                     "isb\n"
                     "b jp_startup\n");
}

/** An exception that nobody asked for. */
__attribute__((naked)) void jp_unexpected_handler(void)
{
    __asm__ volatile("b jp_fault_handler\n");
}

#define WEAK __attribute__((weak, alias("jp_unexpected_handler")))

void NMI_Handler(void) WEAK;
void SysTick_Handler(void) WEAK;
void SVC_Handler(void) WEAK;
void PendSV_Handler(void) WEAK;
void PVD_IRQHandler(void) WEAK;
void ADC_IRQHandler(void) WEAK;
void CAN1_TX_IRQHandler(void) WEAK;
void CAN1_RX0_IRQHandler(void) WEAK;
void CAN1_SCE_IRQHandler(void) WEAK;
void USART1_IRQHandler(void) WEAK;
void DMA2_Stream0_IRQHandler(void) WEAK;

#define UNUSED_IRQS(first, last) [16 + (first)... 16 + (last)] = jp_unexpected_handler

/** Exceptions of the core, then the 82 interrupts of the STM32F405 (RM0090, table 62). */
__attribute__((section(".vectors"), used)) void (*const jp_vectors[16 + 82])(void) = {
    (void (*)(void))firmware_handler_stack_top,
    jp_reset_handler,
    NMI_Handler,
    jp_fault_handler, /* hard fault */
    jp_fault_handler, /* memory management */
    jp_fault_handler, /* bus fault */
    jp_fault_handler, /* usage fault */
    jp_unexpected_handler,
    jp_unexpected_handler,
    jp_unexpected_handler,
    jp_unexpected_handler,
    SVC_Handler,
    jp_unexpected_handler,
    jp_unexpected_handler,
    PendSV_Handler,
    SysTick_Handler,
    UNUSED_IRQS(0, PVD_IRQn - 1),
    [16 + PVD_IRQn] = PVD_IRQHandler,
    UNUSED_IRQS(PVD_IRQn + 1, ADC_IRQn - 1),
    [16 + ADC_IRQn] = ADC_IRQHandler,
    [16 + CAN1_TX_IRQn] = CAN1_TX_IRQHandler,
    [16 + CAN1_RX0_IRQn] = CAN1_RX0_IRQHandler,
    UNUSED_IRQS(CAN1_RX0_IRQn + 1, CAN1_SCE_IRQn - 1),
    [16 + CAN1_SCE_IRQn] = CAN1_SCE_IRQHandler,
    UNUSED_IRQS(CAN1_SCE_IRQn + 1, USART1_IRQn - 1),
    [16 + USART1_IRQn] = USART1_IRQHandler,
    UNUSED_IRQS(USART1_IRQn + 1, DMA2_Stream0_IRQn - 1),
    [16 + DMA2_Stream0_IRQn] = DMA2_Stream0_IRQHandler,
    UNUSED_IRQS(DMA2_Stream0_IRQn + 1, 81),
};
