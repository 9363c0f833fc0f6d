/** Vector table and start-up: the floating-point unit, memory, then main(). */
#include <string.h>

#include "hal/mps2/mps2_an500.h"

/* Addresses that the linker script gives. */
extern uint8_t firmware_stack_top[], firmware_data_start[], firmware_data_end[], firmware_data_load[];
extern uint8_t firmware_bss_start[], firmware_bss_end[];

int main(void);

static size_t length(const uint8_t *start, const uint8_t *end)
{
    return (size_t)((uintptr_t)end - (uintptr_t)start);
}

static _Noreturn void reset(void)
{
    MPS2_SCB.AIRCR = MPS2_AIRCR_VECTKEY | MPS2_AIRCR_SYSRESETREQ;
    for (;;) {
    }
}

_Noreturn void jp_reset_handler(void);

_Noreturn void jp_reset_handler(void)
{
    CPACR |= CPACR_FPU;
    __asm__ volatile("dsb\nisb" ::: "memory");
    memcpy(firmware_data_start, firmware_data_load, length(firmware_data_start, firmware_data_end));
    memset(firmware_bss_start, 0, length(firmware_bss_start, firmware_bss_end));
    (void)main();
    reset();
}

/** A fault of the core: what the robot did stays in the record, and the drives switch off by themselves meanwhile. */
void jp_fault_handler(void);

void jp_fault_handler(void)
{
    reset();
}

void PendSV_Handler(void);
void UART0_RX_Handler(void);

extern void (*const jp_vectors[16 + 1])(void);

__attribute__((section(".vectors"), used)) void (*const jp_vectors[16 + 1])(void) = {
    (void (*)(void))firmware_stack_top,
    jp_reset_handler,
    [2 ... 13] = jp_fault_handler,
    [14] = PendSV_Handler,
    [15] = jp_fault_handler,
    [16 + UART0_RX_IRQn] = UART0_RX_Handler,
};
