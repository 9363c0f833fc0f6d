#include "hal/stm32f4/bridges.h"

#include "hal/stm32f4/board.h"
#include "hal/stm32f4/stm32f405.h"

#define NANOSECONDS 1000000000U

/* Fields of the registers. */
#define CMS_CENTRE     1U
#define OCM_PWM_1      6U /* high while the counter is below the compare value */
#define OCM_PWM_2      7U /* high from it upwards */
#define MMS_ENABLE     1U
#define MMS_OC4REF     7U
#define SMS_TRIGGER    6U /* a trigger starts the counter */
#define SMS_CLOCK      7U /* a trigger is a count */
#define TS_ITR0        0U /* TIM1, for TIM8 and TIM3 */
#define LOCK_LEVEL_1   1U /* dead time, break and idle levels stay until a reset */
#define CENTRE_ALIGNED (TIM_CR1_CMS(CMS_CENTRE) | TIM_CR1_ARPE)
#define RUNNING        (CENTRE_ALIGNED | TIM_CR1_CEN)
#define OUTPUTS        (TIM_CCER_CC1E | TIM_CCER_CC1NE | TIM_CCER_CC2E | TIM_CCER_CC2NE)

/** What DTG stands for, counts (RM0090, TIMx_BDTR). It rises with the code. */
static uint32_t dead_time_of(uint32_t code)
{
    if (code < 0x80U) {
        return code;
    }
    if (code < 0xC0U) {
        return 2U * (64U + (code & 0x3FU));
    }
    return (code < 0xE0U ? 8U : 16U) * (32U + (code & 0x1FU));
}

uint8_t jp_bridges_dead_time(uint32_t counts)
{
    uint32_t code = 0;

    while (code < UINT8_MAX && dead_time_of(code) < counts) {
        code++;
    }
    return (uint8_t)code;
}

static uint32_t counts_in(uint32_t nanoseconds, uint32_t timer_hz)
{
    return (uint32_t)(((uint64_t)nanoseconds * timer_hz + NANOSECONDS - 1U) / NANOSECONDS);
}

static void connect_pins(void)
{
    jp_pin_drive(BOARD_LEFT_1H);
    jp_pin_drive(BOARD_LEFT_1L);
    jp_pin_drive(BOARD_LEFT_2H);
    jp_pin_drive(BOARD_LEFT_2L);
    jp_pin_listen(BOARD_LEFT_BREAK);
    jp_pin_drive(BOARD_RIGHT_1H);
    jp_pin_drive(BOARD_RIGHT_1L);
    jp_pin_drive(BOARD_RIGHT_2H);
    jp_pin_drive(BOARD_RIGHT_2L);
    jp_pin_listen(BOARD_RIGHT_BREAK);
}

/** Both half bridges of a motor; MOE stays off. */
static void configure_motor(volatile struct stm32_tim *timer, uint16_t period, uint8_t dead_time)
{
    timer->CR1 = CENTRE_ALIGNED;
    timer->PSC = 0;
    timer->ARR = period;
    timer->RCR = 0;
    timer->CCMR1 = TIM_CCMR1_OC1M(OCM_PWM_1) | TIM_CCMR1_OC1PE | TIM_CCMR1_OC2M(OCM_PWM_1) | TIM_CCMR1_OC2PE;
    timer->CCER = OUTPUTS;
    timer->BDTR = TIM_BDTR_OSSI | TIM_BDTR_BKE | TIM_BDTR_LOCK(LOCK_LEVEL_1) | TIM_BDTR_DTG(dead_time);
}

/** The compares of one motor: their difference is duty·period, rounded and limited, their mean period/2. `sign` is how
 *  the motor is wired. */
static inline void set_duty(volatile struct stm32_tim *timer, const struct jp_bridges *bridges, jp_q31 duty, int sign)
{
    const int32_t period = bridges->period;
    const int32_t limit = bridges->limit;
    const int32_t wanted = sign * (int32_t)(((int64_t)duty * (2 * period) + ((int64_t)1 << 31)) >> 32);
    const int32_t difference = jp_clamp32(wanted, -limit, limit);
    const int32_t first = (period + difference + 1) >> 1;

    timer->CCR1 = (uint32_t)first;
    timer->CCR2 = (uint32_t)(first - difference);
}

