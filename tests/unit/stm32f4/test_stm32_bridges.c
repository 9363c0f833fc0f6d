/* The bridges: timing of the PWM from its registers, every dead time, every duty at both clocks, breaks. */
#include "hal/stm32f4/bridges.h"

#include "hal/stm32f4/board.h"
#include "tests/support/stm32_fake.h"

#include "unity.h"

#define FAST_HZ 168000000U
#define SLOW_HZ 16000000U

static struct jp_bridges bridges;
static uint32_t timer_hz;

static void start(uint32_t hz)
{
    stm32_fake_reset();
    timer_hz = hz;
    jp_bridges_start(&bridges, hz, 1000);
}

void setUp(void)
{
    start(FAST_HZ);
}

void tearDown(void)
{
}

/* ---- What the registers say, by the reference manual ---- */

/* Dead time of each code of DTG: leading bits, step, base. */
static const struct {
    uint32_t mask;
    uint32_t leading;
    uint32_t step;
    uint32_t base;
} ranges[] = {{0x80, 0x00, 1, 0}, {0xC0, 0x80, 2, 64}, {0xE0, 0xC0, 8, 32}, {0xE0, 0xE0, 16, 32}};

static uint32_t dead_time_of(uint32_t code)
{
    for (unsigned i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        if ((code & ranges[i].mask) == ranges[i].leading) {
            return ranges[i].step * (ranges[i].base + (code & ~ranges[i].mask & 0xFFU));
        }
    }
    return 0;
}

static uint32_t shortest_dead_time(uint32_t counts)
{
    uint32_t shortest = UINT32_MAX;

    for (uint32_t code = 0; code <= 0xFFU; code++) {
        if (dead_time_of(code) >= counts && dead_time_of(code) < shortest) {
            shortest = dead_time_of(code);
        }
    }
    return shortest;
}

static bool is_on(const volatile struct stm32_tim *timer)
{
    return (timer->BDTR & TIM_BDTR_MOE) != 0U;
}

/* Counts of duty that drive the wheel forward. */
static int32_t forward(const volatile struct stm32_tim *timer, int sign)
{
    return sign * ((int32_t)timer->CCR1 - (int32_t)timer->CCR2);
}

static int32_t left(void)
{
    return forward(&TIM1, BOARD_MOTOR_SIGN_LEFT);
}

static int32_t right(void)
{
    return forward(&TIM8, BOARD_MOTOR_SIGN_RIGHT);
}

static enum jp_status write_duties(jp_q31 duty_left, jp_q31 duty_right)
{
    const struct jp_actuation actuation = {.duty_left = duty_left, .duty_right = duty_right, .enabled = 1};

    return jp_bridges_write(&bridges, &actuation);
}

static enum jp_status write_off(void)
{
    const struct jp_actuation actuation = {.enabled = 0};

    return jp_bridges_write(&bridges, &actuation);
}

/* ---- Dead time ---- */

static void test_every_dead_time_is_the_shortest_that_is_long_enough(void)
{
    for (uint32_t counts = 0; counts <= 1008U; counts++) {
        TEST_ASSERT_EQUAL_UINT32(shortest_dead_time(counts), dead_time_of(jp_bridges_dead_time(counts)));
    }
}

static void test_dead_times_at_the_ends_of_the_ranges(void)
{
    TEST_ASSERT_EQUAL_HEX8(0x00, jp_bridges_dead_time(0));
    TEST_ASSERT_EQUAL_HEX8(0x7F, jp_bridges_dead_time(127));
    TEST_ASSERT_EQUAL_HEX8(0x80, jp_bridges_dead_time(128));
    TEST_ASSERT_EQUAL_HEX8(0xBF, jp_bridges_dead_time(254));
    TEST_ASSERT_EQUAL_HEX8(0xC0, jp_bridges_dead_time(255));
    TEST_ASSERT_EQUAL_HEX8(0xDF, jp_bridges_dead_time(504));
    TEST_ASSERT_EQUAL_HEX8(0xE0, jp_bridges_dead_time(505));
    TEST_ASSERT_EQUAL_HEX8(0xFF, jp_bridges_dead_time(1008));
}

