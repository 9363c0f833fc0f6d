// eva: -eva-slevel-function main:20
/** Any frames of the right lengths, in any order, for ever. */
#include "hal/can/jp_can.h"
#include "hal/can/map_link.h"
#include "tests/proof/any.h"

static uint64_t block[512];
static struct jp_map_link link;

static void accept(void)
{
    struct jp_cell_changes changes;
    struct jp_map_goal goal;
    struct jp_can_frame frame;

    ANY(frame);
    switch (any_between(0, 3)) {
    case 0:
        frame.length = JP_CAN_MAP_OFFER_LENGTH;
        (void)jp_map_link_accept_offer(&link, &frame, any_bool());
        break;
    case 1:
        frame.length = JP_CAN_MAP_DATA_LENGTH;
        (void)jp_map_link_accept_data(&link, &frame);
        break;
    case 2:
        frame.length = JP_CAN_CELL_CHANGES_LENGTH;
        (void)jp_map_link_accept_cells(&link, &frame, &changes);
        break;
    default:
        frame.length = JP_CAN_MAP_GOAL_LENGTH;
        (void)jp_map_link_accept_goal(&link, &frame, &goal);
        break;
    }
}

int main(void)
{
    const struct jp_map_room room = {.block = block, .size = sizeof block, .resolution = any_between(1, INT32_MAX)};

    jp_map_link_start(&link, &room);
    ANY_TIMES
    {
        accept();
        jp_map_link_work(&link);
        if (any_bool()) {
            jp_map_link_reject(&link, JP_MAP_REASON_UNDER_WAY);
        }
    }
    ARRIVED();
    return 0;
}
