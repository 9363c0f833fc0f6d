/** The clock tree: 168 MHz from the crystal or, where that does not start, from the internal oscillator. */
#ifndef JOULEPATH_HAL_STM32F4_CLOCK_H
#define JOULEPATH_HAL_STM32F4_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

enum jp_clock {
    JP_CLOCK_CRYSTAL,      /**< crystal and PLL: 168 MHz, exact enough for CAN */
    JP_CLOCK_INTERNAL_PLL, /**< internal oscillator and PLL: 168 MHz ± 1 % at 25 °C */
    JP_CLOCK_INTERNAL      /**< internal oscillator: 16 MHz ± 1 % at 25 °C */
};

/** Frequencies of the buses, Hz. */
struct jp_clock_hz {
    uint32_t core;
    uint32_t apb1;
    uint32_t apb2;
    uint32_t apb1_timers; /**< TIM2 to TIM5 */
    uint32_t apb2_timers; /**< TIM1, TIM8 */
};

/**
 * Starts the best clock that there is, with the flash's wait states for it, and returns which. After a reset, before
 * anything else; each wait ends, the longest (for the crystal) after 100 ms. While the crystal is the clock, the clock
 * security system watches it: see jp_clock_on_failure(). Not for ISRs.
 */
enum jp_clock jp_clock_start(void);

/** Frequencies under that clock. Constant time. */
struct jp_clock_hz jp_clock_frequencies(enum jp_clock clock);

/** The core's frequency, Hz. */
uint32_t jp_clock_core_hz(enum jp_clock clock);

/** Of the NMI's handler. True: the crystal has failed and the core runs at 16 MHz now, so that nothing else has the
 *  frequency it was started for: bridges off and a reset, which starts the internal clock. False: another NMI. */
bool jp_clock_on_failure(void);

#endif
