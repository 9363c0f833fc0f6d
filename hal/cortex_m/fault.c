#include "hal/cortex_m/fault.h"

#include "hal/cortex_m/cortex_m.h"
#include "hal/cortex_m/stack_guard.h"

/* Addresses that the linker script gives. */
extern uint8_t firmware_main_stack_guard[], firmware_handler_stack_guard[], firmware_handler_stack_top[];

__attribute__((section(".noinit"))) struct jp_post_mortem jp_post_mortem;
volatile uint32_t jp_fault_tick;

/** A stack of its own: the one at fault may be full. */
#define FAULT_STACK_SIZE 512U
static uint8_t fault_stack[FAULT_STACK_SIZE] __attribute__((aligned(8), used));

/** What the core pushes when an exception begins. */
struct exception_frame {
    uint32_t r0, r1, r2, r3, r12, lr, pc, psr;
};

static bool is_guard(uintptr_t address)
{
    return address - (uintptr_t)firmware_main_stack_guard < STACK_GUARD_BYTES ||
           address - (uintptr_t)firmware_handler_stack_guard < STACK_GUARD_BYTES;
}

/** In the guard, or below the memory. */
#define STACKING_FAILED (CFSR_MSTKERR | CFSR_STKERR)

/** A frame that the core could not push is not there. */
static bool is_whole(const struct exception_frame *frame)
{
    const uintptr_t address = (uintptr_t)frame;
    const uintptr_t last = (uintptr_t)firmware_handler_stack_top - sizeof *frame;

    return address >= (uintptr_t)firmware_main_stack_guard && address <= last && address % sizeof frame->r0 == 0U &&
           (SCB.CFSR & STACKING_FAILED) == 0U;
}

static bool is_overflow(uint32_t status, uint32_t address)
{
    return (status & STACKING_FAILED) != 0U || ((status & CFSR_MMARVALID) != 0U && is_guard(address));
}

static uint32_t fault_address(void)
{
    if ((SCB.CFSR & CFSR_MMARVALID) != 0U) {
        return SCB.MMFAR;
    }
    return (SCB.CFSR & CFSR_BFARVALID) != 0U ? SCB.BFAR : 0U;
}

/** Called by the handlers below, on the stack for faults. */
_Noreturn void jp_fault_end(const struct exception_frame *frame);

_Noreturn void jp_fault_end(const struct exception_frame *frame)
{
    struct jp_crash crash = {
        .exception = SCB.ICSR & ICSR_VECTACTIVE, .status = SCB.CFSR, .address = fault_address(), .tick = jp_fault_tick};

    jp_bridges_off();
    crash.cause = is_overflow(crash.status, crash.address) ? JP_RESET_STACK : JP_RESET_FAULT;
    if (is_whole(frame)) {
        crash.pc = frame->pc;
        crash.lr = frame->lr;
        crash.psr = frame->psr;
    }
    jp_post_mortem_write(&jp_post_mortem, &crash);
    jp_system_reset();
}

/** EXC_RETURN in lr tells which stack has the frame. */
__attribute__((naked)) void jp_fault_handler(void)
{
    __asm__ volatile("cpsid i\n"
                     "tst lr, #4\n"
                     "ite eq\n"
                     "mrseq r0, msp\n"
                     "mrsne r0, psp\n"
                     "ldr r1, =fault_stack + %c0\n"
                     "msr msp, r1\n"
                     "b jp_fault_end\n" ::"i"(FAULT_STACK_SIZE));
}
