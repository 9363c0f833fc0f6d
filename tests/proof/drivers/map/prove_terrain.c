// eva: -eva-slevel-function main:30,jp_terrain_init:30
/** Any map that fits a block, any cells on it and beside it, ground of any steepness blocked, for ever. */
#include <joulepath/terrain.h>

#include "tests/proof/any.h"

#define SPANS 4U
#define FAR   (1 << 30)

static uint64_t block[512];
static struct jp_terrain terrain;

static void set(int32_t x, int32_t y)
{
    (void)jp_terrain_set_cell(&terrain, x, y, (enum jp_cell)any_between(0, 3));
    (void)jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)any_between(INT16_MIN, INT16_MAX));
    (void)jp_terrain_set_cost(&terrain, x, y, (uint8_t)any_unsigned(UINT8_MAX));
    (void)jp_terrain_set_class(&terrain, x, y, (uint8_t)any_unsigned(UINT8_MAX));
}

static void look(int32_t x, int32_t y)
{
    const struct jp_point point = {any_int(), any_int()};

    (void)jp_terrain_contains(&terrain, x, y);
    (void)jp_terrain_cell(&terrain, x, y);
    (void)jp_terrain_elevation(&terrain, x, y);
    (void)jp_terrain_cost(&terrain, x, y);
    (void)jp_terrain_class(&terrain, x, y);
    (void)jp_terrain_height(&terrain, &point);
}

/** Rows in any order, each of any cells. */
static void look_at_spans(void)
{
    static struct jp_span spans[SPANS];

    ANY(spans);
    for (unsigned i = 0; i < SPANS; i++) {
        spans[i].first = (int8_t)any_between(INT8_MIN, INT8_MAX);
        spans[i].last = (int8_t)any_between(spans[i].first, INT8_MAX);
    }
    (void)jp_terrain_is_clear(&terrain, spans, any_unsigned(SPANS), any_between(-FAR, FAR), any_between(-FAR, FAR));
}

int main(void)
{
    struct jp_terrain_config config;
    const char *field;

    ANY(config);
    config.has_elevation = any_bool();
    config.unknown_is_free = any_bool();
    config.has_costs = any_bool();
    config.has_classes = any_bool();
    if (jp_terrain_init(&terrain, &config, block, sizeof block, &field) != JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        set(any_int(), any_int());
        look(any_int(), any_int());
        look_at_spans();
        (void)jp_terrain_block_steep(&terrain, any_int());
    }
    ARRIVED();
    return 0;
}
