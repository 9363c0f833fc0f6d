#include "hal/mps2/uart.h"

#include <stddef.h>

#include "hal/can/slcan.h"
#include "hal/mps2/mps2_an500.h"

/** Bytes; powers of two. In lockstep a tick's frames are fewer. */
#define INPUT  8192U
#define OUTPUT 4096U

static struct {
    uint8_t input[INPUT];
    uint16_t input_head; /**< written by the receive interrupt */
    uint16_t input_tail;
    uint8_t output[OUTPUT];
    uint16_t output_head; /**< written by who sends */
    uint16_t output_tail; /**< by the main loop */
    struct jp_slcan_adapter slcan;
} serial;

static uint16_t after(uint16_t index, uint32_t size)
{
    return (uint16_t)((index + 1U) & (size - 1U));
}

void jp_uart_start(uint32_t baud)
{
    UART0.BAUDDIV = CORE_HZ / baud;
    UART0.CTRL = UART_CTRL_TX | UART_CTRL_RX | UART_CTRL_RX_IRQ;
}

/** A byte without room is lost, and its line with it, which SLCAN counts as malformed. */
void UART0_RX_Handler(void);

void UART0_RX_Handler(void)
{
    const uint16_t next = after(serial.input_head, INPUT);

    UART0.INTCLEAR = UART_INT_RX;
    if ((UART0.STATE & UART_STATE_RX_FULL) == 0U) {
        return;
    }
    serial.input[serial.input_head] = (uint8_t)UART0.DATA;
    if (next != __atomic_load_n(&serial.input_tail, __ATOMIC_ACQUIRE)) {
        __atomic_store_n(&serial.input_head, next, __ATOMIC_RELEASE);
    }
}

bool jp_uart_has_input(void)
{
    return serial.input_tail != __atomic_load_n(&serial.input_head, __ATOMIC_ACQUIRE);
}

static unsigned room(void)
{
    return (__atomic_load_n(&serial.output_tail, __ATOMIC_ACQUIRE) - serial.output_head - 1U) & (OUTPUT - 1U);
}

static bool put(const char *text, unsigned length)
{
    uint16_t head = serial.output_head;

    if (length > room()) {
        return false;
    }
    for (unsigned i = 0; i < length; i++) {
        serial.output[head] = (uint8_t)text[i];
        head = after(head, OUTPUT);
    }
    __atomic_store_n(&serial.output_head, head, __ATOMIC_RELEASE);
    return true;
}

static void answer(const char *text)
{
    unsigned length = 0;

    while (text[length] != '\0') {
        length++;
    }
    (void)put(text, length);
}

bool jp_uart_receive(struct jp_can_frame *frame)
{
    while (jp_uart_has_input()) {
        const uint8_t byte = serial.input[serial.input_tail];
        const char *text;
        bool is_frame;

        __atomic_store_n(&serial.input_tail, after(serial.input_tail, INPUT), __ATOMIC_RELEASE);
        is_frame = jp_slcan_adapter_take(&serial.slcan, byte, &text);
        answer(text);
        if (is_frame) {
            *frame = serial.slcan.decoder.frame;
            return true;
        }
    }
    return false;
}

bool jp_uart_flush(void)
{
    while (serial.output_tail != __atomic_load_n(&serial.output_head, __ATOMIC_ACQUIRE)) {
        if ((UART0.STATE & UART_STATE_TX_FULL) != 0U) {
            return false;
        }
        UART0.DATA = serial.output[serial.output_tail];
        __atomic_store_n(&serial.output_tail, after(serial.output_tail, OUTPUT), __ATOMIC_RELEASE);
    }
    return true;
}

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    char line[JP_SLCAN_LINE_MAX];
    const unsigned length = jp_slcan_encode(line, frame);

    (void)context;
    if (length == 0U) {
        return JP_ERR_ARGUMENT;
    }
    if (!serial.slcan.open) {
        return JP_ERR_HARDWARE;
    }
    return put(line, length) ? JP_OK : JP_ERR_BUSY;
}

static enum jp_can_state state(void *context)
{
    (void)context;
    return serial.slcan.open ? JP_CAN_ON : JP_CAN_DOWN;
}

struct jp_can_port jp_uart_port(void)
{
    return (struct jp_can_port){.context = NULL, .send = send, .state = state};
}
