#include "hal/stm32f4/clock.h"

#include "hal/stm32f4/board.h"
#include "hal/stm32f4/stm32f405.h"
#include "hal/stm32f4/wait.h"

#define HSI_HZ       16000000U
#define CORE_HZ      168000000U
#define PLL_INPUT_HZ 2000000U /* of 1…2 MHz: the more, the less jitter */
#define PLL_HZ       (2U * CORE_HZ)
#define USB_HZ       48000000U

_Static_assert(BOARD_CRYSTAL_HZ % PLL_INPUT_HZ == 0U && BOARD_CRYSTAL_HZ >= 4000000U && BOARD_CRYSTAL_HZ <= 26000000U,
               "the crystal must be a multiple of 2 MHz from 4 to 26 MHz");

/* Reads of a register, by the core at 16 MHz: 6 cycles at least. */
#define POLLS_A_MILLISECOND (HSI_HZ / 1000U / 6U)
#define CRYSTAL_POLLS       (100U * POLLS_A_MILLISECOND) /* some 2 ms are usual */
#define PLL_POLLS           POLLS_A_MILLISECOND          /* 0.3 ms at most */
#define SWITCH_POLLS        POLLS_A_MILLISECOND

/* Fields of the registers. */
#define PLLP_2          0U
#define SW_HSI          0U
#define SW_PLL          2U
#define SW_MASK         3U
#define LATENCY_168_MHZ 5U /* wait states from 2.7 V */
#define LATENCY_MASK    7U
#define PPRE_2          4U
#define PPRE_4          5U

static bool crystal_starts(void)
{
    RCC.CR |= RCC_CR_HSEON;
    if (jp_wait_for(&RCC.CR, RCC_CR_HSERDY, RCC_CR_HSERDY, CRYSTAL_POLLS)) {
        return true;
    }
    RCC.CR &= ~RCC_CR_HSEON;
    return false;
}

/** False: it is off again. */
static bool pll_starts(uint32_t source, uint32_t source_hz)
{
    RCC.PLLCFGR = source | RCC_PLLCFGR_PLLM(source_hz / PLL_INPUT_HZ) | RCC_PLLCFGR_PLLN(PLL_HZ / PLL_INPUT_HZ) |
                  RCC_PLLCFGR_PLLP(PLLP_2) | RCC_PLLCFGR_PLLQ(PLL_HZ / USB_HZ);
    RCC.CR |= RCC_CR_PLLON;
    if (jp_wait_for(&RCC.CR, RCC_CR_PLLRDY, RCC_CR_PLLRDY, PLL_POLLS)) {
        return true;
    }
    RCC.CR &= ~RCC_CR_PLLON;
    (void)jp_wait_for(&RCC.CR, RCC_CR_PLLRDY, 0, PLL_POLLS);
    return false;
}

/** The flash must be slow enough before the core becomes fast. */
static bool flash_is_ready(void)
{
    FLASH.ACR = FLASH_ACR_LATENCY(LATENCY_168_MHZ) | FLASH_ACR_PRFTEN | FLASH_ACR_ICEN | FLASH_ACR_DCEN;
    return jp_wait_for(&FLASH.ACR, FLASH_ACR_LATENCY(LATENCY_MASK), FLASH_ACR_LATENCY(LATENCY_168_MHZ), SWITCH_POLLS);
}

/** False: the core runs from the internal oscillator, and the PLL is off. */
static bool runs_from_pll(uint32_t source, uint32_t source_hz)
{
    if (!pll_starts(source, source_hz)) {
        return false;
    }
    RCC.CFGR = RCC_CFGR_PPRE1(PPRE_4) | RCC_CFGR_PPRE2(PPRE_2);
    if (flash_is_ready()) {
        RCC.CFGR |= RCC_CFGR_SW(SW_PLL);
        if (jp_wait_for(&RCC.CFGR, RCC_CFGR_SWS(SW_MASK), RCC_CFGR_SWS(SW_PLL), SWITCH_POLLS)) {
            return true;
        }
    }
    RCC.CFGR = RCC_CFGR_SW(SW_HSI);
    (void)jp_wait_for(&RCC.CFGR, RCC_CFGR_SWS(SW_MASK), RCC_CFGR_SWS(SW_HSI), SWITCH_POLLS);
    RCC.CR &= ~RCC_CR_PLLON;
    (void)jp_wait_for(&RCC.CR, RCC_CR_PLLRDY, 0, PLL_POLLS);
    return false;
}

enum jp_clock jp_clock_start(void)
{
    RCC.APB1ENR |= RCC_APB1ENR_PWREN;
    PWR.CR |= PWR_CR_VOS; /* the regulator's scale for more than 144 MHz */
    if (crystal_starts()) {
        if (runs_from_pll(RCC_PLLCFGR_PLLSRC, BOARD_CRYSTAL_HZ)) {
            RCC.CR |= RCC_CR_CSSON;
            return JP_CLOCK_CRYSTAL;
        }
        RCC.CR &= ~RCC_CR_HSEON;
    }
    return runs_from_pll(0, HSI_HZ) ? JP_CLOCK_INTERNAL_PLL : JP_CLOCK_INTERNAL;
}

struct jp_clock_hz jp_clock_frequencies(enum jp_clock clock)
{
    if (clock == JP_CLOCK_INTERNAL) {
        return (struct jp_clock_hz){
            .core = HSI_HZ, .apb1 = HSI_HZ, .apb2 = HSI_HZ, .apb1_timers = HSI_HZ, .apb2_timers = HSI_HZ};
    }
    /* Timers get twice the frequency of a bus that is divided. */
    return (struct jp_clock_hz){.core = CORE_HZ,
                                .apb1 = CORE_HZ / 4U,
                                .apb2 = CORE_HZ / 2U,
                                .apb1_timers = CORE_HZ / 2U,
                                .apb2_timers = CORE_HZ};
}

uint32_t jp_clock_core_hz(enum jp_clock clock)
{
    return jp_clock_frequencies(clock).core;
}

bool jp_clock_on_failure(void)
{
    if ((RCC.CIR & RCC_CIR_CSSF) == 0U) {
        return false;
    }
    RCC.CIR |= RCC_CIR_CSSC;
    return true;
}
