#include "tests/target/cycles.h"

#include <stdbool.h>

#define SYST_CSR (*(volatile uint32_t *)0xE000E010)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018)

enum { CSR_ENABLE = 1, CSR_CORE_CLOCK = 4, CSR_COUNTFLAG = 1 << 16 };
enum { TICK_INSTRUCTIONS = 40, TICKS_MAX = 0xFFFFFF };

/** Calls in one measurement: a tick is then 0.1 instructions of a call. Long functions get fewer. */
enum { CALLS = 400, CALLS_LONG = 40, TICKS_LONG = 16000 };

static void empty(void *argument)
{
    (void)argument;
}

/** Ticks of `calls` calls; TICKS_MAX if the counter ran out. */
__attribute__((noinline)) static uint32_t ticks(void (*volatile function)(void *), void *argument, uint32_t calls)
{
    void (*const call)(void *) = function;

    SYST_RVR = TICKS_MAX;
    SYST_CVR = 0;
    SYST_CSR = CSR_ENABLE | CSR_CORE_CLOCK;
    (void)SYST_CSR;
    uint32_t start = SYST_CVR;
    for (uint32_t i = 0; i < calls; i++) {
        call(argument);
    }
    uint32_t end = SYST_CVR;
    bool ran_out = (SYST_CSR & CSR_COUNTFLAG) != 0 && end > start;
    SYST_CSR = 0;
    return ran_out ? TICKS_MAX : (start - end) & TICKS_MAX;
}

uint32_t target_count_instructions(void (*function)(void *), void *argument)
{
    uint32_t once = ticks(function, argument, 1);
    uint32_t calls = once > TICKS_LONG ? CALLS_LONG : CALLS;
    uint32_t full = ticks(function, argument, calls);
    uint32_t loop = ticks(empty, argument, calls);

    if (once == TICKS_MAX || full == TICKS_MAX) {
        return TARGET_COUNT_OVERFLOW;
    }
    /* The empty loop holds the call and one return, which belongs to the function. */
    return ((full - loop) * TICK_INSTRUCTIONS + calls / 2) / calls + 1;
}

uint32_t target_count_worst(uint32_t worst, void (*function)(void *), void *argument)
{
    const uint32_t once = target_count_once(function, argument);

    if (once < TARGET_COUNT_OVERFLOW - TICK_INSTRUCTIONS && once + TICK_INSTRUCTIONS <= worst) {
        return worst;
    }

    const uint32_t exact = target_count_instructions(function, argument);

    return exact > worst ? exact : worst;
}

uint32_t target_count_once(void (*function)(void *), void *argument)
{
    const uint32_t once = ticks(function, argument, 1);

    return once == TICKS_MAX ? TARGET_COUNT_OVERFLOW : once * TICK_INSTRUCTIONS;
}
