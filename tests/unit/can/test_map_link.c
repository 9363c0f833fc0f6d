/* Maps, changes and goals in frames: whole maps, every way in which frames fail to come, offers that are refused. */
#include "hal/can/map_link.h"

#include <string.h>

#include "hal/storage/crc32.h"
#include "tests/support/map_frames.h"
#include "unity.h"

enum { SIDE = 40, STREAM_MAX = 1000 };

static uint64_t memory[2][SIDE * SIDE / 8];
static const struct jp_map_room room = {memory[1], sizeof memory[1], JP_Q16(0.1)};
static struct jp_map_link link;
static struct jp_terrain map;
static uint8_t stream[STREAM_MAX];
static struct sent_map sent;

void setUp(void)
{
    const struct jp_terrain_config config = {.width = SIDE, .height = SIDE, .resolution = JP_Q16(0.1)};
    const struct jp_place origin = {{JP_Q16(1), JP_Q16(2)}, 0};
    const char *field;

    memset(memory, 0, sizeof memory);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map, &config, memory[0], sizeof memory[0], &field));
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        (void)jp_terrain_set_cell(&map, i % SIDE, i / SIDE, (enum jp_cell)(i * i % 7 % 3));
    }
    sent = (struct sent_map){.bytes = stream, .id = 3};
    sent.length = (uint16_t)jp_map_encode(&map, &origin, stream, sizeof stream);
    TEST_ASSERT_GREATER_THAN_UINT16(0, sent.length);
    jp_map_link_start(&link, &room);
}

void tearDown(void)
{
}

static void expect(enum jp_map_link_state state, enum jp_map_reason reason)
{
    TEST_ASSERT_EQUAL_INT(state, link.state);
    TEST_ASSERT_EQUAL_INT(reason, link.reason);
}

static void work(void)
{
    for (unsigned i = 0; i < 100; i++) {
        jp_map_link_work(&link);
    }
}

static void offer(bool may_replace)
{
    const struct jp_can_frame frame = map_offer(&sent);

    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, jp_map_link_accept_offer(&link, &frame, may_replace));
}

static void give(uint32_t index)
{
    const struct jp_can_frame frame = map_data(&sent, index);

    TEST_ASSERT_NOT_EQUAL_INT(JP_E2E_CRC, jp_map_link_accept_data(&link, &frame));
}

static uint32_t frames(void)
{
    return (sent.length + JP_MAP_DATA - 1U) / JP_MAP_DATA;
}

static void give_from(uint32_t first)
{
    for (uint32_t i = first; i < frames(); i++) {
        give(i);
        jp_map_link_work(&link);
        jp_map_link_work(&link);
    }
    work();
}

static void expect_whole(void)
{
    expect(JP_MAP_LINK_READY, JP_MAP_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT8(3, link.id);
    TEST_ASSERT_EQUAL_UINT32(frames(), link.frames);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(2), link.decoder.origin.point.y);
    TEST_ASSERT_EQUAL_MEMORY(memory[0], memory[1], jp_terrain_size(&map.config));
}

static void test_nothing_at_first(void)
{
    work();
    expect(JP_MAP_LINK_NONE, JP_MAP_REASON_NONE);
    give(0);
    work();
    TEST_ASSERT_EQUAL_UINT16(0, link.frames);
    expect(JP_MAP_LINK_NONE, JP_MAP_REASON_NONE);
}

static void test_a_whole_map(void)
{
    offer(true);
    expect(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE);
    give_from(0);
    expect_whole();
}

static void test_goes_on_where_a_frame_is_missing(void)
{
    offer(true);
    for (uint32_t i = 0; i < 10; i++) {
        if (i != 4) {
            give(i);
            work();
        }
    }
    TEST_ASSERT_EQUAL_UINT16(4, link.frames);
    give_from(4);
    expect_whole();
}

static void test_repeated_and_late_frames_change_nothing(void)
{
    offer(true);
    for (uint32_t i = 0; i < frames(); i++) {
        give(i);
        give(i);
        give(i / 2);
        give(i + 2);
        work();
        TEST_ASSERT_EQUAL_UINT16(i + 1, link.frames);
    }
    expect_whole();
    give(0);
    work();
    expect_whole();
}

