/* The store in flash: what was written is found again, the log's way through both sectors, foreign contents, worn
 * words. */
#include <string.h>

#define NOR_SLOTS 4U
#define NOR_WORDS (NOR_SLOTS * 64U)

#include "tests/support/nor_flash.h"

#include "hal/storage/crc32.h"
#include "unity.h"

static struct nor_flash nor;
static struct jp_flash flash;
static struct jp_store store;
static uint8_t bytes[JP_STORE_LENGTH_MAX + 1U];

void setUp(void)
{
    nor_start(&nor, 1);
    flash = nor_interface(&nor);
    TEST_ASSERT_EQUAL_INT(JP_ERR_EMPTY, jp_store_open(&store, &flash));
}

void tearDown(void)
{
}

/* A record that its tag tells: its length and every byte. */
static uint16_t make_record(uint32_t tag)
{
    const uint16_t length = (uint16_t)(1U + tag * 37U % JP_STORE_LENGTH_MAX);

    for (unsigned i = 0; i < length; i++) {
        bytes[i] = (uint8_t)(tag * 101U + i * 7U);
    }
    return length;
}

static enum jp_status write(uint32_t tag)
{
    const uint16_t length = make_record(tag);

    return jp_store_write(&store, bytes, length);
}

static void expect_record(uint32_t tag)
{
    const uint16_t expected = make_record(tag);
    const uint8_t *record = NULL;
    uint16_t length = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_read(&store, &record, &length));
    TEST_ASSERT_EQUAL_UINT16(expected, length);
    TEST_ASSERT_EQUAL_INT(0, memcmp(bytes, record, length));
}

static void reopen(uint32_t tag)
{
    memset(&store, 0xA5, sizeof store);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_open(&store, &flash));
    expect_record(tag);
}

/* Plain use */

static void test_an_erased_flash_is_empty(void)
{
    const uint8_t *record;
    uint16_t length = 1;

    TEST_ASSERT_EQUAL_INT(JP_ERR_EMPTY, jp_store_read(&store, &record, &length));
    TEST_ASSERT_EQUAL_UINT16(0, length);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_settle(&store));
    TEST_ASSERT_EQUAL_UINT32(0, nor.steps);
}

static void test_what_was_written_is_found_again(void)
{
    for (uint32_t tag = 1; tag < 300; tag++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, write(tag));
        expect_record(tag);
        reopen(tag);
    }
}

static void test_in_one_session_too(void)
{
    for (uint32_t tag = 1; tag < 300; tag++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, write(tag));
        expect_record(tag);
    }
    reopen(299);
}

static void test_records_of_every_length(void)
{
    for (uint16_t length = 1; length <= JP_STORE_LENGTH_MAX; length++) {
        const uint8_t *record;
        uint16_t found;

        memset(bytes, length, sizeof bytes);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_write(&store, bytes, length));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_open(&store, &flash));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_read(&store, &record, &found));
        TEST_ASSERT_EQUAL_UINT16(length, found);
        TEST_ASSERT_EQUAL_INT(0, memcmp(bytes, record, length));
    }
}

static void test_a_sector_is_erased_only_when_the_other_is_full(void)
{
    for (uint32_t tag = 1; tag <= 100U * NOR_SLOTS; tag++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, write(tag));
        TEST_ASSERT_EQUAL_UINT32((tag + NOR_SLOTS - 1U) / NOR_SLOTS, nor.erases);
        TEST_ASSERT_EQUAL_UINT32(nor.erases, store.erases);
        TEST_ASSERT_EQUAL_UINT32(nor.erases - 1U, store.generation);
    }
}

static void test_an_equal_record_is_not_written_again(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, write(1));

    const unsigned long steps = nor.steps;

    TEST_ASSERT_EQUAL_INT(JP_OK, write(1));
    reopen(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, write(1));
    TEST_ASSERT_EQUAL_UINT32(steps, nor.steps);
    bytes[0] ^= 1U; /* another one of equal length */
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_write(&store, bytes, store.length));
    TEST_ASSERT_TRUE(nor.steps > steps);
}

