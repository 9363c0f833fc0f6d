#include "hal/stm32f4/supervision.h"

#include "hal/stm32f4/stm32f405.h"
#include "hal/stm32f4/wait.h"

/** Keys of IWDG_KR. */
#define KEY_UNLOCK 0x5555U
#define KEY_FEED   0xAAAAU
#define KEY_START  0xCCCCU

/** The watchdog's oscillator, nominal, and its smallest prescalers: 4 and 64. */
#define OSCILLATOR_HZ 32000U
#define PRESCALER_4   0U
#define PRESCALER_64  4U

/** Highest threshold of the detector: 2.9 V. */
#define DETECTOR_LEVEL 7U

enum jp_reset_cause jp_reset_cause(void)
{
    const uint32_t flags = RCC.CSR;

    RCC.CSR |= RCC_CSR_RMVF;
    /* Power-on sets the flags of brown-out and pin too, and every reset that of the pin. */
    if ((flags & RCC_CSR_PORRSTF) != 0U) {
        return JP_RESET_POWER_ON;
    }
    if ((flags & RCC_CSR_BORRSTF) != 0U) {
        return JP_RESET_BROWN_OUT;
    }
    if ((flags & (RCC_CSR_WDGRSTF | RCC_CSR_WWDGRSTF)) != 0U) {
        return JP_RESET_WATCHDOG;
    }
    return (flags & (RCC_CSR_SFTRSTF | RCC_CSR_PADRSTF)) == RCC_CSR_PADRSTF ? JP_RESET_PIN : JP_RESET_SOFTWARE;
}

/** The last change takes at most 5 periods of a slow oscillator to get there: 0.3 ms. */
#define UPDATE_POLLS 12000U

static void set_time(uint32_t prescaler_code, uint32_t divider, uint32_t milliseconds)
{
    (void)jp_wait_for(&IWDG.SR, IWDG_SR_PVU | IWDG_SR_RVU, 0, UPDATE_POLLS);
    IWDG.KR = KEY_UNLOCK;
    IWDG.PR = prescaler_code;
    IWDG.RLR = OSCILLATOR_HZ / divider * milliseconds / 1000U;
}

void jp_watchdog_start(uint32_t tick_rate)
{
    IWDG.KR = KEY_START;
    jp_watchdog_tighten(tick_rate);
}

void jp_watchdog_feed(void)
{
    IWDG.KR = KEY_FEED;
}

void jp_watchdog_relax(void)
{
    set_time(PRESCALER_64, 64, 2U * JP_WATCHDOG_ERASE_MS);
    jp_watchdog_feed();
}

void jp_watchdog_tighten(uint32_t tick_rate)
{
    set_time(PRESCALER_4, 4, JP_WATCHDOG_TICKS * 1000U / tick_rate);
    jp_watchdog_feed();
}

void jp_supply_watch(void)
{
    RCC.APB1ENR |= RCC_APB1ENR_PWREN;
    PWR.CR |= PWR_CR_PLS(DETECTOR_LEVEL) | PWR_CR_PVDE;
    EXTI.RTSR |= EXTI_LINE_SUPPLY;
    EXTI.IMR |= EXTI_LINE_SUPPLY;
}

bool jp_supply_is_low(void)
{
    return (PWR.CSR & PWR_CSR_PVDO) != 0U;
}
