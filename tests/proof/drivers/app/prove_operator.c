/** Any route or goal, any frames, any time that passes, a port that takes or refuses, for ever. */
#include "hal/app/operator.h"
#include "tests/proof/any.h"

#define POINTS 40U

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

static void order(struct jp_operator *self)
{
    static struct jp_point points[POINTS];

    ANY(points);
    switch (any_between(0, 2)) {
    case 0:
        (void)jp_operator_route(self, points, any_unsigned(POINTS));
        break;
    case 1:
        (void)jp_operator_goal(self, points);
        break;
    default:
        jp_operator_stop(self);
        break;
    }
}

int main(void)
{
    static struct jp_operator self;
    const struct jp_can_port port = {.send = send, .state = state};
    struct jp_can_frame frame;

    ANY_TIMES
    {
        order(&self);
        ANY(frame);
        jp_operator_accept(&self, &frame);
        jp_operator_tick(&self, any_unsigned(UINT32_MAX), &port);
        (void)jp_operator_failure_text(self.failure);
    }
    ARRIVED();
    return 0;
}
