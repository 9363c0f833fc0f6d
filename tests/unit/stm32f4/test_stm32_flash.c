/*
 * The driver of the STM32F405's flash, against a controller as the reference manual (RM0090 §3) describes it: keys, the
 * lock, one command at a time, bits that only become 0, error flags, a busy flag that may stay. The driver's source is
 * included so that the controller sees each access to its registers.
 */
#include <string.h>

#include "hal/stm32f4/flash.h"
#include "hal/stm32f4/stm32f405.h"
#include "hal/stm32f4/wait.h"
#include "unity.h"

/* As many as RAM of small targets has. */
#define MODEL_WORDS (2U * JP_STORE_SLOT_WORDS)

static volatile struct stm32_flash *controller(void);
static volatile uint32_t (*memory(void))[MODEL_WORDS];

#define FLASH          (*controller())
#define firmware_store (memory())
#include "hal/stm32f4/flash.c"
#undef FLASH
#undef firmware_store

#define NEVER      UINT32_MAX
#define SHOWN      (1U << 31) /* in SR and KEYR, where the driver writes no 1: tells a write from none */
#define ALL_ERRORS 0xF2U

static struct {
    volatile struct stm32_flash registers;
    volatile uint32_t memory[2][MODEL_WORDS];
    uint32_t firm[2][MODEL_WORDS]; /* the memory before the driver's last access */
    uint32_t shown_cr;
    uint32_t errors; /* of SR */
    uint32_t last_key;
    bool locked;
    bool shut;     /* after a wrong key, until reset */
    uint32_t busy; /* polls left */
    uint32_t command_polls;
    uint32_t next_errors; /* of the next command */
    unsigned programs;
    unsigned erases;
    unsigned cache_resets;
    uint32_t longest_wait;
    const char *misuse;
} model;

static struct jp_flash flash;

static void show(void)
{
    model.registers.SR = SHOWN | model.errors | (model.busy > 0U ? FLASH_SR_BSY : 0U);
    model.registers.KEYR = SHOWN;
    model.registers.CR = (model.registers.CR & ~(FLASH_CR_LOCK | FLASH_CR_STRT)) | (model.locked ? FLASH_CR_LOCK : 0U);
    model.shown_cr = model.registers.CR;
}

void setUp(void)
{
    memset(&model, 0, sizeof model);
    model.locked = true;
    model.command_polls = 3;
    memset((void *)(uintptr_t)model.memory, 0xFF, sizeof model.memory);
    memset(model.firm, 0xFF, sizeof model.firm);
    model.registers.ACR = FLASH_ACR_DCEN | FLASH_ACR_ICEN | FLASH_ACR_LATENCY(5);
    show();
    flash = jp_flash_interface();
}

void tearDown(void)
{
    TEST_ASSERT_NULL_MESSAGE(model.misuse, model.misuse);
}

/* ---- The controller ---- */

static void misuse(const char *what)
{
    model.misuse = model.misuse == NULL ? what : model.misuse;
}

static void begin_command(void)
{
    if (model.busy > 0U) {
        misuse("a command while another one runs");
    }
    if ((model.registers.CR & FLASH_CR_PSIZE(3)) != FLASH_CR_PSIZE(2)) {
        misuse("not 32 bits wide");
    }
    model.busy = model.command_polls;
    model.errors |= model.next_errors;
}

static void take_key(uint32_t key)
{
    const bool right = !model.shut && key == (model.last_key == 0x45670123U ? 0xCDEF89ABU : 0x45670123U);

    model.shut = !right;
    model.locked = !(right && model.last_key == 0x45670123U);
    model.last_key = key;
}

static void erase(uint32_t number)
{
    begin_command();
    if (number < 1U || number > 2U) {
        misuse("the erase of a sector that holds the program");
        return;
    }
    model.erases++;
    if (model.next_errors == 0U) {
        memset((void *)(uintptr_t)model.memory[number - 1U], 0xFF, sizeof model.memory[0]);
        memset(model.firm[number - 1U], 0xFF, sizeof model.firm[0]);
    }
}

static void take_command(void)
{
    const uint32_t cr = model.registers.CR;

    if (model.locked) {
        if ((cr & ~FLASH_CR_LOCK) != 0U) {
            misuse("a command to a locked controller");
        }
        model.registers.CR = 0;
        return;
    }
    model.locked = (cr & FLASH_CR_LOCK) != 0U;
    model.last_key = model.locked ? 0 : model.last_key;
    if ((cr & FLASH_CR_STRT) != 0U) {
        if ((cr & (FLASH_CR_SER | FLASH_CR_MER | FLASH_CR_PG)) != FLASH_CR_SER) {
            misuse("STRT without the erase of a sector");
        } else {
            erase(cr >> 3 & 0x0FU);
        }
    }
}

