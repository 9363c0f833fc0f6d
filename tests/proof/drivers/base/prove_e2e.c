/** Any messages and receivers: 64 bytes are what a frame of CAN FD holds. */
#include <joulepath/e2e.h>

#include "tests/proof/any.h"

#define LENGTH 64U

static uint8_t message[LENGTH];
static uint8_t rest[LENGTH];

int main(void)
{
    struct jp_e2e_receiver receiver;
    uint8_t counter = (uint8_t)any_unsigned(UINT8_MAX);
    const uint8_t data_id = (uint8_t)any_unsigned(UINT8_MAX);
    const size_t length = any_unsigned(LENGTH);
    const size_t rest_length = any_unsigned(LENGTH);

    ANY(receiver);
    receiver.synchronised = any_bool();
    receiver.doubted = any_bool();
    ANY(message);
    ANY(rest);
    (void)jp_e2e_crc(counter, message, length);
    ANY_TIMES
    {
        (void)jp_e2e_check(&receiver, data_id, message, length);
        (void)jp_e2e_check_group(&receiver, data_id, message, length, rest, rest_length);
    }
    if (length >= JP_E2E_LENGTH_MIN) {
        jp_e2e_protect(&counter, data_id, message, length);
        jp_e2e_protect_group(&counter, data_id, message, length, rest, rest_length);
    }
    ARRIVED();
    return 0;
}
