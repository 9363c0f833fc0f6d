#include "hal/mps2/timer.h"

#include "hal/mps2/mps2_an500.h"

void jp_timer_start(uint32_t rate)
{
    TIMER0.RELOAD = CORE_HZ / rate - 1U;
    TIMER0.VALUE = CORE_HZ / rate - 1U;
    TIMER0.INTCLEAR = TIMER_INT;
    TIMER0.CTRL = TIMER_CTRL_ENABLE | TIMER_CTRL_IRQ;
}

void jp_timer_clear(void)
{
    TIMER0.INTCLEAR = TIMER_INT;
}