static void test_longer_dead_times_than_there_are(void)
{
    TEST_ASSERT_EQUAL_HEX8(0xFF, jp_bridges_dead_time(1009));
    TEST_ASSERT_EQUAL_HEX8(0xFF, jp_bridges_dead_time(UINT32_MAX));
}

static void check_dead_time(uint32_t hz)
{
    const uint64_t billion = 1000000000U;
    uint32_t counts;

    start(hz);
    counts = dead_time_of(TIM1.BDTR & 0xFFU);
    TEST_ASSERT_TRUE(counts * billion >= (uint64_t)BOARD_DEAD_TIME_NS * hz);
    TEST_ASSERT_TRUE((counts - 1U) * billion < (uint64_t)BOARD_DEAD_TIME_NS * hz);
    TEST_ASSERT_EQUAL_HEX32(TIM1.BDTR, TIM8.BDTR);
}

static void test_dead_time_of_the_board(void)
{
    check_dead_time(FAST_HZ);
    check_dead_time(SLOW_HZ);
}

/* ---- Start ---- */

static void check_pwm(const volatile struct stm32_tim *timer)
{
    TEST_ASSERT_EQUAL_UINT32(BOARD_PWM_HZ, timer_hz / (2U * timer->ARR * (timer->PSC + 1U)));
    TEST_ASSERT_EQUAL_HEX32(TIM_CR1_CMS(1) | TIM_CR1_ARPE, timer->CR1 & ~TIM_CR1_CEN);
    TEST_ASSERT_EQUAL_UINT32(0, timer->RCR);
    CHECK_SET(TIM_CCMR1_OC1M(6) | TIM_CCMR1_OC1PE | TIM_CCMR1_OC2M(6) | TIM_CCMR1_OC2PE, timer->CCMR1);
    TEST_ASSERT_EQUAL_HEX32(TIM_CCER_CC1E | TIM_CCER_CC1NE | TIM_CCER_CC2E | TIM_CCER_CC2NE, timer->CCER);
}

static void test_both_timers_make_the_same_pwm(void)
{
    check_pwm(&TIM1);
    check_pwm(&TIM8);
    start(SLOW_HZ);
    check_pwm(&TIM1);
    check_pwm(&TIM8);
    CHECK_SET(RCC_APB2ENR_TIM1EN | RCC_APB2ENR_TIM8EN, RCC.APB2ENR);
}

/* Off, low when off, a low fault input breaks, only the program switches on again, and nobody changes this. */
static void check_is_safe(const volatile struct stm32_tim *timer)
{
    const uint32_t automatic_output = 1U << 14;
    const uint32_t break_high = 1U << 13;
    const uint32_t idle_levels = 0xF00;

    TEST_ASSERT_FALSE(is_on(timer));
    CHECK_SET(TIM_BDTR_OSSI | TIM_BDTR_BKE | TIM_BDTR_LOCK(1), timer->BDTR);
    CHECK_CLEAR(automatic_output | break_high, timer->BDTR);
    CHECK_CLEAR(idle_levels, timer->CR2);
}

static void test_outputs_are_off_and_low_after_the_start(void)
{
    check_is_safe(&TIM1);
    check_is_safe(&TIM8);
    TEST_ASSERT_EQUAL_INT32(0, left());
    TEST_ASSERT_EQUAL_INT32(0, right());
}

static void test_the_left_timer_starts_the_right_one(void)
{
    TEST_ASSERT_EQUAL_HEX32(TIM_SMCR_SMS(6) | TIM_SMCR_TS(0), TIM8.SMCR);
    TEST_ASSERT_EQUAL_HEX32(0, TIM1.SMCR);
    CHECK_SET(TIM_CR1_CEN, TIM1.CR1);
}

