/* The clock tree: each way down from the crystal, limits of the data sheet, every wait that must end. */
#include "hal/stm32f4/clock.h"

#include "hal/stm32f4/board.h"
#include "tests/support/stm32_fake.h"

#include "unity.h"

void setUp(void)
{
    stm32_fake_reset();
}

void tearDown(void)
{
}

/* What the registers say, by the reference manual. */

static uint32_t pll_source_hz(void)
{
    return (RCC.PLLCFGR & RCC_PLLCFGR_PLLSRC) != 0U ? BOARD_CRYSTAL_HZ : 16000000U;
}

static uint32_t pll_input_hz(void)
{
    return pll_source_hz() / (RCC.PLLCFGR & 0x3FU);
}

static uint32_t vco_hz(void)
{
    return pll_input_hz() * ((RCC.PLLCFGR >> 6) & 0x1FFU);
}

static uint32_t core_hz(void)
{
    const bool from_pll = (RCC.CFGR & RCC_CFGR_SWS(3)) == RCC_CFGR_SWS(2);

    return from_pll ? vco_hz() / (2U * ((RCC.PLLCFGR >> 16) & 3U) + 2U) : 16000000U;
}

static uint32_t divider(uint32_t ppre)
{
    return ppre < 4U ? 1U : 2U << (ppre - 4U);
}

static uint32_t apb1_divider(void)
{
    return divider((RCC.CFGR >> 10) & 7U);
}

static uint32_t apb2_divider(void)
{
    return divider((RCC.CFGR >> 13) & 7U);
}

static void check_frequencies(enum jp_clock clock)
{
    const struct jp_clock_hz hz = jp_clock_frequencies(clock);
    const uint32_t apb1 = core_hz() / apb1_divider();
    const uint32_t apb2 = core_hz() / apb2_divider();

    TEST_ASSERT_EQUAL_UINT32(core_hz(), hz.core);
    TEST_ASSERT_EQUAL_UINT32(core_hz(), jp_clock_core_hz(clock));
    TEST_ASSERT_EQUAL_UINT32(apb1, hz.apb1);
    TEST_ASSERT_EQUAL_UINT32(apb2, hz.apb2);
    TEST_ASSERT_EQUAL_UINT32(apb1_divider() == 1U ? apb1 : 2U * apb1, hz.apb1_timers);
    TEST_ASSERT_EQUAL_UINT32(apb2_divider() == 1U ? apb2 : 2U * apb2, hz.apb2_timers);
    TEST_ASSERT_TRUE(apb1 <= 42000000U && apb2 <= 84000000U);
}

static void check_pll_is_within_limits(void)
{
    TEST_ASSERT_TRUE(pll_input_hz() >= 1000000U && pll_input_hz() <= 2000000U);
    TEST_ASSERT_TRUE(vco_hz() >= 100000000U && vco_hz() <= 432000000U);
    TEST_ASSERT_EQUAL_UINT32(48000000U, vco_hz() / ((RCC.PLLCFGR >> 24) & 0xFU));
    TEST_ASSERT_EQUAL_UINT32(168000000U, core_hz());
    TEST_ASSERT_FALSE(fake.fast_on_slow_flash);
    CHECK_SET(PWR_CR_VOS, PWR.CR);
    CHECK_SET(RCC_APB1ENR_PWREN, RCC.APB1ENR);
}

static void test_crystal(void)
{
    TEST_ASSERT_EQUAL_INT(JP_CLOCK_CRYSTAL, jp_clock_start());
    check_pll_is_within_limits();
    check_frequencies(JP_CLOCK_CRYSTAL);
    CHECK_SET(RCC_PLLCFGR_PLLSRC, RCC.PLLCFGR);
    CHECK_SET(FLASH_ACR_PRFTEN | FLASH_ACR_ICEN | FLASH_ACR_DCEN, FLASH.ACR);
}

static void test_only_the_crystal_is_watched(void)
{
    (void)jp_clock_start();
    CHECK_SET(RCC_CR_CSSON, RCC.CR);

    stm32_fake_reset();
    fake.crystal = FAKE_NEVER;
    (void)jp_clock_start();
    CHECK_CLEAR(RCC_CR_CSSON, RCC.CR);
}

