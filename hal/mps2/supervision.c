#include "hal/mps2/supervision.h"

#include "hal/mps2/mps2_an500.h"

/** What no memory holds by chance after power-on. */
#define ALIVE_0 0x4A504156U
#define ALIVE_1 0xB5AFBEA9U

__attribute__((section(".noinit"))) static uint32_t alive[2];

void jp_watchdog_start(void)
{
    WATCHDOG.LOAD = CORE_HZ / 1000U * JP_WATCHDOG_MS;
    WATCHDOG.CONTROL = WATCHDOG_CONTROL_INTEN | WATCHDOG_CONTROL_RESEN;
}

void jp_watchdog_feed(void)
{
    WATCHDOG.INTCLR = 1;
}

enum jp_reset_cause jp_reset_cause(const struct jp_post_mortem *record)
{
    const bool was_alive = alive[0] == ALIVE_0 && alive[1] == ALIVE_1;

    alive[0] = ALIVE_0;
    alive[1] = ALIVE_1;
    if (!was_alive) {
        return JP_RESET_POWER_ON;
    }
    return record->pending != 0U ? JP_RESET_SOFTWARE : JP_RESET_WATCHDOG;
}