/* Once in a period of TIM1, just below its top; TIM3 lets every twentieth pass. */
static void test_samples_come_at_1_khz(void)
{
    TEST_ASSERT_EQUAL_UINT32(1000, BOARD_PWM_HZ / (TIM3.ARR + 1U));
    TEST_ASSERT_EQUAL_UINT32(0, TIM3.PSC);
    TEST_ASSERT_EQUAL_HEX32(TIM_CR2_MMS(7), TIM1.CR2);
    TEST_ASSERT_TRUE(TIM1.CCR4 > 0U && TIM1.CCR4 < TIM1.ARR);
    TEST_ASSERT_EQUAL_HEX32(TIM_CCMR2_OC4M(7), TIM1.CCMR2);
    TEST_ASSERT_EQUAL_HEX32(TIM_SMCR_SMS(7) | TIM_SMCR_TS(0), TIM3.SMCR);
    TEST_ASSERT_EQUAL_HEX32(TIM_CCMR2_OC4M(7), TIM3.CCMR2);
    TEST_ASSERT_TRUE(TIM3.CCR4 > 0U && TIM3.CCR4 <= TIM3.ARR);
    TEST_ASSERT_EQUAL_HEX32(TIM_CCER_CC4E, TIM3.CCER);
    CHECK_SET(TIM_CR1_CEN, TIM3.CR1);
}

static void test_samples_come_at_the_rate_of_the_ticks(void)
{
    static const uint32_t rates[] = {100, 500, 1000};

    for (unsigned i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        stm32_fake_reset();
        jp_bridges_start(&bridges, 168000000, rates[i]);
        TEST_ASSERT_EQUAL_UINT32(rates[i], BOARD_PWM_HZ / (TIM3.ARR + 1U));
        TEST_ASSERT_TRUE(TIM3.CCR4 > 0U && TIM3.CCR4 <= TIM3.ARR);
    }
}

static void check_connected(struct jp_pin pin)
{
    TEST_ASSERT_EQUAL_UINT32(2, (pin.port->MODER >> (2U * pin.number)) & 3U);
}

static void test_all_pins_are_connected(void)
{
    check_connected(BOARD_LEFT_1H);
    check_connected(BOARD_LEFT_1L);
    check_connected(BOARD_LEFT_2H);
    check_connected(BOARD_LEFT_2L);
    check_connected(BOARD_LEFT_BREAK);
    check_connected(BOARD_RIGHT_1H);
    check_connected(BOARD_RIGHT_1L);
    check_connected(BOARD_RIGHT_2H);
    check_connected(BOARD_RIGHT_2L);
    check_connected(BOARD_RIGHT_BREAK);
}

/* ---- Duties ---- */

static void check_low_side_time(const volatile struct stm32_tim *timer, uint32_t compare)
{
    const uint64_t low = 2U * (timer->ARR - compare) - 2U * dead_time_of(timer->BDTR & 0xFFU);

    TEST_ASSERT_TRUE(compare <= timer->ARR);
    TEST_ASSERT_TRUE(low * 1000000000U >= (uint64_t)BOARD_LOW_SIDE_NS * timer_hz);
}

/* The difference is the nearest to duty·period, or the limit; high sides are on about the middle of the period. */
static void check_motor(const volatile struct stm32_tim *timer, int sign, jp_q31 duty)
{
    const int64_t one = (int64_t)1 << 31;
    const int64_t wanted = (int64_t)duty * timer->ARR;
    const int64_t got = forward(timer, sign);
    const int64_t error = got * one - wanted;
    const int64_t sum = (int64_t)timer->CCR1 + timer->CCR2;

    if (got == bridges.limit) {
        TEST_ASSERT_TRUE(error <= one / 2);
    } else if (got == -(int64_t)bridges.limit) {
        TEST_ASSERT_TRUE(error >= -one / 2);
    } else {
        TEST_ASSERT_TRUE(error <= one / 2 && error >= -one / 2);
    }
    TEST_ASSERT_TRUE(sum == timer->ARR || sum == timer->ARR + 1);
    check_low_side_time(timer, timer->CCR1);
    check_low_side_time(timer, timer->CCR2);
}

static void check_duty(jp_q31 duty)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, write_duties(duty, (jp_q31)(0 - (int64_t)(duty / 2))));
    check_motor(&TIM1, BOARD_MOTOR_SIGN_LEFT, duty);
    check_motor(&TIM8, BOARD_MOTOR_SIGN_RIGHT, -(duty / 2));
    CHECK_SET(TIM_CR1_CEN, TIM1.CR1 & TIM8.CR1);
    CHECK_CLEAR(TIM_CR1_UDIS, TIM1.CR1 | TIM8.CR1);
}

