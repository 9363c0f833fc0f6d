// eva: -eva-slevel-function main:20
/** Any frames of the right lengths, in any order, for ever; scans of any ranges to be sent, in their order. */
#include "hal/can/jp_can.h"
#include "hal/can/scan_link.h"

#include "tests/proof/any.h"

static struct jp_scan_link link;
static uint16_t ranges[JP_SCAN_LINK_BEAMS];

static void accept(void)
{
    struct jp_can_frame frame;
    bool is_so;

    ANY(frame);
    switch (any_between(0, 2)) {
    case 0:
        frame.length = JP_CAN_SCAN_BEGIN_LENGTH;
        (void)jp_scan_link_accept_begin(&link, &frame, &is_so);
        break;
    case 1:
        frame.length = JP_CAN_SCAN_RANGES_LENGTH;
        jp_scan_link_accept_ranges(&link, &frame);
        break;
    default:
        frame.length = JP_CAN_SCAN_END_LENGTH;
        (void)jp_scan_link_accept_end(&link, &frame, &is_so);
        break;
    }
}

static void send(uint16_t beams)
{
    struct jp_scan_counters counters;
    struct jp_can_frame frame;

    ANY(counters);
    ANY(ranges);
    for (unsigned i = 0; i < JP_SCAN_FRAMES(beams); i++) {
        jp_scan_pack(&counters, ranges, beams, i, &frame);
    }
}

int main(void)
{
    jp_scan_link_start(&link, (uint16_t)any_between(2, JP_SCAN_LINK_BEAMS));
    ANY_TIMES
    {
        accept();
        if (jp_scan_link_waits(&link)) {
            (void)jp_scan_link_take(&link, ranges);
        }
        send((uint16_t)any_between(2, JP_SCAN_LINK_BEAMS));
    }
    ARRIVED();
    return 0;
}
