/* The serial line as a bus, against a USART in memory. */
#include "hal/stm32f4/serial.h"

#include <string.h>

#include "tests/support/stm32_fake.h"
#include "unity.h"

static struct jp_serial serial;
static struct jp_can_port port;

void setUp(void)
{
    stm32_fake_reset();
    jp_serial_start(&serial, 84000000, 1000000);
    jp_serial_port(&serial, &port);
}

void tearDown(void)
{
}

static void arrive(const char *text)
{
    for (const char *c = text; *c != '\0'; c++) {
        USART1.SR = USART_SR_RXNE;
        USART1.DR = (uint8_t)*c;
        jp_serial_on_receive(&serial);
    }
    USART1.SR = 0;
}

static const struct jp_can_frame sent = {.id = 0x123, .length = 2, .data = {0xBE, 0xEF}};

/** As a host does; the answers go out. */
static void open_channel(void)
{
    struct jp_can_frame frame;

    arrive("C\rS8\rO\r");
    USART1.SR = USART_SR_TXE;
    while (jp_serial_has_input(&serial)) {
        TEST_ASSERT_FALSE(jp_serial_receive(&serial, &frame));
        TEST_ASSERT_TRUE(jp_serial_flush(&serial));
    }
    USART1.SR = 0;
    TEST_ASSERT_EQUAL_INT(JP_CAN_ON, port.state(port.context));
}

static void test_the_line_is_set_up(void)
{
    TEST_ASSERT_BITS_HIGH(RCC_APB2ENR_USART1EN, RCC.APB2ENR);
    TEST_ASSERT_EQUAL_UINT32(84, USART1.BRR);
    TEST_ASSERT_BITS_HIGH(USART_CR1_UE | USART_CR1_TE | USART_CR1_RE | USART_CR1_RXNEIE, USART1.CR1);
}

static void test_the_bus_is_down_until_the_host_opens_it(void)
{
    TEST_ASSERT_EQUAL_INT(JP_CAN_DOWN, port.state(port.context));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, port.send(port.context, &sent));
    open_channel();
    TEST_ASSERT_EQUAL_INT(JP_OK, port.send(port.context, &sent));
}

static void test_frames_arrive(void)
{
    struct jp_can_frame frame;

    open_channel();
    arrive("t0203ABCDEF\rt7F10\r");
    TEST_ASSERT_TRUE(jp_serial_receive(&serial, &frame));
    TEST_ASSERT_EQUAL_HEX32(0x020, frame.id);
    TEST_ASSERT_EQUAL_UINT8(3, frame.length);
    TEST_ASSERT_EQUAL_HEX8(0xEF, frame.data[2]);
    USART1.SR = USART_SR_TXE;
    TEST_ASSERT_TRUE(jp_serial_flush(&serial));
    TEST_ASSERT_TRUE(jp_serial_receive(&serial, &frame));
    TEST_ASSERT_EQUAL_HEX32(0x7F1, frame.id);
    TEST_ASSERT_TRUE(jp_serial_flush(&serial));
    TEST_ASSERT_FALSE(jp_serial_receive(&serial, &frame));
}

static void test_a_frame_goes_out_as_a_line(void)
{
    open_channel();
    TEST_ASSERT_EQUAL_INT(JP_OK, port.send(port.context, &sent));
    TEST_ASSERT_EQUAL_MEMORY("t1232BEEF\r", serial.output, 10);
    TEST_ASSERT_FALSE(jp_serial_flush(&serial));
    TEST_ASSERT_EQUAL_UINT16(0, serial.output_tail);
    USART1.SR = USART_SR_TXE;
    TEST_ASSERT_TRUE(jp_serial_flush(&serial));
    TEST_ASSERT_EQUAL_UINT16(10, serial.output_tail);
    TEST_ASSERT_EQUAL_UINT32('\r', USART1.DR);
}

