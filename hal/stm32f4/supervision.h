/** What watches the program and its supply: reset cause, independent watchdog, voltage detector. */
#ifndef JOULEPATH_HAL_STM32F4_SUPERVISION_H
#define JOULEPATH_HAL_STM32F4_SUPERVISION_H

#include "hal/storage/post_mortem.h"

/** The watchdog resets when it was not fed for so many ticks; −32…+88 % by the tolerance of its oscillator (17…47 kHz).
 */
#define JP_WATCHDOG_TICKS 10U

/** Longest erase of a sector of 16 KiB, ms; code in flash stands still meanwhile. */
#define JP_WATCHDOG_ERASE_MS 800U

/** Why the controller was reset, as its flags say, which are cleared. No flag: JP_RESET_SOFTWARE. Once after a reset.
 */
enum jp_reset_cause jp_reset_cause(void);

/** From now on the watchdog must be fed, at ticks of this rate, Hz, 100…1 000; nothing but a reset ends it. */
void jp_watchdog_start(uint32_t tick_rate);

void jp_watchdog_feed(void);

/** Before an erase: the time to feed it in is JP_WATCHDOG_ERASE_MS. */
void jp_watchdog_relax(void);

/** After it: JP_WATCHDOG_TICKS again. */
void jp_watchdog_tighten(uint32_t tick_rate);

/** From now on a supply below 2.9 V pends the interrupt of the voltage detector. */
void jp_supply_watch(void);

/** True: the supply is below the threshold. */
bool jp_supply_is_low(void);

#endif
