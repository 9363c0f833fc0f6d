/* End-to-end protection: vectors of another implementation, every judgement of a counter, every small corruption. */
#include <string.h>

#include <joulepath/e2e.h>

#include "unity.h"

#define ID     0x4D
#define LENGTH 8

static struct jp_e2e_receiver receiver;
static uint8_t message[LENGTH];

void setUp(void)
{
    receiver = (struct jp_e2e_receiver){.synchronised = false};
    memset(message, 0, sizeof message);
}

void tearDown(void)
{
}

/* A message with this counter. */
static void write(uint8_t counter)
{
    uint8_t before = (uint8_t)(counter - 1U);

    jp_e2e_protect(&before, ID, message, LENGTH);
}

static void expect(enum jp_e2e_result result, uint8_t counter)
{
    write(counter);
    TEST_ASSERT_EQUAL_INT(result, jp_e2e_check(&receiver, ID, message, LENGTH));
}

/* Two messages, so that the receiver follows from `counter` on. */
static void synchronise(uint8_t counter)
{
    receiver = (struct jp_e2e_receiver){.synchronised = false};
    expect(JP_E2E_FIRST, (uint8_t)(counter - 1U) & 15U);
    expect(JP_E2E_OK, counter);
}

/* The CRC */

static void test_crc_of_the_autosar_specification(void)
{
    /* "Specification of CRC Routines", table of CRC8H2F. */
    static const uint8_t zeros[4] = {0};
    static const uint8_t nibbles[4] = {0x0F, 0xAA, 0x00, 0x55};
    static const uint8_t digits[9] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};

    TEST_ASSERT_EQUAL_HEX8(0x12, (uint8_t)~jp_e2e_crc(JP_E2E_CRC_START, zeros, sizeof zeros));
    TEST_ASSERT_EQUAL_HEX8(0xC6, (uint8_t)~jp_e2e_crc(JP_E2E_CRC_START, nibbles, sizeof nibbles));
    TEST_ASSERT_EQUAL_HEX8(0xDF, (uint8_t)~jp_e2e_crc(JP_E2E_CRC_START, digits, sizeof digits));
}

static void test_crc_goes_on_in_parts(void)
{
    static const uint8_t bytes[5] = {0xF2, 0x01, 0x83, 0x00, 0x7E};

    for (size_t first = 0; first <= sizeof bytes; first++) {
        const uint8_t crc = jp_e2e_crc(JP_E2E_CRC_START, bytes, first);

        TEST_ASSERT_EQUAL_HEX8(jp_e2e_crc(JP_E2E_CRC_START, bytes, sizeof bytes),
                               jp_e2e_crc(crc, bytes + first, sizeof bytes - first));
    }
}

/* Before and after e2e_p02_protect() of PyPI's autosar-e2e with 16 times the same data id. */
static const struct {
    uint8_t id;
    uint8_t length;
    uint8_t before[LENGTH];
    uint8_t after[LENGTH];
} vectors[] = {
    {0x4D, 8, {0x3C, 0xA0, 0x34, 0x72, 0xD7, 0xFB, 0xE1, 0x7A}, {0x4D, 0xA1, 0x34, 0x72, 0xD7, 0xFB, 0xE1, 0x7A}},
    {0x4D, 8, {0x01, 0x2E, 0x38, 0x93, 0x32, 0xE6, 0x05, 0xFB}, {0x2C, 0x2F, 0x38, 0x93, 0x32, 0xE6, 0x05, 0xFB}},
    {0x4D, 8, {0}, {0x67, 0x01}},
    {0x4F, 4, {0xA0, 0x67, 0xCB, 0x80}, {0x17, 0x68, 0xCB, 0x80}},
    {0x00, 2, {0xB2, 0xB0}, {0xC6, 0xB1}},
    {0xFF, 8, {0xC0, 0x23, 0xAE, 0x2D, 0x95, 0x93, 0xEA, 0x48}, {0x14, 0x24, 0xAE, 0x2D, 0x95, 0x93, 0xEA, 0x48}},
    {0xA5, 3, {0x9E, 0x09, 0xBC}, {0xC1, 0x0A, 0xBC}},
};