static void take_word(volatile uint32_t *word, uint32_t *firm)
{
    if (*word == *firm) {
        return;
    }
    if (model.locked || (model.registers.CR & (FLASH_CR_PG | FLASH_CR_SER)) != FLASH_CR_PG) {
        misuse("a write without PG");
        *word = *firm;
        return;
    }
    begin_command();
    model.programs++;
    *firm &= model.next_errors == 0U ? *word : NEVER;
    *word = *firm;
}

static void watch_cache(void)
{
    const uint32_t acr = model.registers.ACR;

    if ((acr & FLASH_ACR_DCRST) != 0U) {
        model.cache_resets++;
        if ((acr & FLASH_ACR_DCEN) != 0U) {
            misuse("a reset of the data cache while it is on");
        }
    }
}

/* What the driver wrote since its last access. */
static void react(void)
{
    watch_cache();
    if (model.registers.SR != (SHOWN | model.errors | (model.busy > 0U ? FLASH_SR_BSY : 0U))) {
        model.errors &= ~model.registers.SR; /* cleared by writing 1 */
    }
    if (model.registers.KEYR != SHOWN) {
        take_key(model.registers.KEYR);
    }
    if (model.registers.CR != model.shown_cr) {
        take_command();
    }
    for (unsigned sector = 0; sector < 2U; sector++) {
        for (size_t i = 0; i < MODEL_WORDS; i++) {
            take_word(&model.memory[sector][i], &model.firm[sector][i]);
        }
    }
    show();
}

static volatile struct stm32_flash *controller(void)
{
    react();
    return &model.registers;
}

static volatile uint32_t (*memory(void))[MODEL_WORDS]
{
    react();
    return model.memory;
}

/* In the place of wait.c. */
bool jp_wait_for(const volatile uint32_t *reg, uint32_t mask, uint32_t value, uint32_t polls)
{
    react();
    model.longest_wait = polls > model.longest_wait ? polls : model.longest_wait;
    if (model.busy <= polls && model.busy != NEVER) {
        model.busy = 0;
        show();
    }
    return (*reg & mask) == value;
}

void jp_wait_us(uint32_t us)
{
    (void)us;
    TEST_FAIL_MESSAGE("the driver waits by polls");
}

/* ---- Tests ---- */

static void test_words_are_programmed_and_read(void)
{
    for (unsigned sector = 0; sector < 2U; sector++) {
        for (uint32_t offset = 0; offset < 4U * MODEL_WORDS; offset += 4U) {
            const uint32_t word = 0x9E3779B9U * (offset + sector + 1U);

            TEST_ASSERT_EQUAL_INT(JP_OK, flash.program(flash.context, sector, offset, word));
            TEST_ASSERT_EQUAL_HEX32(word, flash.read(flash.context, sector, offset));
            TEST_ASSERT_EQUAL_HEX32(word, model.firm[sector][offset / 4U]);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(2U * MODEL_WORDS, model.programs);
}

static void test_programming_only_clears_bits(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, flash.program(flash.context, 1, 8, 0x0FF0FF00U));
    TEST_ASSERT_EQUAL_INT(JP_OK, flash.program(flash.context, 1, 8, 0x00FFFFF0U));
    TEST_ASSERT_EQUAL_HEX32(0x00F0FF00U, flash.read(flash.context, 1, 8));
}

static void test_the_sector_asked_for_is_erased(void)
{
    for (unsigned sector = 0; sector < 2U; sector++) {
        setUp();
        TEST_ASSERT_EQUAL_INT(JP_OK, flash.program(flash.context, 0, 0, 0x12345678U));
        TEST_ASSERT_EQUAL_INT(JP_OK, flash.program(flash.context, 1, 0, 0x12345678U));
        TEST_ASSERT_EQUAL_INT(JP_OK, flash.erase(flash.context, sector));
        TEST_ASSERT_EQUAL_UINT32(1, model.erases);
        TEST_ASSERT_EQUAL_HEX32(0xFFFFFFFFU, flash.read(flash.context, sector, 0));
        TEST_ASSERT_EQUAL_HEX32(0x12345678U, flash.read(flash.context, 1U - sector, 0));
        tearDown();
    }
}

static void test_the_controller_is_locked_between_commands(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, flash.program(flash.context, 0, 0, 1));
    react();
    TEST_ASSERT_TRUE(model.locked);
    TEST_ASSERT_EQUAL_INT(JP_OK, flash.erase(flash.context, 0));
    react();
    TEST_ASSERT_TRUE(model.locked);
    TEST_ASSERT_EQUAL_HEX32(FLASH_CR_LOCK, model.registers.CR);
}

