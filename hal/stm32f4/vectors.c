/** The vector table of the STM32F405. */
#include "hal/cortex_m/fault.h"
#include "hal/cortex_m/start.h"
#include "hal/stm32f4/stm32f405.h"

__attribute__((naked)) void jp_unexpected_handler(void)
{
    __asm__ volatile("b jp_fault_handler\n");
}

void NMI_Handler(void) JP_WEAK_HANDLER;
void SysTick_Handler(void) JP_WEAK_HANDLER;
void SVC_Handler(void) JP_WEAK_HANDLER;
void PendSV_Handler(void) JP_WEAK_HANDLER;
void PVD_IRQHandler(void) JP_WEAK_HANDLER;
void ADC_IRQHandler(void) JP_WEAK_HANDLER;
void CAN1_TX_IRQHandler(void) JP_WEAK_HANDLER;
void CAN1_RX0_IRQHandler(void) JP_WEAK_HANDLER;
void CAN1_SCE_IRQHandler(void) JP_WEAK_HANDLER;
void USART1_IRQHandler(void) JP_WEAK_HANDLER;
void DMA2_Stream0_IRQHandler(void) JP_WEAK_HANDLER;

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
    JP_UNUSED_IRQS(0, PVD_IRQn - 1),
    [16 + PVD_IRQn] = PVD_IRQHandler,
    JP_UNUSED_IRQS(PVD_IRQn + 1, ADC_IRQn - 1),
    [16 + ADC_IRQn] = ADC_IRQHandler,
    [16 + CAN1_TX_IRQn] = CAN1_TX_IRQHandler,
    [16 + CAN1_RX0_IRQn] = CAN1_RX0_IRQHandler,
    JP_UNUSED_IRQS(CAN1_RX0_IRQn + 1, CAN1_SCE_IRQn - 1),
    [16 + CAN1_SCE_IRQn] = CAN1_SCE_IRQHandler,
    JP_UNUSED_IRQS(CAN1_SCE_IRQn + 1, USART1_IRQn - 1),
    [16 + USART1_IRQn] = USART1_IRQHandler,
    JP_UNUSED_IRQS(USART1_IRQn + 1, DMA2_Stream0_IRQn - 1),
    [16 + DMA2_Stream0_IRQn] = DMA2_Stream0_IRQHandler,
    JP_UNUSED_IRQS(DMA2_Stream0_IRQn + 1, 81),
};