static void test_opening_and_settling_write_nothing_when_nothing_was_cut(void)
{
    for (uint32_t tag = 1; tag <= 3U * NOR_SLOTS; tag++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, write(tag));

        const unsigned long steps = nor.steps;

        reopen(tag);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_settle(&store));
        TEST_ASSERT_EQUAL_UINT32(steps, nor.steps);
        TEST_ASSERT_EQUAL_UINT32(0, store.erases);
    }
}

static void test_a_new_part_is_erased_before_its_first_record(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, write(1));
    TEST_ASSERT_EQUAL_UINT32(1, nor.erases);
}

static void test_null_and_length_are_checked(void)
{
    const uint8_t *record;
    uint16_t length;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_store_open(NULL, &flash));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_store_open(&store, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_store_read(NULL, &record, &length));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_store_read(&store, NULL, &length));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_store_read(&store, &record, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_store_settle(NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_store_write(NULL, bytes, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_store_write(&store, NULL, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_store_write(&store, bytes, 0));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_store_write(&store, bytes, JP_STORE_LENGTH_MAX + 1U));
    TEST_ASSERT_EQUAL_UINT32(0, nor.steps);
    flash.sector_size = JP_STORE_SLOT_SIZE - 1U;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_store_open(&store, &flash));
}

static void test_a_sector_of_one_record_is_enough(void)
{
    flash.sector_size = JP_STORE_SLOT_SIZE;
    TEST_ASSERT_EQUAL_INT(JP_ERR_EMPTY, jp_store_open(&store, &flash));
    for (uint32_t tag = 1; tag < 10; tag++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, write(tag));
        reopen(tag);
        TEST_ASSERT_EQUAL_UINT32(tag, nor.erases);
    }
}

/* What is found in the flash */

static void put(unsigned sector, uint32_t slot, uint32_t generation, uint32_t tag)
{
    const uint16_t length = make_record(tag);

    nor_put_slot(&nor, sector, slot, generation, bytes, length);
}

static void test_the_crc_is_that_of_zlib(void)
{
    static const uint8_t check[] = "123456789";

    TEST_ASSERT_EQUAL_HEX32(0xCBF43926U, jp_crc32(0, check, 9));
    TEST_ASSERT_EQUAL_HEX32(0xCBF43926U, jp_crc32(jp_crc32(0, check, 4), check + 4, 5));
    TEST_ASSERT_EQUAL_HEX32(0, jp_crc32(0, check, 0));
}

static uint32_t crc_of_flash(void)
{
    return jp_crc32(0, (const uint8_t *)nor.sectors, sizeof nor.sectors);
}

static void test_the_format_is_as_described(void)
{
    uint32_t written;

    for (uint32_t tag = 1; tag <= NOR_SLOTS; tag++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, write(tag));
    }
    written = crc_of_flash();
    nor_start(&nor, 1);
    for (uint32_t tag = 1; tag <= NOR_SLOTS; tag++) {
        put(0, tag - 1U, 0, tag);
    }
    TEST_ASSERT_EQUAL_HEX32(crc_of_flash(), written);
}

static void test_the_last_record_of_the_newer_sector_counts(void)
{
    static const uint32_t generations[] = {0, 1, 77, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFEU, 0xFFFFFFFFU};

    for (size_t i = 0; i < sizeof generations / sizeof generations[0]; i++) {
        for (unsigned newer = 0; newer < 2U; newer++) {
            nor_start(&nor, 1);
            for (uint32_t slot = 0; slot < NOR_SLOTS; slot++) {
                put(1U - newer, slot, generations[i], 10U + slot);
            }
            put(newer, 0, generations[i] + 1U, 20);
            reopen(20);
            put(newer, 1, generations[i] + 1U, 21);
            reopen(21);
            TEST_ASSERT_EQUAL_INT(JP_OK, write(22));
            reopen(22);
            TEST_ASSERT_EQUAL_UINT32(0, nor.erases);
        }
    }
}

