/* bxCAN: a controller that is not there, order over queue and mailboxes, full queues, overruns, bus-off and back. */
#include "hal/stm32f4/can_controller.h"

#include <string.h>

#include "hal/stm32f4/board.h"
#include "tests/support/stm32_fake.h"

#include "unity.h"

#define MAILBOXES  3U
#define ALL_EMPTY  (CAN_TSR_TME0 | CAN_TSR_TME1 | CAN_TSR_TME2)
#define LOG_LENGTH 128U

static struct jp_can_controller can;
static struct jp_can_port port;

static struct jp_can_frame received[LOG_LENGTH];
static unsigned received_count;

/* The bus: takes the frame that was requested first. */
static struct jp_can_frame sent[LOG_LENGTH];
static unsigned sent_count;
static unsigned requested[MAILBOXES]; /* order of the requests, 0: none */
static unsigned requests;

static void receive(void *context, const struct jp_can_frame *frame)
{
    TEST_ASSERT_EQUAL_PTR(&received, context);
    received[received_count % LOG_LENGTH] = *frame;
    received_count++;
}

static void start(void)
{
    stm32_fake_reset();
    received_count = 0;
    sent_count = 0;
    requests = 0;
    memset(requested, 0, sizeof requested);
    (void)jp_can_controller_start(&can, receive, &received);
    port = jp_can_controller_port(&can);
}

void setUp(void)
{
    start();
}

void tearDown(void)
{
}

/* ---- What the controller does by itself ---- */

/* A mailbox with a request is not empty. */
static void take_requests(void)
{
    for (unsigned i = 0; i < MAILBOXES; i++) {
        if ((CAN1.T[i].IR & CAN_TIR_TXRQ) != 0U && requested[i] == 0U) {
            requested[i] = ++requests;
        }
    }
    CAN1.TSR = 0;
    for (unsigned i = 0; i < MAILBOXES; i++) {
        CAN1.TSR |= requested[i] == 0U ? CAN_TSR_TME0 << i : 0U;
    }
}

static enum jp_status send(const struct jp_can_frame *frame)
{
    const enum jp_status status = port.send(port.context, frame);

    take_requests();
    return status;
}

static unsigned first_requested(void)
{
    unsigned first = MAILBOXES;

    for (unsigned i = 0; i < MAILBOXES; i++) {
        if (requested[i] != 0U && (first == MAILBOXES || requested[i] < requested[first])) {
            first = i;
        }
    }
    return first;
}

static void log_sent(const volatile struct stm32_can_mailbox *mailbox)
{
    struct jp_can_frame frame = {.id = mailbox->IR >> 21, .length = (uint8_t)(mailbox->DTR & 0xFU)};

    for (unsigned i = 0; i < 4U; i++) {
        frame.data[i] = (uint8_t)(mailbox->DLR >> (8U * i));
        frame.data[4U + i] = (uint8_t)(mailbox->DHR >> (8U * i));
    }
    sent[sent_count % LOG_LENGTH] = frame;
    sent_count++;
}

/* The frame is on the bus, the mailbox empty, and the interrupt comes. False: there was none. */
static bool transmit(void)
{
    const unsigned mailbox = first_requested();

    if (mailbox == MAILBOXES) {
        return false;
    }
    log_sent(&CAN1.T[mailbox]);
    CAN1.T[mailbox].IR &= ~CAN_TIR_TXRQ;
    requested[mailbox] = 0;
    CAN1.TSR |= (CAN_TSR_TME0 << mailbox) | (CAN_TSR_RQCP0 << (8U * mailbox));
    jp_can_controller_on_transmit(&can);
    take_requests();
    return true;
}

static void arrive(struct jp_can_frame frame)
{
    CAN1.R[0].IR = frame.id << 21;
    CAN1.R[0].DTR = 0xAB000000U | frame.length; /* with a time stamp */
    CAN1.R[0].DLR = 0;
    CAN1.R[0].DHR = 0;
    for (unsigned i = 0; i < 4U; i++) {
        CAN1.R[0].DLR |= (uint32_t)frame.data[i] << (8U * i);
        CAN1.R[0].DHR |= (uint32_t)frame.data[4U + i] << (8U * i);
    }
    CAN1.RF0R = CAN_RF0R_FMP0(1);
    jp_can_controller_on_receive(&can);
}

