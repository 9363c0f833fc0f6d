/** Any frames of a round and of a charge, with any map there or none, for ever; a round is rejected at any time. */
#include "hal/can/jp_can.h"
#include "hal/can/round_link.h"
#include "tests/proof/any.h"

static void accept(struct jp_round_link *link)
{
    struct jp_can_frame frame;
    uint32_t held;

    ANY(frame);
    switch (any_between(0, 2)) {
    case 0:
        frame.length = JP_CAN_ROUND_OFFER_LENGTH;
        (void)jp_round_link_accept_offer(link, &frame, (uint8_t)any_unsigned(UINT8_MAX), any_bool());
        break;
    case 1:
        frame.length = JP_CAN_ROUND_DATA_LENGTH;
        (void)jp_round_link_accept_data(link, &frame);
        break;
    default:
        frame.length = JP_CAN_BATTERY_CHARGE_LENGTH;
        (void)jp_round_link_accept_charge(link, &frame, &held);
        break;
    }
}

int main(void)
{
    static struct jp_round_link link;

    ANY_TIMES
    {
        accept(&link);
        if (any_bool()) {
            jp_round_link_reject(&link,
                                 (enum jp_round_reason)any_between(JP_ROUND_REASON_NONE, JP_ROUND_REASON_MAP_GONE),
                                 (enum jp_round_field)any_between(JP_ROUND_FIELD_NONE, JP_ROUND_FIELD_STOPS));
        }
    }
    ARRIVED();
    return 0;
}
