/** Start-up: memory, stacks with their guards, then main() on the main stack. The port has the vector table. */
#include "hal/cortex_m/start.h"

#include <string.h>

#include "hal/cortex_m/cortex_m.h"
#include "hal/cortex_m/fault.h"
#include "hal/cortex_m/stack_guard.h"

/* Addresses that the linker script gives. */
extern uint8_t firmware_data_start[], firmware_data_end[], firmware_data_load[];
extern uint8_t firmware_bss_start[], firmware_bss_end[];
extern uint8_t firmware_main_stack_guard[], firmware_handler_stack_guard[];

int main(void);

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

/** For an image that is compiled for it; saved lazily, as the core comes out of a reset. */
static void start_floating_point(void)
{
#ifdef __ARM_FP
    CPACR |= CPACR_FPU;
    jp_finish_writes();
#endif
}

/** Not static: the reset handler branches to it once the stacks are set. */
_Noreturn void jp_startup(void);

_Noreturn void jp_startup(void)
{
    start_floating_point();
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
