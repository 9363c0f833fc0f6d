// eva: -eva-slevel-function main:20
/** Any map, goal and round, anything seen, any frames, any time that passes, a port that takes or refuses, for ever. */
#include "hal/app/navigation_operator.h"
#include "tests/proof/any_port.h"

static uint8_t bytes[UINT16_MAX];
static uint8_t round_bytes[JP_ROUND_BYTES_MAX];

static void order(struct jp_navigation_operator *self)
{
    const struct jp_map_stream stream = {
        .bytes = bytes, .length = (uint16_t)any_unsigned(UINT16_MAX), .id = (uint8_t)any_unsigned(UINT8_MAX)};
    const struct jp_round_bytes round = {.bytes = round_bytes, .stops = (uint8_t)any_unsigned(UINT8_MAX)};
    struct jp_map_goal goal;

    ANY(goal);
    goal.has_heading = any_bool();
    switch (any_between(0, 3)) {
    case 0:
        (void)jp_navigation_operator_go(self, &stream, &goal);
        break;
    case 1:
        (void)jp_navigation_operator_patrol(self, &stream, &round);
        break;
    case 2:
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
    struct jp_can_frame frame;

    ANY(bytes);
    ANY(round_bytes);
    ANY_TIMES
    {
        order(&self);
        ANY(frame);
        jp_navigation_operator_accept(&self, &frame);
        jp_navigation_operator_tick(&self, any_unsigned(UINT32_MAX), &any_port);
        (void)jp_navigation_failure_text(self.failure);
    }
    ARRIVED();
    return 0;
}