static struct jp_can_frame numbered(unsigned number)
{
    struct jp_can_frame frame = {.id = number % 0x800U, .length = (uint8_t)(number % 9U)};

    for (unsigned i = 0; i < 8U; i++) {
        frame.data[i] = (uint8_t)(number * 31U + i * 7U);
    }
    return frame;
}

static void check_frame(struct jp_can_frame expected, struct jp_can_frame frame)
{
    TEST_ASSERT_EQUAL_HEX32(expected.id, frame.id);
    TEST_ASSERT_EQUAL_UINT(expected.length, frame.length);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected.data, frame.data, JP_CAN_LENGTH_MAX);
}

/* ---- Start ---- */

static void test_start(void)
{
    TEST_ASSERT_TRUE(can.present);
    TEST_ASSERT_EQUAL_INT(JP_CAN_ON, port.state(port.context));
    CHECK_SET(RCC_APB1ENR_CAN1EN, RCC.APB1ENR);
    CHECK_SET(CAN_MCR_TXFP | CAN_MCR_RFLM | CAN_MCR_ABOM, CAN1.MCR);
    CHECK_CLEAR(CAN_MCR_SLEEP | CAN_MCR_INRQ, CAN1.MCR);
    CHECK_SET(CAN_IER_TMEIE | CAN_IER_FMPIE0 | CAN_IER_BOFIE | CAN_IER_ERRIE, CAN1.IER);
}

static void test_bit_timing(void)
{
    const uint32_t prescaler = (CAN1.BTR & 0x3FFU) + 1U;
    const uint32_t before = 1U + ((CAN1.BTR >> 16) & 0xFU) + 1U;
    const uint32_t after = ((CAN1.BTR >> 20) & 7U) + 1U;
    const uint32_t jump = ((CAN1.BTR >> 24) & 3U) + 1U;
    const uint32_t permille = 1000U * before / (before + after);

    TEST_ASSERT_EQUAL_UINT32(1000000, 42000000U / (prescaler * (before + after)));
    TEST_ASSERT_TRUE(permille >= 750U && permille <= 875U);
    TEST_ASSERT_TRUE(jump <= after);
    CHECK_CLEAR(0xC0000000U, CAN1.BTR); /* neither silent nor looped back */
}

static void test_only_standard_data_frames_come_in(void)
{
    const uint32_t id_of_any_kind = 0x7FFU << 21;

    TEST_ASSERT_EQUAL_HEX32(1, CAN1.FA1R);
    TEST_ASSERT_EQUAL_HEX32(1, CAN1.FS1R);
    TEST_ASSERT_EQUAL_HEX32(0, CAN1.FM1R | CAN1.FFA1R);
    TEST_ASSERT_EQUAL_HEX32(0, CAN1.F[0].R1);
    TEST_ASSERT_EQUAL_HEX32(CAN_RIR_IDE | CAN_RIR_RTR, CAN1.F[0].R2);
    CHECK_CLEAR(id_of_any_kind, CAN1.F[0].R2);
    CHECK_CLEAR(CAN_FMR_FINIT, CAN1.FMR);
}

static void check_down(void)
{
    const struct jp_can_frame frame = numbered(1);

    TEST_ASSERT_FALSE(jp_can_controller_start(&can, receive, &received));
    port = jp_can_controller_port(&can);
    TEST_ASSERT_EQUAL_INT(JP_CAN_DOWN, port.state(port.context));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, send(&frame));
    TEST_ASSERT_EQUAL_HEX32(0, CAN1.IER);
    TEST_ASSERT_EQUAL_UINT(1, fake.failed_waits);
    TEST_ASSERT_TRUE(fake.polls < 250000U);
}

static void test_a_controller_that_is_not_there(void)
{
    stm32_fake_reset();
    fake.can_init = FAKE_NEVER;
    check_down();
}

static void test_a_bus_that_lets_nobody_on(void)
{
    stm32_fake_reset();
    fake.can_join = FAKE_NEVER;
    check_down();
    CHECK_SET(CAN_MCR_INRQ, CAN1.MCR);
}

/* 11 bits after the last dominant one; up to 8 ms of the core's time. */
static void test_a_busy_bus_is_waited_for(void)
{
    stm32_fake_reset();
    fake.can_join = 130000;
    TEST_ASSERT_TRUE(jp_can_controller_start(&can, receive, &received));
}