static void test_a_corrupt_frame_is_not_taken(void)
{
    offer(true);
    for (unsigned bit = 0; bit < 64; bit++) {
        struct jp_can_frame frame = map_data(&sent, 0);

        frame.data[bit / 8] ^= (uint8_t)(1U << (bit % 8));
        TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_map_link_accept_data(&link, &frame));
        frame = map_offer(&sent);
        frame.data[bit / 8] ^= (uint8_t)(1U << (bit % 8));
        TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_map_link_accept_offer(&link, &frame, true));
    }
    TEST_ASSERT_EQUAL_UINT16(0, link.frames);
    give_from(0);
    expect_whole();
}

static void test_more_than_it_holds_is_asked_for_again(void)
{
    offer(true);
    for (uint32_t i = 0; i < 2 * JP_MAP_WAITING / JP_MAP_DATA; i++) {
        give(i);
    }
    TEST_ASSERT_EQUAL_UINT16(JP_MAP_WAITING / JP_MAP_DATA, link.frames);
    work();
    give_from(link.frames);
    expect_whole();
}

static void test_the_same_offer_goes_on(void)
{
    offer(true);
    for (uint32_t i = 0; i < 7; i++) {
        give(i);
    }
    work();
    offer(false);
    expect(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT16(7, link.frames);
    give_from(7);
    expect_whole();
    offer(false);
    expect_whole();
}

static void test_another_offer_begins_anew(void)
{
    offer(true);
    give_from(0);
    sent.id = 4;
    offer(true);
    expect(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT16(0, link.frames);
    give_from(0);
    sent.id = 3;
    link.id = 3;
    expect_whole();
}

static void test_an_offer_may_be_refused(void)
{
    offer(true);
    give_from(0);
    sent.id = 4;
    offer(false);
    expect(JP_MAP_LINK_READY, JP_MAP_REASON_UNDER_WAY);
    TEST_ASSERT_EQUAL_UINT8(3, link.id);
    offer(true);
    expect(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE);
}

static void test_offers_out_of_range(void)
{
    sent.id = 0;
    offer(true);
    expect(JP_MAP_LINK_REJECTED, JP_MAP_REASON_FORMAT);
    sent.id = 1;
    sent.length = 21;
    offer(true);
    expect(JP_MAP_LINK_REJECTED, JP_MAP_REASON_FORMAT);
    give(0);
    TEST_ASSERT_EQUAL_UINT16(0, link.frames);
}

static void test_a_wrong_checksum(void)
{
    sent.crc_error = 1;
    offer(true);
    give_from(0);
    expect(JP_MAP_LINK_REJECTED, JP_MAP_REASON_CRC);
    sent.crc_error = 0;
    offer(true);
    give_from(0);
    expect_whole();
}

static void test_a_rejected_offer_may_be_made_again(void)
{
    sent.crc_error = 1;
    offer(true);
    give_from(0);
    offer(true);
    expect(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE);
}

static void test_a_stream_that_ends_early(void)
{
    sent.length = (uint16_t)(sent.length - 3U);
    offer(true);
    give_from(0);
    expect(JP_MAP_LINK_REJECTED, JP_MAP_REASON_FORMAT);
}

static void test_a_stream_with_more_behind_the_map(void)
{
    sent.length++;
    offer(true);
    give_from(0);
    expect(JP_MAP_LINK_REJECTED, JP_MAP_REASON_FORMAT);
}

static void test_a_stream_that_is_no_map(void)
{
    stream[20] = 7;
    offer(true);
    give_from(0);
    expect(JP_MAP_LINK_REJECTED, JP_MAP_REASON_FORMAT);
}

static void test_maps_that_do_not_fit(void)
{
    stream[1] = 1;
    offer(true);
    give_from(0);
    expect(JP_MAP_LINK_REJECTED, JP_MAP_REASON_TOO_LARGE);
    stream[1] = 0;
    stream[4] ^= 1;
    offer(true);
    give_from(0);
    expect(JP_MAP_LINK_REJECTED, JP_MAP_REASON_CELL_SIZE);
    jp_map_link_reject(&link, JP_MAP_REASON_TOO_LARGE);
    expect(JP_MAP_LINK_REJECTED, JP_MAP_REASON_TOO_LARGE);
}

/* Changes. */

static enum jp_e2e_result change(uint8_t counter, struct jp_cell_changes *changes)
{
    const struct jp_can_frame frame = cell_changes(counter, changes);

    return jp_map_link_accept_cells(&link, &frame, changes);
}

static void test_changes_as_they_were_sent(void)
{
    struct jp_cell_changes changes = {.map = 5, .x = 4095, .y = 1234, .cells = 0xABCDEF};

    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, change(1, &changes));
    TEST_ASSERT_EQUAL_UINT8(5, changes.map);
    TEST_ASSERT_EQUAL_UINT16(4095, changes.x);
    TEST_ASSERT_EQUAL_UINT16(1234, changes.y);
    TEST_ASSERT_EQUAL_HEX32(0xABCDEF, changes.cells);
}

static void test_changes_are_acknowledged_in_their_order(void)
{
    struct jp_cell_changes changes = {.map = 1};
    uint8_t counter = 0;

    for (unsigned i = 0; i < 40; i++) {
        counter = (uint8_t)((counter + 1U) & 15U);
        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, change(counter, &changes));
        TEST_ASSERT_EQUAL_UINT8(counter, link.cell_counter);
    }
    (void)change((counter + 2U) & 15U, &changes);
    (void)change((counter + 3U) & 15U, &changes);
    TEST_ASSERT_EQUAL_UINT8(counter, link.cell_counter);
    (void)change((counter + 1U) & 15U, &changes);
    TEST_ASSERT_EQUAL_UINT8((counter + 1U) & 15U, link.cell_counter);
}

