/** The instruction counter against blocks of known length. */
#include "tests/target/cycles.h"
#include "unity.h"

#ifdef __riscv
#define RETURN     "ret"
#define COUNT_DOWN "lw a0, 0(a0)\n 1: addi a0, a0, -1\n bnez a0, 1b\n ret"
#else
#define RETURN     "bx lr"
#define COUNT_DOWN ".syntax unified\n ldr r0, [r0]\n 1: subs r0, r0, #1\n bne 1b\n bx lr"
#endif

#define NOPS(n)                                                                                                        \
    __attribute__((naked)) static void nops_##n(void *argument)                                                        \
    {                                                                                                                  \
        (void)argument;                                                                                                \
        __asm__ volatile(".rept " #n "\n nop\n .endr\n " RETURN);                                                      \
    }

NOPS(0)
NOPS(1)
NOPS(7)
NOPS(100)
NOPS(1000)

void setUp(void)
{
}

void tearDown(void)
{
}

/** Two instructions a round, one for the load of the argument and the return. */
__attribute__((naked)) static void rounds(void *count)
{
    (void)count;
    __asm__ volatile(COUNT_DOWN);
}

static void test_counts_short_blocks(void)
{
    TEST_ASSERT_EQUAL_UINT32(1, target_count_instructions(nops_0, NULL));
    TEST_ASSERT_EQUAL_UINT32(2, target_count_instructions(nops_1, NULL));
    TEST_ASSERT_EQUAL_UINT32(8, target_count_instructions(nops_7, NULL));
}

static void test_counts_long_blocks(void)
{
    TEST_ASSERT_EQUAL_UINT32(101, target_count_instructions(nops_100, NULL));
    TEST_ASSERT_EQUAL_UINT32(1001, target_count_instructions(nops_1000, NULL));
}

static void test_counts_loops(void)
{
    uint32_t count = 10000;

    TEST_ASSERT_EQUAL_UINT32(20002, target_count_instructions(rounds, &count));
    count = 500000;
    TEST_ASSERT_UINT32_WITHIN(2, 1000002, target_count_instructions(rounds, &count));
}

static void test_keeps_the_worst(void)
{
    TEST_ASSERT_EQUAL_UINT32(101, target_count_worst(0, nops_100, NULL));
    TEST_ASSERT_EQUAL_UINT32(101, target_count_worst(100, nops_100, NULL));
    TEST_ASSERT_EQUAL_UINT32(102, target_count_worst(102, nops_100, NULL));
    TEST_ASSERT_EQUAL_UINT32(1000, target_count_worst(1000, nops_100, NULL));
    TEST_ASSERT_EQUAL_UINT32(1001, target_count_worst(1000, nops_1000, NULL));
}

#ifndef __riscv
static void test_reports_a_counter_that_ran_out(void)
{
    uint32_t count = 10000000;

    TEST_ASSERT_EQUAL_UINT32(TARGET_COUNT_OVERFLOW, target_count_instructions(rounds, &count));
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_counts_short_blocks);
    RUN_TEST(test_counts_long_blocks);
    RUN_TEST(test_counts_loops);
    RUN_TEST(test_keeps_the_worst);
#ifndef __riscv
    RUN_TEST(test_reports_a_counter_that_ran_out);
#endif
    return UNITY_END();
}
