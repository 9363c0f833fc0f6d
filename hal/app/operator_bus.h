/** What every operator has of the bus: an ear for each status that the ECU sends again and again, and protected frames
 *  out. Constant time. */
#ifndef JOULEPATH_HAL_APP_OPERATOR_BUS_H
#define JOULEPATH_HAL_APP_OPERATOR_BUS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/can/can.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Something that the ECU sends again and again. */
struct jp_operator_ear {
    uint32_t silence_ms;
    bool heard; /**< within the last second */
};

/** Nothing was heard for so many ms more. */
void jp_operator_ear_age(struct jp_operator_ear *ear, uint32_t elapsed_ms);

/** Sends a frame with its counter and CRC. False: the port did not take it, and the counter stays. */
bool jp_operator_send(const struct jp_can_port *port, struct jp_can_frame *frame, uint8_t data_id, uint8_t *counter);

#ifdef __cplusplus
}
#endif

#endif
