/* Scans of a laser in frames: they arrive whole or not at all, and one at a time. */
#include "hal/can/scan_link.h"

#include "hal/can/jp_can.h"
#include "unity.h"

#define BEAMS  10U
#define FRAMES JP_SCAN_FRAMES(BEAMS)

static struct jp_scan_link link;
static struct jp_scan_counters counters;
static uint16_t ranges[BEAMS];
static uint16_t seen[BEAMS];
static unsigned begun;
static unsigned whole;

void setUp(void)
{
    jp_scan_link_start(&link, BEAMS);
    counters = (struct jp_scan_counters){0};
    begun = whole = 0;
    for (unsigned i = 0; i < BEAMS; i++) {
        ranges[i] = (uint16_t)(100U * i);
        seen[i] = 99;
    }
}

void tearDown(void)
{
}

static enum jp_e2e_result accept(const struct jp_can_frame *frame)
{
    enum jp_e2e_result result = JP_E2E_OK;
    bool happened = false;

    switch (frame->id) {
    case JP_CAN_SCAN_BEGIN_FRAME_ID:
        result = jp_scan_link_accept_begin(&link, frame, &happened);
        begun += happened ? 1U : 0U;
        break;
    case JP_CAN_SCAN_RANGES_FRAME_ID:
        jp_scan_link_accept_ranges(&link, frame);
        break;
    default:
        result = jp_scan_link_accept_end(&link, frame, &happened);
        whole += happened ? 1U : 0U;
        break;
    }
    return result;
}

/* But for one frame, and with one bit of one wrong. */
static void send(unsigned missing, unsigned wrong)
{
    struct jp_can_frame frame;

    for (unsigned i = 0; i < FRAMES; i++) {
        jp_scan_pack(&counters, ranges, BEAMS, i, &frame);
        frame.data[2] ^= i == wrong ? 1U : 0U;
        if (i != missing) {
            (void)accept(&frame);
        }
    }
}

static void test_a_scan_arrives_as_it_was_sent(void)
{
    ranges[4] = JP_SCAN_RANGE_DROPPED;
    send(FRAMES, FRAMES);
    TEST_ASSERT_EQUAL_UINT(1, begun);
    TEST_ASSERT_EQUAL_UINT(1, whole);
    TEST_ASSERT_TRUE(jp_scan_link_waits(&link));
    TEST_ASSERT_TRUE(jp_scan_link_take(&link, seen));
    for (unsigned i = 0; i < BEAMS; i++) {
        TEST_ASSERT_EQUAL_UINT16(ranges[i], seen[i]);
    }
    TEST_ASSERT_FALSE(jp_scan_link_waits(&link));
    TEST_ASSERT_FALSE(jp_scan_link_take(&link, seen));
}

static void test_a_scan_without_one_of_its_frames_is_lost(void)
{
    for (unsigned i = 0; i < FRAMES; i++) {
        setUp();
        send(i, FRAMES);
        TEST_ASSERT_EQUAL_UINT(0, whole);
        TEST_ASSERT_FALSE(jp_scan_link_waits(&link));
        send(FRAMES, FRAMES);
        TEST_ASSERT_EQUAL_UINT(1, whole);
        TEST_ASSERT_EQUAL_UINT16(i == 0 ? 0 : 1, link.lost);
    }
}

static void test_a_scan_with_a_wrong_bit_is_lost(void)
{
    for (unsigned i = 0; i < FRAMES; i++) {
        setUp();
        send(FRAMES, i);
        TEST_ASSERT_EQUAL_UINT(0, whole);
    }
}

static void test_frames_too_many_end_a_scan(void)
{
    struct jp_can_frame frame;

    for (unsigned i = 0; i + 1U < FRAMES; i++) {
        jp_scan_pack(&counters, ranges, BEAMS, i, &frame);
        (void)accept(&frame);
    }
    frame.data[0]++;
    (void)accept(&frame);
    TEST_ASSERT_EQUAL_UINT16(1, link.lost);
}

static void test_another_scanner_is_not_listened_to(void)
{
    uint16_t more[BEAMS + 4U] = {0};
    struct jp_can_frame frame;

    for (unsigned i = 0; i < JP_SCAN_FRAMES(BEAMS + 4U); i++) {
        jp_scan_pack(&counters, more, BEAMS + 4U, i, &frame);
        (void)accept(&frame);
    }
    TEST_ASSERT_EQUAL_UINT(0, begun);
    TEST_ASSERT_EQUAL_UINT(0, whole);
}

static void test_a_scan_that_comes_too_soon_is_dropped(void)
{
    send(FRAMES, FRAMES);
    ranges[0] = 7;
    send(FRAMES, FRAMES);
    TEST_ASSERT_EQUAL_UINT(1, whole);
    TEST_ASSERT_EQUAL_UINT16(1, link.lost);
    TEST_ASSERT_TRUE(jp_scan_link_take(&link, seen));
    TEST_ASSERT_EQUAL_UINT16(0, seen[0]);
    send(FRAMES, FRAMES);
    TEST_ASSERT_TRUE(jp_scan_link_take(&link, seen));
    TEST_ASSERT_EQUAL_UINT16(7, seen[0]);
}