/* ---- Out ---- */

static void test_a_frame_goes_out_as_it_is(void)
{
    for (unsigned i = 0; i < 100U; i++) {
        const struct jp_can_frame frame = numbered(i * 41U);

        TEST_ASSERT_EQUAL_INT(JP_OK, send(&frame));
        TEST_ASSERT_TRUE(transmit());
        check_frame(frame, sent[i]);
    }
}

static void test_other_frames_than_standard_data_are_refused(void)
{
    struct jp_can_frame frame = {.id = 0x800, .length = 8};

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, send(&frame));
    frame.id = JP_CAN_EXTENDED | 1U;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, send(&frame));
    frame.id = JP_CAN_REMOTE | 1U;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, send(&frame));
    frame = (struct jp_can_frame){.id = 1, .length = 9};
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, send(&frame));
    TEST_ASSERT_FALSE(transmit());
}

static unsigned fill_up(void)
{
    unsigned accepted = 0;
    struct jp_can_frame frame = numbered(accepted);

    while (send(&frame) == JP_OK) {
        accepted++;
        frame = numbered(accepted);
    }
    return accepted;
}

static void check_sent_in_order(unsigned count)
{
    TEST_ASSERT_EQUAL_UINT(count, sent_count);
    for (unsigned i = 0; i < count; i++) {
        check_frame(numbered(i), sent[i]);
    }
}

static void test_a_full_queue_refuses_and_keeps_its_order(void)
{
    const struct jp_can_frame more = numbered(99);

    TEST_ASSERT_EQUAL_UINT(MAILBOXES + JP_CAN_QUEUE, fill_up());
    TEST_ASSERT_EQUAL_INT(JP_ERR_BUSY, send(&more));
    while (transmit()) {
    }
    check_sent_in_order(MAILBOXES + JP_CAN_QUEUE);
}

static void test_room_comes_back_frame_by_frame(void)
{
    const struct jp_can_frame more = numbered(MAILBOXES + JP_CAN_QUEUE);

    (void)fill_up();
    (void)transmit();
    TEST_ASSERT_EQUAL_INT(JP_OK, send(&more));
    TEST_ASSERT_EQUAL_INT(JP_ERR_BUSY, send(&more));
    while (transmit()) {
    }
    check_sent_in_order(MAILBOXES + JP_CAN_QUEUE + 1U);
}

/* Bursts and pauses of all lengths, so that the queue wraps at every place. */
static void test_order_is_kept_over_bursts(void)
{
    unsigned queued = 0;

    for (unsigned burst = 0; queued < LOG_LENGTH - 20U; burst++) {
        for (unsigned i = 0; i < burst % 17U; i++) {
            const struct jp_can_frame frame = numbered(queued);

            queued += send(&frame) == JP_OK ? 1U : 0U;
        }
        for (unsigned i = 0; i < burst % 5U + burst % 7U; i++) {
            (void)transmit();
        }
    }
    while (transmit()) {
    }
    check_sent_in_order(queued);
}

/* Its interrupt is still to come: the flag must not be cleared with those that were seen. */
static void test_only_mailboxes_that_were_seen_are_acknowledged(void)
{
    CAN1.TSR = ALL_EMPTY | CAN_TSR_RQCP1;
    jp_can_controller_on_transmit(&can);
    TEST_ASSERT_EQUAL_HEX32(CAN_TSR_RQCP1, CAN1.TSR);
}

/* ---- In ---- */

static void test_frames_come_in_as_they_are(void)
{
    for (unsigned i = 0; i < 100U; i++) {
        arrive(numbered(i * 41U));
        TEST_ASSERT_EQUAL_HEX32(CAN_RF0R_RFOM0, CAN1.RF0R); /* released */
        TEST_ASSERT_EQUAL_UINT(i + 1U, received_count);
        check_frame(numbered(i * 41U), received[i]);
    }
}

/* CAN allows lengths up to 15, which mean 8. */
static void test_lengths_beyond_8_are_8(void)
{
    for (unsigned length = 0; length < 16U; length++) {
        arrive((struct jp_can_frame){.id = 1, .length = (uint8_t)length});
        TEST_ASSERT_EQUAL_UINT(length < 8U ? length : 8U, received[length].length);
    }
}

