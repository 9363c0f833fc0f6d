/** Any route or goal, any frames, any time that passes, a port that takes or refuses, for ever. */
#include "hal/app/operator.h"
#include "tests/proof/any_port.h"

#define POINTS 40U

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
    struct jp_can_frame frame;

    ANY_TIMES
    {
        order(&self);
        ANY(frame);
        jp_operator_accept(&self, &frame);
        jp_operator_tick(&self, any_unsigned(UINT32_MAX), &any_port);
        (void)jp_operator_failure_text(self.failure);
    }
    ARRIVED();
    return 0;
}