static void test_the_generation_wraps(void)
{
    put(1, NOR_SLOTS - 1U, 0xFFFFFFFDU, 100);
    reopen(100);
    for (uint32_t tag = 1; tag < 6U * NOR_SLOTS; tag++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, write(tag));
        reopen(tag);
    }
    TEST_ASSERT_EQUAL_UINT32(3, store.generation);
}

static void test_one_changed_bit_leaves_the_record_before(void)
{
    put(0, 0, 5, 1);
    put(0, 1, 5, 2);
    for (size_t bit = 0; bit < 32U * (JP_STORE_SLOT_WORDS - 1U); bit++) {
        struct nor_word *word = &nor.sectors[0][JP_STORE_SLOT_WORDS + bit / 32U];

        word->value ^= 1U << (bit % 32U);
        reopen(1);
        word->value ^= 1U << (bit % 32U);
    }
    reopen(2);
}

static void test_swapped_words_leave_the_record_before(void)
{
    put(0, 0, 5, 1);
    put(0, 1, 5, 3);
    for (size_t i = 0; i + 2U < JP_STORE_SLOT_WORDS; i++) {
        struct nor_word *words = &nor.sectors[0][JP_STORE_SLOT_WORDS + i];
        const struct nor_word first = words[0];

        if (words[0].value != words[1].value) {
            words[0] = words[1];
            words[1] = first;
            reopen(1);
            words[1] = words[0];
            words[0] = first;
        }
    }
    reopen(3);
}

static void fill(unsigned sector, uint32_t value)
{
    for (size_t i = 0; i < NOR_WORDS; i++) {
        nor.sectors[sector][i].value = value;
    }
}

static void test_flash_full_of_anything_is_empty_and_can_be_written(void)
{
    for (unsigned round = 0; round < 64; round++) {
        nor_start(&nor, round + 1U);
        for (size_t i = 0; i < NOR_WORDS; i++) {
            nor.sectors[0][i].value = round < 8U ? 0x11111111U * round : nor_random(&nor);
            nor.sectors[1][i].value = round < 8U ? 0x22222222U * round : nor_random(&nor);
        }
        TEST_ASSERT_EQUAL_INT(JP_ERR_EMPTY, jp_store_open(&store, &flash));
        TEST_ASSERT_EQUAL_INT(JP_OK, write(1));
        reopen(1);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_settle(&store));
        for (uint32_t tag = 2; tag < 3U * NOR_SLOTS; tag++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, write(tag));
            reopen(tag);
        }
    }
}

/* A length out of range under a CRC that fits is no record. */
static void test_a_length_out_of_range_is_refused(void)
{
    put(0, 0, 5, 1);
    memset(bytes, 0x5A, sizeof bytes);
    nor_put_slot(&nor, 0, 1, 5, bytes, 0);
    reopen(1);
    nor_put_slot(&nor, 0, 2, 5, bytes, 0);
    nor.sectors[0][2U * JP_STORE_SLOT_WORDS + 2U].value = JP_STORE_LENGTH_MAX + 1U;
    reopen(1);
}

/* Settling */

static void test_a_record_without_its_seal_is_sealed(void)
{
    put(0, 0, 5, 1);
    put(0, 1, 5, 2);
    nor.sectors[0][2U * JP_STORE_SLOT_WORDS - 1U].value = NOR_ERASED;
    reopen(2);
    TEST_ASSERT_EQUAL_UINT32(0, nor.steps);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_settle(&store));
    TEST_ASSERT_TRUE(nor.steps > 0U);
    TEST_ASSERT_EQUAL_HEX32(0x2144454CU, nor.sectors[0][2U * JP_STORE_SLOT_WORDS - 1U].value);
    TEST_ASSERT_EQUAL_HEX32(NOR_ERASED, nor.sectors[0][2U * JP_STORE_SLOT_WORDS].value);
    reopen(2);
}