static void test_an_unlocked_controller_is_used_as_it_is(void)
{
    model.locked = false;
    show();
    TEST_ASSERT_EQUAL_INT(JP_OK, flash.program(flash.context, 0, 0, 1));
    TEST_ASSERT_FALSE(model.shut);
}

static void test_an_erase_empties_the_data_cache(void)
{
    const uint32_t before = model.registers.ACR;

    TEST_ASSERT_EQUAL_INT(JP_OK, flash.program(flash.context, 0, 0, 1));
    TEST_ASSERT_EQUAL_UINT32(0, model.cache_resets);
    TEST_ASSERT_EQUAL_INT(JP_OK, flash.erase(flash.context, 0));
    react();
    TEST_ASSERT_TRUE(model.cache_resets > 0U);
    TEST_ASSERT_EQUAL_HEX32(before, model.registers.ACR);
}

static void test_each_error_is_reported_and_forgotten(void)
{
    for (uint32_t error = 1; error <= FLASH_SR_PGSERR; error <<= 1) {
        if ((error & ALL_ERRORS) == 0U) {
            continue;
        }
        model.next_errors = error;
        TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, flash.program(flash.context, 0, 0, 1));
        TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, flash.erase(flash.context, 1));
        react();
        TEST_ASSERT_TRUE(model.locked);
        model.next_errors = 0;
        TEST_ASSERT_EQUAL_INT(JP_OK, flash.program(flash.context, 0, 4, error));
        TEST_ASSERT_EQUAL_INT(JP_OK, flash.erase(flash.context, 1));
    }
}

static void test_a_controller_that_stays_busy_is_an_error(void)
{
    model.command_polls = NEVER;
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, flash.program(flash.context, 0, 0, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, flash.program(flash.context, 0, 4, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, flash.erase(flash.context, 0));
    TEST_ASSERT_EQUAL_UINT32(1, model.programs);
    TEST_ASSERT_EQUAL_UINT32(0, model.erases);
}

/* At 168 MHz with 4 cycles a poll; at 10 it is the double and more. */
static void test_waits_are_long_enough_and_end(void)
{
    model.command_polls = 168U * 100U / 4U;
    TEST_ASSERT_EQUAL_INT(JP_OK, flash.program(flash.context, 0, 0, 1));
    model.command_polls = 168U * 500000U / 4U;
    TEST_ASSERT_EQUAL_INT(JP_OK, flash.erase(flash.context, 0));
    TEST_ASSERT_TRUE(model.longest_wait <= 2U * 168U * 500000U / 4U);
}

static void test_an_earlier_command_is_waited_for(void)
{
    model.busy = 1000;
    show();
    TEST_ASSERT_EQUAL_INT(JP_OK, flash.program(flash.context, 0, 0, 1));
    TEST_ASSERT_EQUAL_UINT32(1, model.programs);
}

static void test_a_controller_shut_by_a_wrong_key_is_an_error(void)
{
    model.shut = true;
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, flash.program(flash.context, 0, 0, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, flash.erase(flash.context, 0));
    TEST_ASSERT_EQUAL_UINT32(0, model.programs);
}

static void test_the_store_stands_on_it(void)
{
    struct jp_store store;
    const uint8_t *record = NULL;
    uint16_t length = 0;

    TEST_ASSERT_EQUAL_UINT32(16384, flash.sector_size);
    flash.sector_size = 4U * MODEL_WORDS;
    TEST_ASSERT_EQUAL_INT(JP_ERR_EMPTY, jp_store_open(&store, &flash));
    for (uint8_t i = 1; i < 20U; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_write(&store, &i, 1));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_open(&store, &flash));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_read(&store, &record, &length));
        TEST_ASSERT_EQUAL_UINT8(i, record[0]);
    }
    TEST_ASSERT_EQUAL_UINT32(10, model.erases);
    model.next_errors = FLASH_SR_WRPERR;
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_store_write(&store, (const uint8_t *)"x", 1));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_open(&store, &flash));
    TEST_ASSERT_EQUAL_UINT8(19, store.record[0]);
}