/** The interrupt of a tick may have put a line in while another one is half out. */
static void test_an_answer_waits_for_the_end_of_the_line(void)
{
    struct jp_can_frame frame;

    open_channel();
    TEST_ASSERT_EQUAL_INT(JP_OK, port.send(port.context, &sent));
    serial.output_tail = 3;
    serial.in_line = true;
    arrive("V\r");
    TEST_ASSERT_FALSE(jp_serial_receive(&serial, &frame));
    TEST_ASSERT_EQUAL_INT('V', serial.answer[0]);
    TEST_ASSERT_EQUAL_INT(JP_OK, port.send(port.context, &sent));
    USART1.SR = USART_SR_TXE;
    TEST_ASSERT_TRUE(jp_serial_flush(&serial));
    TEST_ASSERT_NULL(serial.answer);
    TEST_ASSERT_EQUAL_UINT16(20, serial.output_tail);
    TEST_ASSERT_FALSE(serial.in_line);
}

static void test_no_input_is_taken_while_an_answer_waits(void)
{
    struct jp_can_frame frame;

    arrive("V\rV\r");
    TEST_ASSERT_FALSE(jp_serial_receive(&serial, &frame));
    TEST_ASSERT_TRUE(jp_serial_has_input(&serial));
    TEST_ASSERT_FALSE(jp_serial_receive(&serial, &frame));
    TEST_ASSERT_TRUE(jp_serial_has_input(&serial));
    USART1.SR = USART_SR_TXE;
    TEST_ASSERT_TRUE(jp_serial_flush(&serial));
    TEST_ASSERT_FALSE(jp_serial_receive(&serial, &frame));
    TEST_ASSERT_FALSE(jp_serial_has_input(&serial));
}

static void test_a_line_that_does_not_drain_is_busy_and_loses_whole_lines_only(void)
{
    unsigned taken = 0;

    open_channel();
    while (port.send(port.context, &sent) == JP_OK) {
        taken++;
    }
    TEST_ASSERT_EQUAL_UINT((JP_SERIAL_OUTPUT - 1U) / 10U, taken);
    TEST_ASSERT_EQUAL_INT(JP_ERR_BUSY, port.send(port.context, &sent));
    USART1.SR = USART_SR_TXE;
    TEST_ASSERT_TRUE(jp_serial_flush(&serial));
    TEST_ASSERT_FALSE(serial.in_line);
    TEST_ASSERT_EQUAL_INT(JP_OK, port.send(port.context, &sent));
}

static void test_a_frame_that_is_none_is_refused(void)
{
    const struct jp_can_frame wrong = {.id = 0x800, .length = 0};

    open_channel();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, port.send(port.context, &wrong));
}

static void test_an_input_that_is_not_taken_loses_bytes_and_counts_them(void)
{
    for (unsigned i = 0; i < JP_SERIAL_INPUT + 9U; i++) {
        arrive("x");
    }
    TEST_ASSERT_EQUAL_UINT16(10, serial.lost);
}

static void test_bytes_that_the_usart_lost_are_counted(void)
{
    USART1.SR = USART_SR_RXNE | USART_SR_ORE;
    USART1.DR = 'x';
    jp_serial_on_receive(&serial);
    TEST_ASSERT_EQUAL_UINT16(1, serial.lost);
    TEST_ASSERT_TRUE(jp_serial_has_input(&serial));
    serial.lost = UINT16_MAX;
    jp_serial_on_receive(&serial);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, serial.lost);
}

static void test_an_interrupt_without_a_byte_does_nothing(void)
{
    USART1.SR = 0;
    jp_serial_on_receive(&serial);
    TEST_ASSERT_FALSE(jp_serial_has_input(&serial));
    TEST_ASSERT_EQUAL_UINT16(0, serial.lost);
}

static void test_both_rings_wrap(void)
{
    struct jp_can_frame frame;

    open_channel();
    for (unsigned i = 0; i < JP_SERIAL_OUTPUT; i++) {
        arrive("t1232BEEF\r");
        TEST_ASSERT_TRUE(jp_serial_receive(&serial, &frame));
        TEST_ASSERT_EQUAL_MEMORY(sent.data, frame.data, 2);
        TEST_ASSERT_EQUAL_INT(JP_OK, port.send(port.context, &sent));
        USART1.SR = USART_SR_TXE;
        TEST_ASSERT_TRUE(jp_serial_flush(&serial));
    }
    TEST_ASSERT_EQUAL_UINT16(0, serial.lost);
}
