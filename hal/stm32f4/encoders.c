#include "hal/stm32f4/encoders.h"

#include "hal/stm32f4/board.h"
#include "hal/stm32f4/stm32f405.h"

/* Fields of the registers. */
#define SMS_ENCODER_3 3U /* counts the edges of both inputs */
#define CCS_INPUT     1U /* a channel is the input of its pin */
#define ICF_0_6_US    8U /* 6 equal samples at an eighth of the clock: 0.6 µs at 84 MHz */

static void start_timer(volatile struct stm32_tim *timer)
{
    timer->CR1 = 0;
    timer->SMCR = TIM_SMCR_SMS(SMS_ENCODER_3);
    timer->CCMR1 =
        TIM_CCMR1_CC1S(CCS_INPUT) | TIM_CCMR1_IC1F(ICF_0_6_US) | TIM_CCMR1_CC2S(CCS_INPUT) | TIM_CCMR1_IC2F(ICF_0_6_US);
    timer->PSC = 0;
    timer->ARR = UINT16_MAX;
    timer->CNT = 0;
    timer->CR1 = TIM_CR1_CEN;
}

void jp_encoders_start(struct jp_encoders *encoders)
{
    *encoders = (struct jp_encoders){.left = 0};
    jp_pin_listen(BOARD_LEFT_ENCODER_A);
    jp_pin_listen(BOARD_LEFT_ENCODER_B);
    jp_pin_listen(BOARD_RIGHT_ENCODER_A);
    jp_pin_listen(BOARD_RIGHT_ENCODER_B);
    RCC.APB1ENR |= RCC_APB1ENR_TIM2EN | RCC_APB1ENR_TIM4EN;
    start_timer(&TIM4);
    start_timer(&TIM2);
}

/** What the timer moved since the last time, −32 768…32 767 counts. */
static int32_t movement(const volatile struct stm32_tim *timer, uint16_t *last)
{
    const uint16_t now = (uint16_t)timer->CNT;
    const int16_t moved = (int16_t)(uint16_t)(now - *last);

    *last = now;
    return moved;
}

void jp_encoders_read(struct jp_encoders *encoders, struct jp_sensors *sensors)
{
    encoders->count_left += (uint32_t)(BOARD_ENCODER_SIGN_LEFT * movement(&TIM4, &encoders->left));
    encoders->count_right += (uint32_t)(BOARD_ENCODER_SIGN_RIGHT * movement(&TIM2, &encoders->right));
    sensors->encoder_left = encoders->count_left;
    sensors->encoder_right = encoders->count_right;
}
