/* Rounds in frames: whole rounds, every way in which frames fail to come, offers that are refused; and what the battery
 * holds. */
#include "hal/can/round_link.h"

#include <string.h>

#include "tests/support/round_frames.h"
#include "unity.h"

enum { STOPS = 3, MAP = 4, FRAMES = (24 + 16 * STOPS + 4) / 5 };

static uint8_t bytes[JP_ROUND_BYTES(JP_ROUND_STOPS_MAX + 1U)];
static struct jp_round_link link;
static struct sent_round sent;

void setUp(void)
{
    for (unsigned i = 0; i < sizeof bytes; i++) {
        bytes[i] = (uint8_t)(29U * i + 7U);
    }
    link = (struct jp_round_link){.id = 0};
    sent = (struct sent_round){.bytes = bytes, .stops = STOPS, .map = MAP, .id = 9};
}

void tearDown(void)
{
}

static void expect(enum jp_round_link_state state, enum jp_round_reason reason)
{
    TEST_ASSERT_EQUAL_INT(state, link.state);
    TEST_ASSERT_EQUAL_INT(reason, link.reason);
}

static void offer_on(uint8_t map, bool may_replace)
{
    const struct jp_can_frame frame = round_offer(&sent);

    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, jp_round_link_accept_offer(&link, &frame, map, may_replace));
}

static void offer(void)
{
    offer_on(MAP, true);
}

static void give(uint32_t index)
{
    const struct jp_can_frame frame = round_data(&sent, index);

    TEST_ASSERT_NOT_EQUAL_INT(JP_E2E_CRC, jp_round_link_accept_data(&link, &frame));
}

static void give_from(uint32_t first)
{
    for (uint32_t i = first; i < JP_ROUND_FRAMES(sent.stops); i++) {
        give(i);
    }
}

static void expect_whole(void)
{
    expect(JP_ROUND_LINK_WHOLE, JP_ROUND_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT8(9, link.id);
    TEST_ASSERT_EQUAL_UINT8(JP_ROUND_FRAMES(sent.stops), link.frames);
    TEST_ASSERT_EQUAL_MEMORY(bytes, link.bytes, JP_ROUND_BYTES(sent.stops));
}

static void test_nothing_at_first(void)
{
    expect(JP_ROUND_LINK_NONE, JP_ROUND_REASON_NONE);
    give(0);
    TEST_ASSERT_EQUAL_UINT8(0, link.frames);
}

static void test_a_whole_round(void)
{
    offer();
    expect(JP_ROUND_LINK_RECEIVING, JP_ROUND_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT32(FRAMES, JP_ROUND_FRAMES(STOPS));
    give_from(0);
    expect_whole();
}

static void test_as_few_and_as_many_stops_as_there_may_be(void)
{
    sent.stops = 1;
    offer();
    give_from(0);
    expect_whole();
    sent.stops = JP_ROUND_STOPS_MAX;
    offer();
    give_from(0);
    expect_whole();
}

static void test_goes_on_where_a_frame_is_missing(void)
{
    offer();
    for (uint32_t i = 0; i < FRAMES; i++) {
        if (i != 6U) {
            give(i);
        }
    }
    TEST_ASSERT_EQUAL_UINT8(6, link.frames);
    offer(); /* the same again changes nothing */
    TEST_ASSERT_EQUAL_UINT8(6, link.frames);
    give(5);
    TEST_ASSERT_EQUAL_UINT8(6, link.frames);
    give_from(6);
    expect_whole();
    offer();
    expect_whole();
}

static void test_a_damaged_round_is_rejected_and_may_come_again(void)
{
    sent.crc_error = 1;
    offer();
    give_from(0);
    expect(JP_ROUND_LINK_REJECTED, JP_ROUND_REASON_CRC);
    offer();
    expect(JP_ROUND_LINK_RECEIVING, JP_ROUND_REASON_NONE);
    sent.crc_error = 0;
    offer();
    give_from(0);
    expect_whole();
}

static void expect_wrong_offer(void)
{
    offer();
    expect(JP_ROUND_LINK_REJECTED, JP_ROUND_REASON_FIELD);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_FIELD_STOPS, link.field);
    give_from(0);
    TEST_ASSERT_EQUAL_UINT8(0, link.frames);
    setUp();
}

static void test_offers_out_of_range_are_rejected(void)
{
    sent.stops = 0;
    expect_wrong_offer();
    sent.stops = JP_ROUND_STOPS_MAX + 1U;
    expect_wrong_offer();
    sent.id = 0;
    expect_wrong_offer();
}

static void test_without_its_map_it_is_rejected(void)
{
    offer_on(0, true);
    expect(JP_ROUND_LINK_REJECTED, JP_ROUND_REASON_NO_MAP);
    offer_on(MAP + 1, true);
    expect(JP_ROUND_LINK_REJECTED, JP_ROUND_REASON_OTHER_MAP);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_FIELD_NONE, link.field);
    offer();
    expect(JP_ROUND_LINK_RECEIVING, JP_ROUND_REASON_NONE);
}

