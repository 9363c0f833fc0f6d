#include "hal/app/operator_bus.h"

#include <joulepath/e2e.h>

#define SILENCE_MS 1000U

void jp_operator_ear_age(struct jp_operator_ear *ear, uint32_t elapsed_ms)
{
    ear->silence_ms += elapsed_ms;
    if (ear->silence_ms >= SILENCE_MS) {
        ear->heard = false;
    }
}

bool jp_operator_send(const struct jp_can_port *port, struct jp_can_frame *frame, uint8_t data_id, uint8_t *counter)
{
    uint8_t next = *counter;

    jp_e2e_protect(&next, data_id, frame->data, frame->length);
    if (port->send(port->context, frame) != JP_OK) {
        return false;
    }
    *counter = next;
    return true;
}
