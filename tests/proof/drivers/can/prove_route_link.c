/** Any frames of a route and silences of any length, at any rate of ticks, for ever; any route is asked for. */
#include "hal/can/jp_can.h"
#include "hal/can/route_link.h"
#include "tests/proof/any.h"

static void accept(struct jp_route_link *link)
{
    struct jp_can_frame frame;

    ANY(frame);
    switch (any_between(0, 2)) {
    case 0:
        frame.length = JP_CAN_ROUTE_OFFER_LENGTH;
        (void)jp_route_link_accept_offer(link, &frame);
        break;
    case 1:
        frame.length = JP_CAN_WAYPOINT_LENGTH;
        (void)jp_route_link_accept_waypoint(link, &frame);
        break;
    default:
        frame.length = JP_CAN_GOAL_LENGTH;
        (void)jp_route_link_accept_goal(link, &frame);
        break;
    }
}

static void drive(struct jp_route_link *link)
{
    (void)jp_route_link_take(link, (uint8_t)any_unsigned(UINT8_MAX));
    if (any_bool()) {
        jp_route_link_forget_goal(link);
    }
    if (any_bool()) {
        jp_route_link_end(link, JP_ROUTE_STOPPED, JP_REASON_COMMAND);
    }
}

int main(void)
{
    static struct jp_route_link link;

    jp_route_link_start(&link, any_unsigned(9999U) + 1U);
    ANY_TIMES
    {
        accept(&link);
        jp_route_link_pass(&link, any_unsigned(UINT32_MAX));
        drive(&link);
    }
    ARRIVED();
    return 0;
}