static void test_protects_as_another_implementation_does(void)
{
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++) {
        uint8_t counter = vectors[i].before[1] & 15U;

        memcpy(message, vectors[i].before, LENGTH);
        jp_e2e_protect(&counter, vectors[i].id, message, vectors[i].length);
        TEST_ASSERT_EQUAL_HEX8_ARRAY(vectors[i].after, message, LENGTH);
        TEST_ASSERT_EQUAL_UINT8((vectors[i].before[1] + 1U) & 15U, counter);
        setUp();
        TEST_ASSERT_EQUAL_INT(JP_E2E_FIRST,
                              jp_e2e_check(&receiver, vectors[i].id, vectors[i].after, vectors[i].length));
    }
}

static void test_a_group_is_one_long_message(void)
{
    static const uint8_t before[24] = {0xBA, 0xE5, 0xD8, 0x2E, 0xCC, 0xFF, 0x3B, 0xD9, 0xFB, 0xCB, 0x84, 0xD7,
                                       0xF5, 0x0C, 0x72, 0x42, 0x19, 0x34, 0xDB, 0xF0, 0x48, 0xF6, 0x75, 0x3E};
    const uint8_t *rest = before + LENGTH;
    uint8_t counter = 5;

    memcpy(message, before, LENGTH);
    jp_e2e_protect_group(&counter, 0x53, message, LENGTH, rest, 16);
    TEST_ASSERT_EQUAL_HEX8(0xB5, message[0]);
    TEST_ASSERT_EQUAL_HEX8(0xE6, message[1]);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(before + 2, message + 2, LENGTH - 2);
    TEST_ASSERT_EQUAL_INT(JP_E2E_FIRST, jp_e2e_check_group(&receiver, 0x53, message, LENGTH, rest, 16));
    TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_e2e_check_group(&receiver, 0x53, message, LENGTH, rest, 15));
    TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_e2e_check(&receiver, 0x53, message, LENGTH));
}

static void test_the_high_nibble_beside_the_counter_stays(void)
{
    message[1] = 0xF0;
    write(9);
    TEST_ASSERT_EQUAL_HEX8(0xF9, message[1]);
    write(0);
    TEST_ASSERT_EQUAL_HEX8(0xF0, message[1]);
}

/* The counter */

static void test_the_first_message_is_not_used(void)
{
    for (uint8_t counter = 0; counter < 16; counter++) {
        setUp();
        expect(JP_E2E_FIRST, counter);
        expect(JP_E2E_OK, (counter + 1U) & 15U);
        TEST_ASSERT_EQUAL_UINT8(0, receiver.gap);
    }
}

static void test_the_counter_wraps(void)
{
    uint8_t sent = 0;

    for (unsigned i = 0; i < 40; i++) {
        jp_e2e_protect(&sent, ID, message, LENGTH);
        TEST_ASSERT_EQUAL_UINT8((i + 1U) % 16U, sent);
        TEST_ASSERT_EQUAL_INT(i == 0 ? JP_E2E_FIRST : JP_E2E_OK, jp_e2e_check(&receiver, ID, message, LENGTH));
        TEST_ASSERT_EQUAL_UINT8(0, receiver.gap);
    }
}

/* The judgement of each step from each counter, in one table: repeated, followed, lost, too many lost. */
static void test_every_step_from_every_counter(void)
{
    for (uint8_t from = 0; from < 16; from++) {
        for (uint8_t step = 0; step < 16; step++) {
            const uint8_t lost = (uint8_t)(step - 1U);
            const enum jp_e2e_result result = step == 0                ? JP_E2E_REPEATED
                                              : lost <= JP_E2E_GAP_MAX ? JP_E2E_OK
                                                                       : JP_E2E_SEQUENCE;

            synchronise(from);
            expect(result, (from + step) & 15U);
            TEST_ASSERT_EQUAL_UINT8(result == JP_E2E_OK ? lost : 0, receiver.gap);
        }
    }
}

static void test_six_lost_are_bridged_and_seven_are_not(void)
{
    TEST_ASSERT_EQUAL_UINT(6, JP_E2E_GAP_MAX);
    synchronise(12);
    expect(JP_E2E_OK, 3); /* 13, 14, 15, 0, 1, 2 were lost */
    TEST_ASSERT_EQUAL_UINT8(6, receiver.gap);
    synchronise(12);
    expect(JP_E2E_SEQUENCE, 4);
}