static void test_an_interrupt_without_a_frame(void)
{
    CAN1.RF0R = 0;
    jp_can_controller_on_receive(&can);
    TEST_ASSERT_EQUAL_UINT(0, received_count);
}

/* The frame that was read last still counts until the release is done. */
static void test_a_frame_that_is_being_released_is_not_read_again(void)
{
    CAN1.RF0R = CAN_RF0R_FMP0(1) | CAN_RF0R_RFOM0;
    jp_can_controller_on_receive(&can);
    TEST_ASSERT_EQUAL_UINT(0, received_count);
}

static void test_overruns_are_counted_and_cost_no_frame(void)
{
    CAN1.RF0R = CAN_RF0R_FMP0(3) | CAN_RF0R_FOVR0;
    jp_can_controller_on_receive(&can);
    TEST_ASSERT_EQUAL_UINT(1, can.overruns);
    TEST_ASSERT_EQUAL_UINT(1, received_count);

    can.overruns = UINT16_MAX;
    CAN1.RF0R = CAN_RF0R_FOVR0;
    jp_can_controller_on_receive(&can);
    TEST_ASSERT_EQUAL_UINT(UINT16_MAX, can.overruns);
    TEST_ASSERT_EQUAL_HEX32(CAN_RF0R_FOVR0, CAN1.RF0R); /* acknowledged */
}

/* ---- Bus-off ---- */

static void leave_bus(void)
{
    CAN1.ESR = CAN_ESR_BOFF;
    CAN1.MSR = CAN_MSR_ERRI | (3U << 10); /* with the levels of the pins */
    jp_can_controller_on_error(&can);
    TEST_ASSERT_EQUAL_HEX32(CAN_MSR_ERRI, CAN1.MSR); /* acknowledged */
    CAN1.MSR = 0;
    /* Aborted. */
    TEST_ASSERT_EQUAL_HEX32(CAN_TSR_ABRQ0 | CAN_TSR_ABRQ1 | CAN_TSR_ABRQ2, CAN1.TSR);
    for (unsigned i = 0; i < MAILBOXES; i++) {
        CAN1.T[i].IR &= ~CAN_TIR_TXRQ;
        requested[i] = 0;
    }
    take_requests();
}

static void test_bus_off_drops_what_waits(void)
{
    const struct jp_can_frame frame = numbered(1);

    (void)fill_up();
    leave_bus();
    TEST_ASSERT_EQUAL_INT(JP_CAN_BUS_OFF, port.state(port.context));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, send(&frame));
    TEST_ASSERT_EQUAL_UINT(1, can.bus_offs);
    TEST_ASSERT_EQUAL_UINT(MAILBOXES + JP_CAN_QUEUE, can.dropped);
    TEST_ASSERT_FALSE(transmit());
}

static void test_after_bus_off_only_new_frames_go_out(void)
{
    const struct jp_can_frame frame = numbered(77);

    (void)fill_up();
    leave_bus();
    CAN1.ESR = 0;
    TEST_ASSERT_EQUAL_INT(JP_CAN_ON, port.state(port.context));
    TEST_ASSERT_EQUAL_INT(JP_OK, send(&frame));
    TEST_ASSERT_TRUE(transmit());
    TEST_ASSERT_FALSE(transmit());
    check_frame(frame, sent[0]);
}

static void test_bus_off_with_nothing_waiting_drops_nothing(void)
{
    leave_bus();
    TEST_ASSERT_EQUAL_UINT(1, can.bus_offs);
    TEST_ASSERT_EQUAL_UINT(0, can.dropped);
    leave_bus();
    TEST_ASSERT_EQUAL_UINT(2, can.bus_offs);
}

static void test_counts_saturate(void)
{
    can.bus_offs = UINT16_MAX;
    can.dropped = UINT16_MAX - 2U;
    (void)fill_up();
    leave_bus();
    TEST_ASSERT_EQUAL_UINT(UINT16_MAX, can.bus_offs);
    TEST_ASSERT_EQUAL_UINT(UINT16_MAX, can.dropped);
}

static void test_an_error_interrupt_without_an_error(void)
{
    (void)fill_up();
    CAN1.MSR = 0;
    jp_can_controller_on_error(&can);
    TEST_ASSERT_EQUAL_UINT(0, can.bus_offs);
    while (transmit()) {
    }
    check_sent_in_order(MAILBOXES + JP_CAN_QUEUE);
}