/** No update comes between the writes: all become active at the next one. */
static inline void set_duties(const struct jp_bridges *bridges, jp_q31 left, jp_q31 right)
{
    TIM1.CR1 = RUNNING | TIM_CR1_UDIS;
    TIM8.CR1 = RUNNING | TIM_CR1_UDIS;
    set_duty(&TIM1, bridges, left, BOARD_MOTOR_SIGN_LEFT);
    set_duty(&TIM8, bridges, right, BOARD_MOTOR_SIGN_RIGHT);
    TIM1.CR1 = RUNNING;
    TIM8.CR1 = RUNNING;
}

/** TIM3 counts the periods of TIM1, by its fourth channel, which is high at the top of the counter. */
static void start_samples(uint16_t period, uint32_t tick_rate)
{
    const uint32_t periods = BOARD_PWM_HZ / tick_rate;

    TIM1.CCR4 = period - 1U;
    TIM1.CCMR2 = TIM_CCMR2_OC4M(OCM_PWM_2);
    TIM1.CR2 = TIM_CR2_MMS(MMS_OC4REF);

    TIM3.PSC = 0;
    TIM3.ARR = periods - 1U;
    TIM3.CCR4 = periods - 1U;
    TIM3.CCMR2 = TIM_CCMR2_OC4M(OCM_PWM_2);
    TIM3.CCER = TIM_CCER_CC4E;
    TIM3.EGR = TIM_EGR_UG;
    TIM3.SMCR = TIM_SMCR_SMS(SMS_CLOCK) | TIM_SMCR_TS(TS_ITR0);
    TIM3.CR1 = TIM_CR1_CEN;
}

/** The left motor's timer starts the right one's. */
static void start_in_phase(void)
{
    TIM1.EGR = TIM_EGR_UG;
    TIM8.EGR = TIM_EGR_UG;
    TIM1.CR2 = TIM_CR2_MMS(MMS_ENABLE);
    TIM8.SMCR = TIM_SMCR_SMS(SMS_TRIGGER) | TIM_SMCR_TS(TS_ITR0);
    TIM1.CR1 = RUNNING;
}

void jp_bridges_start(struct jp_bridges *bridges, uint32_t timer_hz, uint32_t tick_rate)
{
    const uint32_t period = timer_hz / (2U * BOARD_PWM_HZ);
    const uint8_t dead_time = jp_bridges_dead_time(counts_in(BOARD_DEAD_TIME_NS, timer_hz));
    const uint32_t margin = dead_time_of(dead_time) + (counts_in(BOARD_LOW_SIDE_NS, timer_hz) + 1U) / 2U;

    *bridges = (struct jp_bridges){.period = (uint16_t)period, .limit = (uint16_t)(period - 2U * margin)};
    RCC.APB1ENR |= RCC_APB1ENR_TIM3EN;
    RCC.APB2ENR |= RCC_APB2ENR_TIM1EN | RCC_APB2ENR_TIM8EN;
    configure_motor(&TIM1, bridges->period, dead_time);
    configure_motor(&TIM8, bridges->period, dead_time);
    start_in_phase();
    set_duties(bridges, 0, 0);
    start_samples(bridges->period, tick_rate);
    connect_pins();
}

void jp_bridges_off(void)
{
    TIM1.BDTR &= ~TIM_BDTR_MOE;
    TIM8.BDTR &= ~TIM_BDTR_MOE;
}

static void switch_on(void)
{
    TIM1.BDTR |= TIM_BDTR_MOE;
    TIM8.BDTR |= TIM_BDTR_MOE;
}

static bool are_on(void)
{
    return (TIM1.BDTR & TIM8.BDTR & TIM_BDTR_MOE) != 0U;
}

enum jp_status jp_bridges_write(struct jp_bridges *bridges, const struct jp_actuation *actuation)
{
    set_duties(bridges, actuation->duty_left, actuation->duty_right);
    if (actuation->enabled == 0U) {
        jp_bridges_off();
        bridges->on = false;
        bridges->tripped = false;
        return JP_OK;
    }
    if (!bridges->on && !bridges->tripped) {
        switch_on();
        bridges->on = true;
    }
    if (!are_on()) {
        jp_bridges_off();
        bridges->on = false;
        bridges->tripped = true;
        return JP_ERR_HARDWARE;
    }
    return JP_OK;
}
