/* Waiting with an end. The source itself is included: in the library a fake stands in for it. */
#include "hal/stm32f4/wait.c"

#include "unity.h"

static uint32_t now;
static uint32_t step;
static uint32_t reads;

/* Stands in for the timer's: time passes by being asked for. */
uint32_t jp_timer_us(void)
{
    reads++;
    now += step;
    return now;
}

void setUp(void)
{
    now = 0;
    step = 1;
    reads = 0;
}

void tearDown(void)
{
}

static void test_only_the_bits_of_the_mask_count(void)
{
    const volatile uint32_t reg = 0xF0F2;

    TEST_ASSERT_TRUE(jp_wait_for(&reg, 0x2, 0x2, 1));
    TEST_ASSERT_TRUE(jp_wait_for(&reg, 0xF, 0x2, 1));
    TEST_ASSERT_TRUE(jp_wait_for(&reg, 0x1, 0, 1));
    TEST_ASSERT_FALSE(jp_wait_for(&reg, 0x3, 0x3, 1));
    TEST_ASSERT_FALSE(jp_wait_for(&reg, 0x2, 0, 1));
}

static void test_a_register_that_never_changes_ends_the_wait(void)
{
    const volatile uint32_t reg = 0;

    TEST_ASSERT_FALSE(jp_wait_for(&reg, 1, 1, 0));
    TEST_ASSERT_FALSE(jp_wait_for(&reg, 1, 1, 1));
    TEST_ASSERT_FALSE(jp_wait_for(&reg, 1, 1, 100000));
}

static void check_waits_for(uint32_t us)
{
    const uint32_t start = now;

    reads = 0;
    jp_wait_us(us);
    TEST_ASSERT_TRUE(now - start > us);
}

static void test_time_passes(void)
{
    check_waits_for(1);
    check_waits_for(10);
    check_waits_for(1000);
    step = 7;
    check_waits_for(100);
}

static void test_time_may_wrap(void)
{
    now = UINT32_MAX - 5U;
    check_waits_for(10);
    TEST_ASSERT_TRUE(now < 10U);
}

/* Not a microsecond less, whatever part of the first one was over. */
static void test_no_wait_is_too_short(void)
{
    jp_wait_us(10);
    TEST_ASSERT_EQUAL_UINT32(12, reads);
}

static void test_a_clock_that_stands_ends_the_wait(void)
{
    step = 0;
    jp_wait_us(1000);
    TEST_ASSERT_UINT32_WITHIN(1, 1000U * 64U, reads);
}
