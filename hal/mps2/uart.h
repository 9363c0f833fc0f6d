/** The board's UART as an SLCAN adapter: lines of frames from and to a host. */
#ifndef JOULEPATH_HAL_MPS2_UART_H
#define JOULEPATH_HAL_MPS2_UART_H

#include <stdbool.h>

#include "hal/can/can.h"

/** Opens the UART; it receives by its interrupt, which is to be enabled. */
void jp_uart_start(uint32_t baud);

/** The next frame that has come; false: none yet. From the main loop. */
bool jp_uart_receive(struct jp_can_frame *frame);

/** Sends what waits, as far as the UART takes it; true: nothing is left. From the main loop. */
bool jp_uart_flush(void);

/** Bytes have come that jp_uart_receive() has not looked at. */
bool jp_uart_has_input(void);

/** Frames go out whole or not at all. From the control interrupt and, while it cannot come, from the main loop. */
struct jp_can_port jp_uart_port(void);

#endif
