/* Watchdog, reset causes and the supply's detector against registers in memory. */
#include "hal/stm32f4/supervision.h"

#include "tests/support/stm32_fake.h"
#include "unity.h"

void setUp(void)
{
    stm32_fake_reset();
}

void tearDown(void)
{
}

static enum jp_reset_cause cause_of(uint32_t flags)
{
    RCC.CSR = flags;
    return jp_reset_cause();
}

static void test_every_reset_has_its_cause(void)
{
    const uint32_t pin = RCC_CSR_PADRSTF;

    /* RM0090, 6.3.21: power-on sets brown-out and pin too, each internal reset the pin. */
    TEST_ASSERT_EQUAL_INT(JP_RESET_POWER_ON, cause_of(RCC_CSR_PORRSTF | RCC_CSR_BORRSTF | pin));
    TEST_ASSERT_EQUAL_INT(JP_RESET_BROWN_OUT, cause_of(RCC_CSR_BORRSTF | pin));
    TEST_ASSERT_EQUAL_INT(JP_RESET_WATCHDOG, cause_of(RCC_CSR_WDGRSTF | pin));
    TEST_ASSERT_EQUAL_INT(JP_RESET_WATCHDOG, cause_of(RCC_CSR_WWDGRSTF | pin));
    TEST_ASSERT_EQUAL_INT(JP_RESET_SOFTWARE, cause_of(RCC_CSR_SFTRSTF | pin));
    TEST_ASSERT_EQUAL_INT(JP_RESET_PIN, cause_of(pin));
    TEST_ASSERT_EQUAL_INT(JP_RESET_SOFTWARE, cause_of(0));
}

static void test_the_flags_are_cleared_for_the_next_reset(void)
{
    (void)cause_of(RCC_CSR_PADRSTF);
    TEST_ASSERT_BITS_HIGH(RCC_CSR_RMVF, RCC.CSR);
}

/** From prescaler and reload at the slowest and fastest oscillator (17 and 47 kHz), µs. */
static uint64_t time_us(uint32_t oscillator_hz)
{
    return ((uint64_t)IWDG.RLR * (4ULL << IWDG.PR) * 1000000U) / oscillator_hz;
}

static void test_the_watchdog_is_started_and_fed(void)
{
    jp_watchdog_start(1000);
    TEST_ASSERT_EQUAL_HEX32(0xAAAA, IWDG.KR);
    TEST_ASSERT_EQUAL_UINT64(1000U * JP_WATCHDOG_TICKS, time_us(32000));
    IWDG.KR = 0;
    jp_watchdog_feed();
    TEST_ASSERT_EQUAL_HEX32(0xAAAA, IWDG.KR);
}

static void test_an_unfed_tick_is_noticed_before_the_robot_has_fallen(void)
{
    jp_watchdog_start(1000);
    TEST_ASSERT_TRUE(time_us(17000) < 20000);
    TEST_ASSERT_TRUE(time_us(47000) > 5000);
}

static void test_slower_ticks_leave_as_many(void)
{
    static const uint32_t rates[] = {100, 200, 500};

    for (unsigned i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        jp_watchdog_start(rates[i]);
        TEST_ASSERT_TRUE(IWDG.RLR <= 0xFFF);
        TEST_ASSERT_EQUAL_UINT64(1000000U / rates[i] * JP_WATCHDOG_TICKS, time_us(32000));
    }
}

static void test_the_fastest_oscillator_leaves_time_for_an_erase(void)
{
    jp_watchdog_start(1000);
    jp_watchdog_relax();
    TEST_ASSERT_TRUE(IWDG.RLR <= 0xFFF);
    TEST_ASSERT_TRUE(time_us(47000) > 1000U * JP_WATCHDOG_ERASE_MS);
    TEST_ASSERT_EQUAL_HEX32(0xAAAA, IWDG.KR);
    jp_watchdog_tighten(1000);
    TEST_ASSERT_EQUAL_UINT64(1000U * JP_WATCHDOG_TICKS, time_us(32000));
}

static void test_the_supply_is_watched(void)
{
    jp_supply_watch();
    TEST_ASSERT_BITS_HIGH(RCC_APB1ENR_PWREN, RCC.APB1ENR);
    TEST_ASSERT_BITS_HIGH(PWR_CR_PVDE | PWR_CR_PLS(7), PWR.CR);
    /* PVDO rises when the supply falls. */
    TEST_ASSERT_BITS_HIGH(EXTI_LINE_SUPPLY, EXTI.RTSR);
    TEST_ASSERT_BITS_HIGH(EXTI_LINE_SUPPLY, EXTI.IMR);
    TEST_ASSERT_FALSE(jp_supply_is_low());
    PWR.CSR = PWR_CSR_PVDO;
    TEST_ASSERT_TRUE(jp_supply_is_low());
}