/* Its CRC may come to fit: the record found must stand behind it. */
static void test_a_torn_record_is_left_behind(void)
{
    struct nor_word *torn = &nor.sectors[0][2U * JP_STORE_SLOT_WORDS - 2U];

    put(0, 0, 5, 1);
    put(0, 1, 5, 2);
    torn[0].value ^= 0x8000U;
    torn[1].value = NOR_ERASED;
    reopen(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_settle(&store));
    torn[0].value ^= 0x8000U;
    reopen(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, write(3));
    reopen(3);
    TEST_ASSERT_EQUAL_UINT32(0, nor.erases);
}

static void test_a_torn_record_at_the_end_leads_to_the_other_sector(void)
{
    put(0, NOR_SLOTS - 2U, 5, 1);
    put(0, NOR_SLOTS - 1U, 5, 2);
    nor.sectors[0][NOR_WORDS - 2U].value ^= 1U;
    reopen(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_settle(&store));
    TEST_ASSERT_EQUAL_UINT32(1, nor.erases);
    nor.sectors[0][NOR_WORDS - 2U].value ^= 1U;
    reopen(1);
}

/* The next generation was begun there; its first record may come to fit. */
static void test_a_torn_sector_is_erased(void)
{
    put(0, 0, 5, 1);
    put(1, 0, 6, 2);
    nor.sectors[1][JP_STORE_SLOT_WORDS - 2U].value ^= 1U;
    reopen(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_settle(&store));
    TEST_ASSERT_EQUAL_UINT32(1, nor.erases);
    reopen(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_settle(&store));
    TEST_ASSERT_EQUAL_UINT32(1, nor.erases);
}

static void test_an_older_sector_with_torn_records_is_left_alone(void)
{
    put(0, 0, 5, 1);
    put(0, 1, 5, 2);
    nor.sectors[0][2U * JP_STORE_SLOT_WORDS - 2U].value ^= 1U;
    put(1, 0, 6, 3);
    reopen(3);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_settle(&store));
    TEST_ASSERT_EQUAL_UINT32(0, nor.steps);
}

/* Writing settles first: were this write cut, too, the record found must still be there. */
static void test_writing_settles_first(void)
{
    put(0, 0, 5, 1);
    put(0, 1, 5, 2);
    nor.sectors[0][2U * JP_STORE_SLOT_WORDS - 1U].value = NOR_ERASED;
    reopen(2);
    TEST_ASSERT_EQUAL_INT(JP_OK, write(3));
    TEST_ASSERT_EQUAL_HEX32(0x2144454CU, nor.sectors[0][2U * JP_STORE_SLOT_WORDS - 1U].value);
    reopen(3);
}

/* Worn words, with and without a report of the hardware. */

static void wear(unsigned sector, uint32_t slot, uint32_t word, uint32_t worn)
{
    nor.sectors[sector][slot * JP_STORE_SLOT_WORDS + word].worn = worn;
}

static void test_a_worn_word_costs_its_slot(void)
{
    for (unsigned refuses = 0; refuses < 2U; refuses++) {
        for (uint32_t word = 0; word < JP_STORE_SLOT_WORDS; word++) {
            setUp();
            nor.refuses = refuses != 0U;
            memset(bytes, 0, sizeof bytes);
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_write(&store, bytes, JP_STORE_LENGTH_MAX));
            wear(0, 1, word, NOR_ERASED);
            bytes[0] = 1;
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_write(&store, bytes, JP_STORE_LENGTH_MAX));
            TEST_ASSERT_EQUAL_UINT32(3, store.next);
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_open(&store, &flash));
            TEST_ASSERT_EQUAL_UINT8(1, store.record[0]);
            TEST_ASSERT_EQUAL_UINT32(1, nor.erases);
        }
    }
}

static void test_two_worn_slots_lead_to_the_other_sector(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, write(1));
    wear(0, 1, 0, NOR_ERASED);
    wear(0, 2, 0, NOR_ERASED);
    TEST_ASSERT_EQUAL_INT(JP_OK, write(2));
    TEST_ASSERT_EQUAL_UINT32(2, nor.erases);
    reopen(2);
}

