// eva: -eva-slevel-function main:30,any_terrain:30,jp_terrain_init:30
/** Any map that fits a block, any cells on it and beside it, ground of any steepness blocked, for ever. */
#include "tests/proof/any_terrain.h"

#define SPANS 4U
#define FAR   (1 << 30)

static void look(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    const struct jp_point point = {any_int(), any_int()};

    (void)jp_terrain_contains(terrain, x, y);
    (void)jp_terrain_cell(terrain, x, y);
    (void)jp_terrain_elevation(terrain, x, y);
    (void)jp_terrain_cost(terrain, x, y);
    (void)jp_terrain_class(terrain, x, y);
    (void)jp_terrain_height(terrain, &point);
}

/** Rows in any order, each of any cells. */
static void look_at_spans(const struct jp_terrain *terrain)
{
    static struct jp_span spans[SPANS];

    ANY(spans);
    for (unsigned i = 0; i < SPANS; i++) {
        spans[i].first = (int8_t)any_between(INT8_MIN, INT8_MAX);
        spans[i].last = (int8_t)any_between(spans[i].first, INT8_MAX);
    }
    (void)jp_terrain_is_clear(terrain, spans, any_unsigned(SPANS), any_between(-FAR, FAR), any_between(-FAR, FAR));
}

int main(void)
{
    struct jp_terrain *terrain = any_terrain();

    ANY_TIMES
    {
        any_cell(terrain);
        look(terrain, any_int(), any_int());
        look_at_spans(terrain);
        (void)jp_terrain_block_steep(terrain, any_int());
    }
    ARRIVED();
    return 0;
}
