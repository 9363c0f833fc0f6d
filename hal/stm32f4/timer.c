#include "hal/stm32f4/timer.h"

#include "hal/stm32f4/stm32f405.h"

#define COUNTS_A_SECOND 1000000U

void jp_timer_start(uint32_t timer_hz)
{
    RCC.APB1ENR |= RCC_APB1ENR_TIM5EN;
    TIM5.CR1 = 0;
    TIM5.PSC = timer_hz / COUNTS_A_SECOND - 1U;
    TIM5.ARR = UINT32_MAX;
    TIM5.EGR = TIM_EGR_UG; /* takes the prescaler over, and counts from 0 */
    TIM5.CR1 = TIM_CR1_CEN;
}

uint32_t jp_timer_us(void)
{
    return TIM5.CNT;
}