static void test_worn_out_flash_keeps_the_old_record(void)
{
    for (unsigned refuses = 0; refuses < 2U; refuses++) {
        setUp();
        nor.refuses = refuses != 0U;
        TEST_ASSERT_EQUAL_INT(JP_OK, write(1));
        for (size_t i = 0; i < NOR_WORDS; i++) {
            nor.sectors[0][i].worn = NOR_ERASED;
            nor.sectors[1][i].worn = NOR_ERASED;
        }
        for (uint32_t tag = 2; tag < 20; tag++) {
            TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, write(tag));
            expect_record(1);
            reopen(1);
        }
    }
}

static void test_a_sector_that_cannot_be_erased_keeps_the_old_record(void)
{
    for (uint32_t tag = 1; tag <= NOR_SLOTS; tag++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, write(tag));
    }
    fill(1, 0);
    for (size_t i = 0; i < NOR_WORDS; i++) {
        nor.sectors[1][i].worn = NOR_ERASED;
    }
    for (unsigned refuses = 0; refuses < 2U; refuses++) {
        nor.refuses = refuses != 0U;
        TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, write(50));
        expect_record(NOR_SLOTS);
        reopen(NOR_SLOTS);
        TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_store_settle(&store));
        expect_record(NOR_SLOTS);
    }
}

/* What it left behind may come to fit. */
static void test_a_failed_write_is_settled(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, write(1));
    for (uint32_t slot = 0; slot < NOR_SLOTS; slot++) {
        wear(slot == 3U ? 1U : 0U, slot == 3U ? 0U : slot, 2, NOR_ERASED);
    }
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, write(2));
    for (uint32_t slot = 0; slot < NOR_SLOTS; slot++) {
        wear(slot == 3U ? 1U : 0U, slot == 3U ? 0U : slot, 2, 0);
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_settle(&store));
    TEST_ASSERT_EQUAL_UINT32(3, nor.erases);
    expect_record(1);
    reopen(1);
}

/* A seal that does not take its place: a copy must, and the other sector is not erased for it. */
static void test_a_record_that_cannot_be_sealed_is_copied(void)
{
    put(0, 0, 5, 1);
    nor.sectors[0][JP_STORE_SLOT_WORDS - 1U].value = 0;
    nor.sectors[0][JP_STORE_SLOT_WORDS - 1U].worn = NOR_ERASED;
    reopen(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_settle(&store));
    TEST_ASSERT_EQUAL_UINT32(2, store.next);
    TEST_ASSERT_EQUAL_UINT32(0, nor.erases);
    reopen(1);
}

static void test_the_other_sector_stays_until_a_record_is_sealed(void)
{
    put(1, NOR_SLOTS - 1U, 4, 1);
    put(0, 0, 5, 2);
    for (uint32_t slot = 0; slot < NOR_SLOTS; slot++) {
        wear(0, slot, JP_STORE_SLOT_WORDS - 1U, NOR_ERASED);
    }
    nor.sectors[0][JP_STORE_SLOT_WORDS - 1U].value = NOR_ERASED;
    for (unsigned round = 0; round < 10; round++) {
        reopen(2);
        TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, round % 2U == 0U ? jp_store_settle(&store) : write(3));
        TEST_ASSERT_EQUAL_UINT32(0, nor.erases);
    }
}

static void test_a_failed_first_record_leaves_the_store_empty(void)
{
    wear(0, 0, 5, NOR_ERASED);
    nor.sectors[0][5].value = 0x12345678U;
    memset(bytes, 0, sizeof bytes);
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_store_write(&store, bytes, JP_STORE_LENGTH_MAX));
    TEST_ASSERT_EQUAL_UINT16(0, store.length);
    TEST_ASSERT_EQUAL_INT(JP_ERR_EMPTY, jp_store_open(&store, &flash));
    nor.sectors[0][5].worn = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, write(7));
    reopen(7);
}
