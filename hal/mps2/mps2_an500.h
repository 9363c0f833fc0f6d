/** The registers of Arm's MPS2 board with the AN500 image (a Cortex-M7 with single-precision hardware) that the
 * firmware uses; names as in the application note and the Cortex-M system design kit. The addresses are in
 * mps2_an500.ld. */
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

/** CMSDK APB timer: counts down from RELOAD, and interrupts at 0. */
struct cmsdk_timer {
    uint32_t CTRL;
    uint32_t VALUE;
    uint32_t RELOAD;
    uint32_t INTCLEAR;
};

#define TIMER_CTRL_ENABLE (1U << 0)
#define TIMER_CTRL_IRQ    (1U << 3)
#define TIMER_INT         (1U << 0)

/** CMSDK APB watchdog: counts down from LOAD; at 0 an NMI, and when it is there again a reset. */
struct cmsdk_watchdog {
    uint32_t LOAD;
    uint32_t VALUE;
    uint32_t CONTROL;
    uint32_t INTCLR;
};

#define WATCHDOG_CONTROL_INTEN (1U << 0)
#define WATCHDOG_CONTROL_RESEN (1U << 1)

extern volatile struct cmsdk_uart UART0;
extern volatile struct cmsdk_timer TIMER0;
extern volatile struct cmsdk_watchdog WATCHDOG;

#define UART0_RX_IRQn 0U
#define TIMER0_IRQn   8U

/** Of the core and its peripherals. */
#define CORE_HZ 25000000U

#endif
