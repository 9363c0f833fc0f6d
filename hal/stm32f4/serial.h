/**
 * USART1, 8N1, as the line of an SLCAN adapter: for a bench, and where the controller for CAN is not there.
 *
 * Bytes arrive by interrupt; the main loop takes them and drains the output, so that a tick never waits for the line.
 */
#ifndef JOULEPATH_HAL_STM32F4_SERIAL_H
#define JOULEPATH_HAL_STM32F4_SERIAL_H

#include "hal/can/can.h"
#include "hal/can/slcan.h"

/** Bytes; powers of two. A tick's frames are up to 300 of them. */
#define JP_SERIAL_INPUT  1024U
#define JP_SERIAL_OUTPUT 2048U

struct jp_serial {
    struct jp_slcan_adapter slcan;
    uint8_t input[JP_SERIAL_INPUT];
    uint16_t input_head; /**< written by the interrupt */
    uint16_t input_tail; /**< written by the main loop */
    uint8_t output[JP_SERIAL_OUTPUT];
    uint16_t output_head; /**< written by the sender, which runs at most at the control interrupt's priority */
    uint16_t output_tail; /**< written by the main loop */
    bool in_line;         /**< a part of a line was sent */
    const char *answer;   /**< to the host, waits for the end of a line; NULL: none */
    uint16_t lost;        /**< bytes that came while the input was full or not fetched in time, saturating */
};

/** Opens the line; `clock_hz` is that of the peripheral. */
void jp_serial_start(struct jp_serial *serial, uint32_t clock_hz, uint32_t baud);

/** The receive interrupt. Constant time. */
void jp_serial_on_receive(struct jp_serial *serial);

/** Decodes what has arrived up to the next frame; answers the host's commands. True: *frame is one. Main loop. */
bool jp_serial_receive(struct jp_serial *serial, struct jp_can_frame *frame);

/** Sends what the line takes at once. True: nothing is left. Main loop. */
bool jp_serial_flush(struct jp_serial *serial);

/** True: bytes wait to be decoded. */
bool jp_serial_has_input(const struct jp_serial *serial);

/** The line as a bus: frames are lines of SLCAN. Down until the host opens the channel. */
void jp_serial_port(struct jp_serial *serial, struct jp_can_port *port);

#endif
