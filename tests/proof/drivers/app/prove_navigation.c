// eva: -eva-slevel-function main:20,navigate:20,accept_goal:10,jp_map_link_accept_goal:10
/** Any wayfinder, whose answers are any and which goes round or does not, on maps in a room of any size: any frames of
 * the right lengths, any commands, any time that passes, for ever. */
#include "hal/can/jp_can.h"
#include "tests/proof/any_finder.h"

static struct jp_navigation navigation;
static uint64_t block[64];

static void accept(void)
{
    struct jp_can_frame frame;

    ANY(frame);
    switch (any_between(0, jp_navigation_goes_round(&navigation) ? 6 : 3)) {
    case 0:
        frame.id = JP_CAN_MAP_OFFER_FRAME_ID;
        frame.length = JP_CAN_MAP_OFFER_LENGTH;
        break;
    case 1:
        frame.id = JP_CAN_MAP_DATA_FRAME_ID;
        frame.length = JP_CAN_MAP_DATA_LENGTH;
        break;
    case 2:
        frame.id = JP_CAN_CELL_CHANGES_FRAME_ID;
        frame.length = JP_CAN_CELL_CHANGES_LENGTH;
        break;
    case 3:
        frame.id = JP_CAN_MAP_GOAL_FRAME_ID;
        frame.length = JP_CAN_MAP_GOAL_LENGTH;
        break;
    case 4:
        frame.id = JP_CAN_ROUND_OFFER_FRAME_ID;
        frame.length = JP_CAN_ROUND_OFFER_LENGTH;
        break;
    case 5:
        frame.id = JP_CAN_ROUND_DATA_FRAME_ID;
        frame.length = JP_CAN_ROUND_DATA_LENGTH;
        break;
    default:
        frame.id = JP_CAN_BATTERY_CHARGE_FRAME_ID;
        frame.length = JP_CAN_BATTERY_CHARGE_LENGTH;
        break;
    }
    (void)jp_navigation_accept(&navigation, &frame);
}

static void navigate(const struct jp_wayfinder_rounds *rounds)
{
    const struct jp_map_room room = {.block = block, .size = sizeof block, .resolution = any_between(1, INT32_MAX)};
    const uint32_t tick_rate = any_unsigned(9900U) + 100U;
    struct jp_wayfinder finder = any_finder;
    struct jp_can_frame frame;

    finder.rounds = rounds;
    while (jp_navigation_init_with(&navigation, &finder, &room) != JP_OK) {
        /* Nothing is null. */
    }
    ANY_TIMES
    {
        accept();
        (void)jp_navigation_drive(&navigation, (uint8_t)any_unsigned(UINT8_MAX));
        if (any_bool()) {
            jp_navigation_stop(&navigation);
        }
        (void)jp_navigation_is_under_way(&navigation);
        (void)jp_navigation_work(&navigation, any_unsigned(UINT32_MAX), tick_rate);
        (void)jp_navigation_take_frame(&navigation, &frame);
    }
}

int main(void)
{
    navigate(any_bool() ? &finder_rounds : NULL);
    ARRIVED();
    return 0;
}
