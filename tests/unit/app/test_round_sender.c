/* An operator's round, against the ECU's side of it: on a bus that takes all, loses frames or is full, and an ECU that
 * refuses. */
#include "hal/app/round_sender.h"

#include <string.h>

#include "unity.h"

enum { STOPS = 2, MAP = 3, STATUS_MS = 100 };

static uint8_t bytes[JP_ROUND_BYTES_MAX];
static struct jp_round_sender sender;
static struct jp_round_link link;
static bool may_replace;
static uint8_t map;
static unsigned offers;
static unsigned data;
static unsigned lost_every; /* data; 0: none */
static enum jp_status answer;

static enum jp_status take(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    if (answer != JP_OK) {
        return answer;
    }
    if (frame->id == JP_CAN_ROUND_OFFER_FRAME_ID) {
        offers++;
        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, jp_round_link_accept_offer(&link, frame, map, may_replace));
    } else {
        TEST_ASSERT_EQUAL_UINT32(JP_CAN_ROUND_DATA_FRAME_ID, frame->id);
        data++;
        if (lost_every == 0U || data % lost_every != 0U) {
            (void)jp_round_link_accept_data(&link, frame);
        }
    }
    return JP_OK;
}

static const struct jp_can_port port = {.send = take};

static void begin(uint8_t id)
{
    const struct jp_round_bytes round = {.bytes = bytes, .stops = STOPS};

    jp_round_sender_begin(&sender, &round, MAP, id);
}

void setUp(void)
{
    for (unsigned i = 0; i < sizeof bytes; i++) {
        bytes[i] = (uint8_t)(13U * i + 1U);
    }
    memset(&sender, 0, sizeof sender);
    memset(&link, 0, sizeof link);
    may_replace = true;
    map = MAP;
    offers = 0;
    data = 0;
    lost_every = 0;
    answer = JP_OK;
    begin(5);
}

void tearDown(void)
{
}

static enum jp_round_answer hear(void)
{
    static const uint8_t states[] = {[JP_ROUND_LINK_NONE] = JP_CAN_ROUND_STATUS_STATE_NONE_CHOICE,
                                     [JP_ROUND_LINK_RECEIVING] = JP_CAN_ROUND_STATUS_STATE_RECEIVING_CHOICE,
                                     [JP_ROUND_LINK_REJECTED] = JP_CAN_ROUND_STATUS_STATE_REJECTED_CHOICE,
                                     [JP_ROUND_LINK_WHOLE] = JP_CAN_ROUND_STATUS_STATE_READY_CHOICE};
    const struct jp_can_round_status_t status = {
        .round_id = link.id, .state = states[link.state], .reason = (uint8_t)link.reason, .received = link.frames};

    return jp_round_sender_hear(&sender, &status);
}

/* So many ms, with a status each 100 ms; ends with the first answer. */
static enum jp_round_answer pass(unsigned ms)
{
    enum jp_round_answer heard = JP_ROUND_ANSWER_NONE;

    for (unsigned i = 0; i < ms && heard == JP_ROUND_ANSWER_NONE; i++) {
        jp_round_sender_pass(&sender, 1);
        jp_round_sender_send(&sender, &port);
        heard = i % STATUS_MS == STATUS_MS - 1U ? hear() : JP_ROUND_ANSWER_NONE;
    }
    return heard;
}

static void expect_whole(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ROUND_LINK_WHOLE, link.state);
    TEST_ASSERT_EQUAL_MEMORY(bytes, link.bytes, JP_ROUND_BYTES(STOPS));
}

static void test_it_offers_and_sends_what_is_asked_for(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ROUND_ANSWER_TAKEN, pass(1000));
    expect_whole();
    TEST_ASSERT_EQUAL_UINT(1, offers);
    TEST_ASSERT_EQUAL_UINT(JP_ROUND_FRAMES(STOPS), data);
    TEST_ASSERT_EQUAL_UINT8(5, link.id);
}

static void test_what_gets_lost_is_sent_again(void)
{
    lost_every = 5;
    TEST_ASSERT_EQUAL_INT(JP_ROUND_ANSWER_TAKEN, pass(5000));
    expect_whole();
    TEST_ASSERT_GREATER_THAN_UINT(JP_ROUND_FRAMES(STOPS), data);
}

static void test_an_offer_that_is_not_heard_is_made_again(void)
{
    link.id = 77; /* another round is told of */
    map = MAP;
    for (unsigned i = 0; i < 350U; i++) {
        const struct jp_can_round_status_t other = {.round_id = 77, .state = JP_CAN_ROUND_STATUS_STATE_STOPPED_CHOICE};

        jp_round_sender_pass(&sender, 1);
        jp_round_sender_send(&sender, &port);
        TEST_ASSERT_EQUAL_INT(JP_ROUND_ANSWER_NONE, jp_round_sender_hear(&sender, &other));
    }
    TEST_ASSERT_EQUAL_UINT(4, offers);
    TEST_ASSERT_EQUAL_UINT(0, data);
}

static void test_a_full_bus_takes_it_later(void)
{
    answer = JP_ERR_BUSY;
    TEST_ASSERT_EQUAL_INT(JP_ROUND_ANSWER_NONE, pass(300));
    TEST_ASSERT_EQUAL_UINT(0, offers);
    answer = JP_OK;
    TEST_ASSERT_EQUAL_INT(JP_ROUND_ANSWER_NONE, pass(STATUS_MS));
    answer = JP_ERR_BUSY;
    TEST_ASSERT_EQUAL_INT(JP_ROUND_ANSWER_NONE, pass(50));
    TEST_ASSERT_EQUAL_UINT(0, data);
    answer = JP_OK;
    TEST_ASSERT_EQUAL_INT(JP_ROUND_ANSWER_TAKEN, pass(1000));
    expect_whole();
}

static void test_a_refusal_is_heard(void)
{
    map = 0;
    TEST_ASSERT_EQUAL_INT(JP_ROUND_ANSWER_REFUSED, pass(1000));
    TEST_ASSERT_EQUAL_UINT(0, data);
}

static void test_while_another_round_is_driven_it_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ROUND_ANSWER_TAKEN, pass(1000));
    may_replace = false;
    begin(6);
    /* What was refused before it has offered anything is not its round. */
    link.reason = JP_ROUND_REASON_UNDER_WAY;
    TEST_ASSERT_EQUAL_INT(JP_ROUND_ANSWER_NONE, hear());
    TEST_ASSERT_EQUAL_INT(JP_ROUND_ANSWER_REFUSED, pass(1000));
    TEST_ASSERT_EQUAL_UINT8(5, link.id);
    may_replace = true;
    begin(7);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_ANSWER_TAKEN, pass(1000));
    TEST_ASSERT_EQUAL_UINT8(7, link.id);
}

static void test_what_it_does_with_the_round_then_is_no_answer(void)
{
    const struct jp_can_round_status_t driven = {.round_id = 5, .state = JP_CAN_ROUND_STATUS_STATE_LEAVING_CHOICE};

    TEST_ASSERT_EQUAL_INT(JP_ROUND_ANSWER_NONE, jp_round_sender_hear(&sender, &driven));
}