static void test_corrupt_changes(void)
{
    struct jp_cell_changes changes = {.map = 1};
    struct jp_can_frame frame = cell_changes(1, &changes);

    frame.data[7] ^= 4;
    TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_map_link_accept_cells(&link, &frame, &changes));
    TEST_ASSERT_EQUAL_UINT8(0, link.cell_counter);
}

/* Goals. */

static void test_a_goal(void)
{
    struct jp_map_goal goal = {
        .map = 7, .id = 200, .x = 4095, .y = 17, .has_heading = true, .heading = JP_ANGLE_DEGREES(-90)};
    struct jp_can_frame frame = map_goal(1, &goal);
    struct jp_map_goal taken = {.id = 1};

    TEST_ASSERT_EQUAL_INT(JP_E2E_FIRST, jp_map_link_accept_goal(&link, &frame, &taken));
    TEST_ASSERT_EQUAL_UINT8(1, taken.id);
    frame = map_goal(2, &goal);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, jp_map_link_accept_goal(&link, &frame, &taken));
    TEST_ASSERT_EQUAL_UINT8(7, taken.map);
    TEST_ASSERT_EQUAL_UINT8(200, taken.id);
    TEST_ASSERT_EQUAL_UINT16(4095, taken.x);
    TEST_ASSERT_EQUAL_UINT16(17, taken.y);
    TEST_ASSERT_TRUE(taken.has_heading);
    TEST_ASSERT_EQUAL_UINT32(JP_ANGLE_DEGREES(-90), taken.heading);
    TEST_ASSERT_EQUAL_INT(JP_E2E_REPEATED, jp_map_link_accept_goal(&link, &frame, &taken));
    frame.data[5] ^= 1;
    TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_map_link_accept_goal(&link, &frame, &taken));
}

static void test_a_point_has_no_heading(void)
{
    struct jp_map_goal goal = {.map = 1, .id = 1, .heading = 0};
    struct jp_can_frame frame = map_goal(1, &goal);
    struct jp_map_goal taken = {.has_heading = true};

    (void)jp_map_link_accept_goal(&link, &frame, &taken);
    frame = map_goal(2, &goal);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, jp_map_link_accept_goal(&link, &frame, &taken));
    TEST_ASSERT_FALSE(taken.has_heading);
}
