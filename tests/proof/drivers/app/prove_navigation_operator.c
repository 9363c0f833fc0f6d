// eva: -eva-slevel-function main:20
/** Any map and goal, anything seen, any frames, any time that passes, a port that takes or refuses, for ever. */
#include "hal/app/navigation_operator.h"
#include "tests/proof/any.h"

static uint8_t bytes[UINT16_MAX];

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    (void)frame;
    return any_bool() ? JP_OK : JP_ERR_HARDWARE;
}

static enum jp_can_state state(void *context)
{
    (void)context;
    return any_bool() ? JP_CAN_ON : JP_CAN_BUS_OFF;
}

static void order(struct jp_navigation_operator *self)
{
    const struct jp_map_stream stream = {
        .bytes = bytes, .length = (uint16_t)any_unsigned(UINT16_MAX), .id = (uint8_t)any_unsigned(UINT8_MAX)};
    struct jp_map_goal goal;

    ANY(goal);
    goal.has_heading = any_bool();
    switch (any_between(0, 2)) {
    case 0:
        (void)jp_navigation_operator_go(self, &stream, &goal);
        break;
    case 1:
        (void)jp_navigation_operator_see(self, (uint16_t)any_unsigned(UINT16_MAX), (uint16_t)any_unsigned(UINT16_MAX),
                                         (enum jp_cell)any_between(JP_CELL_FREE, JP_CELL_UNKNOWN));
        break;
    default:
        jp_navigation_operator_stop(self);
        break;
    }
}

int main(void)
{
    static struct jp_navigation_operator self;
    const struct jp_can_port port = {.send = send, .state = state};
    struct jp_can_frame frame;

    ANY(bytes);
    ANY_TIMES
    {
        order(&self);
        ANY(frame);
        jp_navigation_operator_accept(&self, &frame);
        jp_navigation_operator_tick(&self, any_unsigned(UINT32_MAX), &port);
        (void)jp_navigation_failure_text(self.failure);
    }
    ARRIVED();
    return 0;
}