static void test_without_a_crystal_the_internal_oscillator_drives_the_pll(void)
{
    fake.crystal = FAKE_NEVER;
    TEST_ASSERT_EQUAL_INT(JP_CLOCK_INTERNAL_PLL, jp_clock_start());
    check_pll_is_within_limits();
    check_frequencies(JP_CLOCK_INTERNAL_PLL);
    CHECK_CLEAR(RCC_PLLCFGR_PLLSRC, RCC.PLLCFGR);
    CHECK_CLEAR(RCC_CR_HSEON, RCC.CR);
}

static void test_a_pll_that_does_not_lock_on_the_crystal_may_on_the_internal_oscillator(void)
{
    fake.pll_on_crystal = FAKE_NEVER;
    TEST_ASSERT_EQUAL_INT(JP_CLOCK_INTERNAL_PLL, jp_clock_start());
    check_pll_is_within_limits();
    CHECK_CLEAR(RCC_CR_HSEON | RCC_CR_CSSON, RCC.CR);
}

static void check_internal(void)
{
    TEST_ASSERT_EQUAL_INT(JP_CLOCK_INTERNAL, jp_clock_start());
    check_frequencies(JP_CLOCK_INTERNAL);
    TEST_ASSERT_EQUAL_UINT32(16000000U, core_hz());
    TEST_ASSERT_EQUAL_HEX32(0, RCC.CFGR & RCC_CFGR_SW(3));
    CHECK_CLEAR(RCC_CR_HSEON | RCC_CR_PLLON | RCC_CR_CSSON, RCC.CR);
    TEST_ASSERT_FALSE(fake.fast_on_slow_flash);
}

static void test_without_a_pll(void)
{
    fake.crystal = FAKE_NEVER;
    fake.pll_on_internal = FAKE_NEVER;
    check_internal();
}

static void test_with_a_crystal_but_no_pll(void)
{
    fake.pll_on_crystal = FAKE_NEVER;
    fake.pll_on_internal = FAKE_NEVER;
    check_internal();
}

static void test_flash_that_does_not_slow_down_keeps_the_core_slow(void)
{
    fake.flash = FAKE_NEVER;
    check_internal();
}

static void test_without_the_switch_to_the_pll(void)
{
    fake.clock_switch = FAKE_NEVER;
    check_internal();
}

/* The longest is the crystal's: 100 ms at 16 MHz, and 6 to 10 cycles a poll. */
static void test_every_wait_ends(void)
{
    fake.crystal = FAKE_NEVER;
    fake.pll_on_crystal = FAKE_NEVER;
    fake.pll_on_internal = FAKE_NEVER;
    fake.flash = FAKE_NEVER;
    fake.clock_switch = FAKE_NEVER;
    TEST_ASSERT_EQUAL_INT(JP_CLOCK_INTERNAL, jp_clock_start());
    TEST_ASSERT_EQUAL_UINT(2, fake.failed_waits);
    TEST_ASSERT_TRUE(fake.longest_wait >= 100U * 16000U / 10U && fake.longest_wait <= 100U * 16000U / 6U);
    TEST_ASSERT_TRUE(fake.polls < 110U * 16000U / 6U);
}

/* A clock that is ready at the last poll counts, one poll later it does not. */
static void test_a_crystal_may_take_its_time(void)
{
    uint32_t limit;

    fake.crystal = FAKE_NEVER;
    (void)jp_clock_start();
    limit = fake.longest_wait;

    stm32_fake_reset();
    fake.crystal = limit;
    TEST_ASSERT_EQUAL_INT(JP_CLOCK_CRYSTAL, jp_clock_start());

    stm32_fake_reset();
    fake.crystal = limit + 1U;
    TEST_ASSERT_EQUAL_INT(JP_CLOCK_INTERNAL_PLL, jp_clock_start());
}

static void test_failure_of_the_crystal(void)
{
    TEST_ASSERT_FALSE(jp_clock_on_failure());
    TEST_ASSERT_EQUAL_HEX32(0, RCC.CIR);

    RCC.CIR = RCC_CIR_CSSF;
    TEST_ASSERT_TRUE(jp_clock_on_failure());
    CHECK_SET(RCC_CIR_CSSC, RCC.CIR);
}
