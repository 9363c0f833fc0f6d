#include "hal/stm32f4/serial.h"

#include <joulepath/count.h>
#include <stddef.h>

#include "hal/stm32f4/board.h"
#include "hal/stm32f4/pins.h"
#include "hal/stm32f4/stm32f405.h"

static uint16_t after(uint16_t index, uint32_t size)
{
    return (uint16_t)((index + 1U) & (size - 1U));
}

void jp_serial_start(struct jp_serial *serial, uint32_t clock_hz, uint32_t baud)
{
    *serial = (struct jp_serial){.lost = 0};
    RCC.APB2ENR |= RCC_APB2ENR_USART1EN;
    jp_pin_drive(BOARD_SERIAL_TX);
    jp_pin_listen(BOARD_SERIAL_RX);
    USART1.BRR = (clock_hz + baud / 2U) / baud;
    USART1.CR1 = USART_CR1_UE | USART_CR1_TE | USART_CR1_RE | USART_CR1_RXNEIE;
}

void jp_serial_on_receive(struct jp_serial *serial)
{
    const uint32_t status = USART1.SR;
    const uint16_t next = after(serial->input_head, JP_SERIAL_INPUT);

    if ((status & USART_SR_ORE) != 0U) {
        serial->lost = jp_one_more16(serial->lost);
    }
    if ((status & (USART_SR_RXNE | USART_SR_ORE)) == 0U) {
        return;
    }
    serial->input[serial->input_head] = (uint8_t)USART1.DR;
    if (next == __atomic_load_n(&serial->input_tail, __ATOMIC_ACQUIRE)) {
        serial->lost = jp_one_more16(serial->lost);
    } else {
        __atomic_store_n(&serial->input_head, next, __ATOMIC_RELEASE);
    }
}

bool jp_serial_has_input(const struct jp_serial *serial)
{
    return serial->input_tail != __atomic_load_n(&serial->input_head, __ATOMIC_ACQUIRE);
}

static uint16_t room(const struct jp_serial *serial)
{
    const uint16_t tail = __atomic_load_n(&serial->output_tail, __ATOMIC_ACQUIRE);

    return (uint16_t)((tail - serial->output_head - 1U) & (JP_SERIAL_OUTPUT - 1U));
}

/** A text goes out whole or not at all. */
static bool put(struct jp_serial *serial, const char *text, unsigned length)
{
    uint16_t head = serial->output_head;

    if (length > room(serial)) {
        return false;
    }
    for (unsigned i = 0; i < length; i++) {
        serial->output[head] = (uint8_t)text[i];
        head = after(head, JP_SERIAL_OUTPUT);
    }
    __atomic_store_n(&serial->output_head, head, __ATOMIC_RELEASE);
    return true;
}

bool jp_serial_receive(struct jp_serial *serial, struct jp_can_frame *frame)
{
    while (serial->answer == NULL && jp_serial_has_input(serial)) {
        const uint8_t byte = serial->input[serial->input_tail];
        const char *answer;
        bool is_frame;

        __atomic_store_n(&serial->input_tail, after(serial->input_tail, JP_SERIAL_INPUT), __ATOMIC_RELEASE);
        is_frame = jp_slcan_adapter_take(&serial->slcan, byte, &answer);
        serial->answer = answer[0] == '\0' ? NULL : answer;
        if (is_frame) {
            *frame = serial->slcan.decoder.frame;
            return true;
        }
    }
    return false;
}

/** The byte to be sent next; false: none. An answer goes between two lines. */
static bool peek(const struct jp_serial *serial, uint8_t *byte)
{
    if (serial->answer != NULL && !serial->in_line) {
        *byte = (uint8_t)*serial->answer;
        return true;
    }
    *byte = serial->output[serial->output_tail];
    return serial->output_tail != __atomic_load_n(&serial->output_head, __ATOMIC_ACQUIRE);
}

static void drop_sent(struct jp_serial *serial, uint8_t byte)
{
    if (serial->answer != NULL && !serial->in_line) {
        serial->answer = serial->answer[1] == '\0' ? NULL : serial->answer + 1;
        return;
    }
    serial->in_line = byte != (uint8_t)'\r';
    __atomic_store_n(&serial->output_tail, after(serial->output_tail, JP_SERIAL_OUTPUT), __ATOMIC_RELEASE);
}

bool jp_serial_flush(struct jp_serial *serial)
{
    uint8_t byte;

    while (peek(serial, &byte)) {
        if ((USART1.SR & USART_SR_TXE) == 0U) {
            return false;
        }
        USART1.DR = byte;
        drop_sent(serial, byte);
    }
    return true;
}

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    struct jp_serial *serial = context;
    char line[JP_SLCAN_LINE_MAX];
    const unsigned length = jp_slcan_encode(line, frame);

    if (length == 0U) {
        return JP_ERR_ARGUMENT;
    }
    if (!serial->slcan.open) {
        return JP_ERR_HARDWARE;
    }
    return put(serial, line, length) ? JP_OK : JP_ERR_BUSY;
}

static enum jp_can_state state(void *context)
{
    const struct jp_serial *serial = context;

    return serial->slcan.open ? JP_CAN_ON : JP_CAN_DOWN;
}

void jp_serial_port(struct jp_serial *serial, struct jp_can_port *port)
{
    *port = (struct jp_can_port){.context = serial, .send = send, .state = state};
}