static void test_after_too_many_lost_two_that_follow_are_needed(void)
{
    synchronise(0);
    expect(JP_E2E_SEQUENCE, 8);
    expect(JP_E2E_SEQUENCE, 10); /* one lost: not yet */
    expect(JP_E2E_REPEATED, 10);
    expect(JP_E2E_OK, 11);
    TEST_ASSERT_EQUAL_UINT8(0, receiver.gap);
    expect(JP_E2E_OK, 13);
    TEST_ASSERT_EQUAL_UINT8(1, receiver.gap);
}

static void test_at_the_start_no_gap_is_bridged(void)
{
    expect(JP_E2E_FIRST, 3);
    expect(JP_E2E_REPEATED, 3);
    expect(JP_E2E_SEQUENCE, 5);
    expect(JP_E2E_OK, 6);
}

static void test_repeated_messages_change_nothing(void)
{
    synchronise(5);
    for (int i = 0; i < 20; i++) {
        expect(JP_E2E_REPEATED, 5);
    }
    expect(JP_E2E_OK, 6);
}

static void test_late_and_swapped_messages_do_not_disturb_the_ones_in_time(void)
{
    synchronise(5);
    expect(JP_E2E_OK, 7); /* 6 and 7 were swapped */
    expect(JP_E2E_SEQUENCE, 6);
    expect(JP_E2E_OK, 8);
    TEST_ASSERT_EQUAL_UINT8(0, receiver.gap);
    expect(JP_E2E_SEQUENCE, 1); /* seven late */
    expect(JP_E2E_REPEATED, 1);
    expect(JP_E2E_OK, 10);
    TEST_ASSERT_EQUAL_UINT8(1, receiver.gap);
    expect(JP_E2E_SEQUENCE, 2); /* does not follow 1: one in time came between */
    expect(JP_E2E_OK, 11);
}

/* Corruption */

static void test_messages_with_another_id_or_length_are_corrupt(void)
{
    synchronise(3);
    write(4);
    for (unsigned id = 0; id < 256; id++) {
        if (id != ID) {
            TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_e2e_check(&receiver, (uint8_t)id, message, LENGTH));
        }
    }
    for (size_t length = 0; length < LENGTH; length++) {
        TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_e2e_check(&receiver, ID, message, length));
    }
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, jp_e2e_check(&receiver, ID, message, LENGTH));
}

static void test_corrupt_messages_do_not_move_the_counter(void)
{
    synchronise(3);
    write(9);
    message[5] ^= 0x10U;
    TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_e2e_check(&receiver, ID, message, LENGTH));
    message[5] ^= 0x10U;
    expect(JP_E2E_OK, 4);
}

static void flip(unsigned bit)
{
    message[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
}

/* The zero message and its complement: the flips hit both values of each bit. */
static void check_flips(uint8_t fill)
{
    unsigned accepted = 0;

    memset(message, fill, sizeof message);
    write(6);
    for (unsigned a = 0; a < 64; a++) {
        flip(a);
        accepted += jp_e2e_check(&receiver, ID, message, LENGTH) != JP_E2E_CRC;
        for (unsigned b = a + 1; b < 64; b++) {
            flip(b);
            accepted += jp_e2e_check(&receiver, ID, message, LENGTH) != JP_E2E_CRC;
            for (unsigned c = b + 1; c < 64; c++) {
                flip(c);
                accepted += jp_e2e_check(&receiver, ID, message, LENGTH) != JP_E2E_CRC;
                flip(c);
            }
            flip(b);
        }
        flip(a);
    }
    TEST_ASSERT_EQUAL_UINT(0, accepted);
    TEST_ASSERT_FALSE(receiver.doubted);
    TEST_ASSERT_EQUAL_INT(JP_E2E_FIRST, jp_e2e_check(&receiver, ID, message, LENGTH));
}

static void test_one_two_and_three_flipped_bits_are_always_found(void)
{
    check_flips(0x00);
    setUp();
    check_flips(0xFF);
}

/* Bits in the order of the wire: the highest of each byte first. */
static void flip_burst(unsigned start, unsigned pattern)
{
    for (unsigned i = 0; i < 8; i++) {
        if ((pattern >> i & 1U) != 0U) {
            flip((start + i) ^ 7U);
        }
    }
}

static void test_a_burst_of_eight_bits_behind_the_crc_is_always_found(void)
{
    write(6);
    for (unsigned start = 8; start <= 64 - 8; start++) {
        for (unsigned pattern = 1; pattern < 256; pattern++) {
            flip_burst(start, pattern);
            TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_e2e_check(&receiver, ID, message, LENGTH));
            flip_burst(start, pattern);
        }
    }
}
