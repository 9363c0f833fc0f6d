/** A port of a bus that takes frames or refuses them, and is on or off. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_PORT_H
#define JOULEPATH_TESTS_PROOF_ANY_PORT_H

#include "hal/can/can.h"
#include "tests/proof/any.h"

static enum jp_status any_send(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    (void)frame;
    return any_bool() ? JP_OK : JP_ERR_HARDWARE;
}

static enum jp_can_state any_can_state(void *context)
{
    (void)context;
    return (enum jp_can_state)any_between(JP_CAN_ON, JP_CAN_DOWN);
}

static const struct jp_can_port any_port = {.send = any_send, .state = any_can_state};

#endif
