/** Watchdog, and why the core has started. */
#ifndef JOULEPATH_HAL_MPS2_SUPERVISION_H
#define JOULEPATH_HAL_MPS2_SUPERVISION_H

#include "hal/storage/post_mortem.h"

/** Until the watchdog's NMI, and as long again until its reset. The bridges are on the bus and go off by themselves
 *  after 40 ms without a command. */
#define JP_WATCHDOG_MS 50U

void jp_watchdog_start(void);
void jp_watchdog_feed(void);

/** Once, before jp_post_mortem_open(). The board has no register of it that every emulation has: memory that outlives a
 *  reset tells whether the program was running, and its record whether it knew of its end. */
enum jp_reset_cause jp_reset_cause(const struct jp_post_mortem *record);

#endif
