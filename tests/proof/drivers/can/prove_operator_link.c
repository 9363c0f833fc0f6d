/** Any commands of an operator and silences of any length, at any rate of ticks, for ever. */
#include "hal/can/jp_can.h"
#include "hal/can/operator_link.h"
#include "tests/proof/any.h"

int main(void)
{
    struct jp_operator_link link;
    struct jp_can_frame frame;

    jp_operator_link_start(&link, any_unsigned(9999U) + 1U);
    ANY_TIMES
    {
        ANY(frame);
        frame.length = JP_CAN_OPERATOR_COMMAND_LENGTH;
        (void)jp_operator_link_accept(&link, &frame);
        (void)jp_operator_link_pass(&link, any_unsigned(UINT32_MAX));
    }
    ARRIVED();
    return 0;
}