static void check_all_duties(uint32_t hz)
{
    const int64_t step = ((int64_t)1 << 32) / 9973; /* some two to a count */

    start(hz);
    for (int64_t duty = INT32_MIN; duty <= INT32_MAX; duty += step) {
        check_duty((jp_q31)duty);
    }
    check_duty(INT32_MAX);
    check_duty(0);
    check_duty(1);
    check_duty(-1);
}

static void test_duties_at_168_mhz(void)
{
    check_all_duties(FAST_HZ);
}

static void test_duties_at_16_mhz(void)
{
    check_all_duties(SLOW_HZ);
}

static void test_limit_is_as_stated(void)
{
    TEST_ASSERT_EQUAL_UINT(4200, bridges.period);
    TEST_ASSERT_EQUAL_UINT(4200 - 2 * (51 + 42), bridges.limit);
    (void)write_duties(INT32_MAX, INT32_MIN);
    TEST_ASSERT_EQUAL_INT32(bridges.limit, left());
    TEST_ASSERT_EQUAL_INT32(-(int32_t)bridges.limit, right());
}

static void test_each_motor_gets_its_own_duty(void)
{
    (void)write_duties(JP_Q31_MAX / 4, -(JP_Q31_MAX / 2));
    TEST_ASSERT_EQUAL_INT32(4200 / 4, left());
    TEST_ASSERT_EQUAL_INT32(-4200 / 2, right());
}

/* ---- On and off ---- */

static void test_the_first_duty_switches_on(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, write_duties(0, 0));
    TEST_ASSERT_TRUE(is_on(&TIM1) && is_on(&TIM8));
}

static void test_disabled_is_off_with_nothing_left_for_the_next_time(void)
{
    (void)write_duties(JP_Q31_MAX / 2, JP_Q31_MAX / 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, write_off());
    TEST_ASSERT_FALSE(is_on(&TIM1) || is_on(&TIM8));
    TEST_ASSERT_EQUAL_INT32(0, left());
    TEST_ASSERT_EQUAL_INT32(0, right());
    TEST_ASSERT_EQUAL_INT(JP_OK, write_off());
    TEST_ASSERT_EQUAL_INT(JP_OK, write_duties(0, 0));
    TEST_ASSERT_TRUE(is_on(&TIM1) && is_on(&TIM8));
}

static void test_off_from_every_state_and_more_than_once(void)
{
    uint32_t rest;

    stm32_fake_reset();
    jp_bridges_off();
    TEST_ASSERT_EQUAL_HEX32(0, TIM1.BDTR | TIM8.BDTR);

    start(FAST_HZ);
    rest = TIM1.BDTR;
    (void)write_duties(JP_Q31_MAX, JP_Q31_MAX);
    for (int i = 0; i < 3; i++) {
        jp_bridges_off();
        TEST_ASSERT_EQUAL_HEX32(rest, TIM1.BDTR);
        TEST_ASSERT_EQUAL_HEX32(rest, TIM8.BDTR);
    }
}

static void check_break(volatile struct stm32_tim *timer)
{
    start(FAST_HZ);
    TEST_ASSERT_EQUAL_INT(JP_OK, write_duties(1000, 1000));
    timer->BDTR &= ~TIM_BDTR_MOE;
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, write_duties(1000, 1000));
    TEST_ASSERT_FALSE(is_on(&TIM1) || is_on(&TIM8));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, write_duties(1000, 1000));
    TEST_ASSERT_FALSE(is_on(&TIM1) || is_on(&TIM8));
    TEST_ASSERT_EQUAL_INT(JP_OK, write_off());
    TEST_ASSERT_EQUAL_INT(JP_OK, write_duties(1000, 1000));
    TEST_ASSERT_TRUE(is_on(&TIM1) && is_on(&TIM8));
}

static void test_a_break_of_either_motor_switches_both_off_until_disabled(void)
{
    check_break(&TIM1);
    check_break(&TIM8);
}

/* As a fault handler does it; the next write notices. */
static void test_off_behind_the_back_is_like_a_break(void)
{
    (void)write_duties(1000, 1000);
    jp_bridges_off();
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, write_duties(1000, 1000));
}
