#include "hal/stm32f4/flash.h"

#include <stddef.h>

#include "hal/stm32f4/stm32f405.h"
#include "hal/stm32f4/wait.h"

#define FIRST_SECTOR 1U
#define PSIZE_WORD   2U

#define KEY1 0x45670123U
#define KEY2 0xCDEF89ABU

#define ERRORS (FLASH_SR_OPERR | FLASH_SR_WRPERR | FLASH_SR_PGAERR | FLASH_SR_PGPERR | FLASH_SR_PGSERR)

/* Reads of a register in the longest time of the data sheet, by a core at 168 MHz that its flash does not stop. */
#define POLLS_A_MILLISECOND (168000U / 4U)
#define PROGRAM_POLLS       (POLLS_A_MILLISECOND / 5U)    /* 100 µs, twice */
#define ERASE_POLLS         (1000U * POLLS_A_MILLISECOND) /* 500 ms, twice */

static uint32_t read_word(void *context, unsigned sector, uint32_t offset)
{
    (void)context;
    return firmware_store[sector][offset / 4U];
}

/** Ready for a command, without errors of earlier ones. */
static bool unlock(void)
{
    if (!jp_wait_for(&FLASH.SR, FLASH_SR_BSY, 0, ERASE_POLLS)) {
        return false;
    }
    if ((FLASH.CR & FLASH_CR_LOCK) != 0U) {
        FLASH.KEYR = KEY1;
        FLASH.KEYR = KEY2;
    }
    FLASH.SR = ERRORS;
    return (FLASH.CR & FLASH_CR_LOCK) == 0U;
}

/** The end of a command. */
static enum jp_status finish(uint32_t polls)
{
    const bool ended = jp_wait_for(&FLASH.SR, FLASH_SR_BSY, 0, polls);
    const bool erred = (FLASH.SR & ERRORS) != 0U;

    FLASH.CR = FLASH_CR_LOCK;
    return ended && !erred ? JP_OK : JP_ERR_HARDWARE;
}

static enum jp_status program_word(void *context, unsigned sector, uint32_t offset, uint32_t word)
{
    volatile uint32_t *place = &firmware_store[sector][offset / 4U];

    (void)context;
    if (!unlock()) {
        return JP_ERR_HARDWARE;
    }
    FLASH.CR = FLASH_CR_PSIZE(PSIZE_WORD) | FLASH_CR_PG;
    *place = word;
    /* Of the same bus: it comes after the write and waits for its end. */
    (void)*place;
    return finish(PROGRAM_POLLS);
}

/** The data cache keeps what it read before the erase, and can only be emptied while it is off. */
static void empty_data_cache(void)
{
    const uint32_t before = FLASH.ACR;

    FLASH.ACR = before & ~FLASH_ACR_DCEN;
    FLASH.ACR = (before & ~FLASH_ACR_DCEN) | FLASH_ACR_DCRST;
    FLASH.ACR = before & ~FLASH_ACR_DCEN;
    FLASH.ACR = before;
}

static enum jp_status erase_sector(void *context, unsigned sector)
{
    const uint32_t command = FLASH_CR_PSIZE(PSIZE_WORD) | FLASH_CR_SER | FLASH_CR_SNB(FIRST_SECTOR + sector);
    enum jp_status status;

    (void)context;
    if (!unlock()) {
        return JP_ERR_HARDWARE;
    }
    FLASH.CR = command;
    FLASH.CR = command | FLASH_CR_STRT;
    status = finish(ERASE_POLLS);
    empty_data_cache();
    return status;
}

struct jp_flash jp_flash_interface(void)
{
    return (struct jp_flash){
        .context = NULL,
        .sector_size = JP_FLASH_SECTOR_SIZE,
        .read = read_word,
        .program = program_word,
        .erase = erase_sector,
    };
}
