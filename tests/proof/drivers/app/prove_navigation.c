// eva: -eva-slevel-function main:20,accept_goal:10,jp_map_link_accept_goal:10
/** Any wayfinder, whose answers are any, on maps in a room of any size: any frames of the right lengths, any commands,
 * any time that passes, for ever. */
#include "hal/app/navigation.h"
#include "hal/can/jp_can.h"
#include "tests/proof/any.h"

#define LEGS 4U

static struct jp_navigation navigation;
static uint64_t block[64];
static struct jp_course_leg legs[LEGS];

static void do_it(void *self)
{
    (void)self;
}

static bool is_so(const void *self)
{
    (void)self;
    return any_bool();
}

static enum jp_status prepare(void *self, struct jp_terrain *map, const struct jp_place *origin)
{
    (void)self;
    (void)map;
    (void)origin;
    return any_bool() ? JP_OK : JP_ERR_MEMORY;
}

static void see(void *self, int32_t x, int32_t y, enum jp_cell cell)
{
    (void)self;
    (void)x;
    (void)y;
    (void)cell;
}

static bool can_stand(const void *self, const struct jp_map_goal *goal)
{
    (void)self;
    (void)goal;
    return any_bool();
}

static enum jp_status go(void *self, const struct jp_map_goal *goal)
{
    (void)self;
    (void)goal;
    return any_bool() ? JP_OK : any_bool() ? JP_ERR_STATE : JP_ERR_BLOCKED;
}

static bool work(void *self)
{
    (void)self;
    return any_bool();
}

static void tell_way(const void *self, struct jp_way_report *way)
{
    (void)self;
    ANY(*way);
    ANY(legs);
    for (unsigned i = 0; i < LEGS; i++) {
        legs[i].is_stop = any_bool();
    }
    way->legs = legs;
    way->leg_count = (uint16_t)any_unsigned(LEGS);
}

static const struct jp_wayfinder finder = {.prepare = prepare,
                                           .forget = do_it,
                                           .is_under_way = is_so,
                                           .see = see,
                                           .can_stand = can_stand,
                                           .go = go,
                                           .stop = do_it,
                                           .work = work,
                                           .tell = tell_way};

static void accept(void)
{
    struct jp_can_frame frame;

    ANY(frame);
    switch (any_between(0, 3)) {
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
    default:
        frame.id = JP_CAN_MAP_GOAL_FRAME_ID;
        frame.length = JP_CAN_MAP_GOAL_LENGTH;
        break;
    }
    (void)jp_navigation_accept(&navigation, &frame);
}

int main(void)
{
    const struct jp_map_room room = {.block = block, .size = sizeof block, .resolution = any_between(1, INT32_MAX)};
    const uint32_t tick_rate = any_unsigned(9900U) + 100U;
    struct jp_can_frame frame;

    /* As jp_navigation_init_with() does, on which this version of the analyser breaks down. */
    navigation.finder = finder;
    navigation.home_status = JP_ERR_STATE;
    jp_map_link_start(&navigation.maps, &room);
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
    ARRIVED();
    return 0;
}
