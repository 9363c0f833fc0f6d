#include "hal/stm32f4/wait.h"

#include "hal/stm32f4/timer.h"

#define POLLS_A_MICROSECOND 64U

bool jp_wait_for(const volatile uint32_t *reg, uint32_t mask, uint32_t value, uint32_t polls)
{
    for (uint32_t left = polls; left > 0U; left--) {
        if ((*reg & mask) == value) {
            return true;
        }
    }
    return false;
}

void jp_wait_us(uint32_t us)
{
    const uint32_t start = jp_timer_us();

    for (uint32_t left = us * POLLS_A_MICROSECOND; left > 0U && jp_timer_us() - start <= us; left--) {
    }
}
