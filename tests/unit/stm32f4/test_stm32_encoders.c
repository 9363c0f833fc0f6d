/* Encoders: every border of the timers' 16 bits and of the counts' 32, both ways, against counts of 64 bits. */
#include "hal/stm32f4/encoders.h"

#include "hal/stm32f4/board.h"
#include "tests/support/stm32_fake.h"

#include "unity.h"

static struct jp_encoders encoders;
static struct jp_sensors sensors;
static int64_t turned_left; /* counts of the timers since the start, and for ever */
static int64_t turned_right;

void setUp(void)
{
    stm32_fake_reset();
    jp_encoders_start(&encoders);
    turned_left = 0;
    turned_right = 0;
}

void tearDown(void)
{
}

/* Moves the timers, reads, compares. */
static void move(int32_t left, int32_t right)
{
    turned_left += left;
    turned_right += right;
    TIM4.CNT = (uint32_t)turned_left & 0xFFFFU;
    TIM2.CNT = (uint32_t)turned_right & 0xFFFFU;
    jp_encoders_read(&encoders, &sensors);
    TEST_ASSERT_EQUAL_UINT32((uint32_t)(BOARD_ENCODER_SIGN_LEFT * turned_left), sensors.encoder_left);
    TEST_ASSERT_EQUAL_UINT32((uint32_t)(BOARD_ENCODER_SIGN_RIGHT * turned_right), sensors.encoder_right);
}

static void check_configured(const volatile struct stm32_tim *timer)
{
    TEST_ASSERT_EQUAL_HEX32(TIM_SMCR_SMS(3), timer->SMCR);
    CHECK_SET(TIM_CCMR1_CC1S(1) | TIM_CCMR1_CC2S(1), timer->CCMR1);
    TEST_ASSERT_NOT_EQUAL(0, timer->CCMR1 & TIM_CCMR1_IC1F(15));
    TEST_ASSERT_NOT_EQUAL(0, timer->CCMR1 & TIM_CCMR1_IC2F(15));
    TEST_ASSERT_EQUAL_HEX32(0xFFFF, timer->ARR);
    TEST_ASSERT_EQUAL_HEX32(0, timer->PSC);
    CHECK_SET(TIM_CR1_CEN, timer->CR1);
}

static void test_both_timers_count_every_edge(void)
{
    check_configured(&TIM4);
    check_configured(&TIM2);
    CHECK_SET(RCC_APB1ENR_TIM2EN | RCC_APB1ENR_TIM4EN, RCC.APB1ENR);
}

static void test_counts_begin_at_0(void)
{
    move(0, 0);
    TEST_ASSERT_EQUAL_UINT32(0, sensors.encoder_left);
    TEST_ASSERT_EQUAL_UINT32(0, sensors.encoder_right);
}

/* The wheels face each other: forward, one timer counts up and one down. */
static void test_counts_rise_forward(void)
{
    move(5 * BOARD_ENCODER_SIGN_LEFT, 7 * BOARD_ENCODER_SIGN_RIGHT);
    TEST_ASSERT_EQUAL_UINT32(5, sensors.encoder_left);
    TEST_ASSERT_EQUAL_UINT32(7, sensors.encoder_right);
}

static void test_every_position_of_the_timers(void)
{
    for (int i = 0; i < 66000; i++) {
        move(1, -1);
    }
    for (int i = 0; i < 67000; i++) {
        move(-1, 1);
    }
}

static void test_the_longest_way_between_two_reads(void)
{
    for (int i = 0; i < 1000; i++) {
        move(32767, -32767);
        move(i, -i);
    }
    for (int i = 0; i < 2000; i++) {
        move(-32768, -32768);
        move(-i, i);
    }
}

static void test_steps_of_every_size(void)
{
    for (int32_t step = -32768; step <= 32767; step++) {
        move(step, -1 - step);
    }
}

/* 2³² counts at 32 767 a read, both ways. */
static void test_counts_wrap(void)
{
    for (int i = 0; i < 132000; i++) {
        move(32767, 32767);
    }
    TEST_ASSERT_TRUE(turned_left > UINT32_MAX);
    for (int i = 0; i < 264000; i++) {
        move(-32767, -32767);
    }
    TEST_ASSERT_TRUE(turned_left < -(int64_t)UINT32_MAX);
}
