/**
 * Flash for the store: sectors 1 and 2 of the STM32F405, 16 KiB each (64 records), between the vectors in sector 0 and
 * the code from sector 3 on; stm32f405.ld keeps them free.
 *
 * Of all sectors these are erased soonest, in 0.25 s, at most 0.5 s at 2.7…3.6 V. For as long the core stands still, as
 * its code is in the same flash: motors off, and a watchdog of more than 0.5 s. A word takes 16 µs, at most 100 µs.
 * Each sector stands 10 000 erases: more than 10⁶ records. An image as .bin covers these sectors and takes the
 * parameters with it, as .elf or .hex it does not.
 */
#ifndef JOULEPATH_HAL_STM32F4_FLASH_H
#define JOULEPATH_HAL_STM32F4_FLASH_H

#include "hal/storage/store.h"

#define JP_FLASH_SECTOR_SIZE 16384U /* bytes */

/** Where the sectors are: the linker's. */
extern volatile uint32_t firmware_store[2][JP_FLASH_SECTOR_SIZE / 4U];

/** There is one flash; the clock must run. Not for ISRs. */
struct jp_flash jp_flash_interface(void);

#endif
