/** The registers of Arm's MPS2 board with the AN500 image (a Cortex-M7 with single-precision hardware) that the
 * firmware uses; names as in the application note and the architecture manual. The addresses are in mps2_an500.ld. */
#ifndef JOULEPATH_HAL_MPS2_MPS2_AN500_H
#define JOULEPATH_HAL_MPS2_MPS2_AN500_H

#include <stdint.h>

/** CMSDK APB UART. */
struct cmsdk_uart {
    uint32_t DATA;
    uint32_t STATE;
    uint32_t CTRL;
    uint32_t INTCLEAR;
    uint32_t BAUDDIV;
};

#define UART_STATE_TX_FULL (1U << 0)
#define UART_STATE_RX_FULL (1U << 1)
#define UART_CTRL_TX       (1U << 0)
#define UART_CTRL_RX       (1U << 1)
#define UART_CTRL_RX_IRQ   (1U << 3)
#define UART_INT_RX        (1U << 1)

/** System control block. */
struct mps2_scb {
    uint32_t CPUID;
    uint32_t ICSR;
    uint32_t VTOR;
    uint32_t AIRCR;
    uint32_t SCR;
    uint32_t CCR;
    uint8_t SHPR[12]; /**< priorities of the system exceptions 4 to 15 */
};

#define MPS2_ICSR_PENDSVSET    (1U << 28)
#define MPS2_AIRCR_VECTKEY     (0x5FAU << 16)
#define MPS2_AIRCR_SYSRESETREQ (1U << 2)
#define SHPR_PENDSV            10U

extern volatile struct cmsdk_uart UART0;
extern volatile struct mps2_scb MPS2_SCB;
extern volatile uint32_t CPACR;
extern volatile uint32_t NVIC_ISER0;
extern volatile uint8_t NVIC_IPR[32];

#define CPACR_FPU (0xFU << 20)

#define UART0_RX_IRQn 0U

/** Of the core and the UART. */
#define CORE_HZ 25000000U

#endif