static void test_each_part_of_an_offer_makes_another_round(void)
{
    for (unsigned part = 0; part < 4U; part++) {
        setUp();
        offer();
        give(0);
        sent.id = (uint8_t)(sent.id + (part == 0U ? 1U : 0U));
        sent.stops = (uint8_t)(sent.stops + (part == 1U ? 1U : 0U));
        sent.crc_error += part == 2U ? 1U : 0U;
        sent.map = (uint8_t)(sent.map + (part == 3U ? 1U : 0U));
        offer_on(sent.map, true);
        expect(JP_ROUND_LINK_RECEIVING, JP_ROUND_REASON_NONE);
        TEST_ASSERT_EQUAL_UINT8(0, link.frames);
    }
}

static void test_under_way_another_one_is_refused(void)
{
    offer();
    give_from(0);
    offer_on(MAP, false);
    expect_whole();
    sent.id = 10;
    offer_on(MAP, false);
    expect(JP_ROUND_LINK_WHOLE, JP_ROUND_REASON_UNDER_WAY);
    TEST_ASSERT_EQUAL_UINT8(9, link.id);
    offer();
    expect(JP_ROUND_LINK_RECEIVING, JP_ROUND_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT8(10, link.id);
}

static void test_every_flipped_bit_is_noticed(void)
{
    struct jp_can_frame frames[3];
    uint32_t held = 77;

    frames[0] = round_offer(&sent);
    frames[1] = round_data(&sent, 0);
    frames[2] = battery_charge(&sent, 160);
    for (unsigned bit = 0; bit < 64; bit++) {
        for (unsigned i = 0; i < 3U; i++) {
            frames[i].data[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
        }
        TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_round_link_accept_offer(&link, &frames[0], MAP, true));
        TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_round_link_accept_data(&link, &frames[1]));
        TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_round_link_accept_charge(&link, &frames[2], &held));
        for (unsigned i = 0; i < 3U; i++) {
            frames[i].data[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
        }
    }
    expect(JP_ROUND_LINK_NONE, JP_ROUND_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT32(77, held);
}

static void test_what_the_battery_holds(void)
{
    struct jp_can_frame frame = battery_charge(&sent, 160);
    uint32_t held = 77;

    TEST_ASSERT_EQUAL_INT(JP_E2E_FIRST, jp_round_link_accept_charge(&link, &frame, &held));
    TEST_ASSERT_EQUAL_UINT32(77, held);
    frame = battery_charge(&sent, 170);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, jp_round_link_accept_charge(&link, &frame, &held));
    TEST_ASSERT_EQUAL_UINT32(170, held);
    TEST_ASSERT_EQUAL_INT(JP_E2E_REPEATED, jp_round_link_accept_charge(&link, &frame, &held));
}

static void test_what_others_find_wrong_is_rejected(void)
{
    offer();
    give_from(0);
    jp_round_link_reject(&link, JP_ROUND_REASON_FIELD, JP_ROUND_FIELD_CHARGER);
    expect(JP_ROUND_LINK_REJECTED, JP_ROUND_REASON_FIELD);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_FIELD_CHARGER, link.field);
}
