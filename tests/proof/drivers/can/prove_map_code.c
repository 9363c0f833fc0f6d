// eva: -eva-precision 0 -eva-auto-loop-unroll 8 -eva-slevel-function main:20,jp_terrain_init:30
/** Any bytes of a stream, for ever, into any room; the map that was decoded, and any other one, as a stream again. */
#include "hal/can/map_code.h"
#include "tests/proof/any.h"

static uint64_t block[64];
static uint64_t other_block[32];
static uint8_t bytes[256];
static struct jp_map_decoder decoder;
static struct jp_terrain other;

static void encode_other(void)
{
    struct jp_terrain_config config;
    struct jp_place origin;
    const char *field;

    ANY(config);
    ANY(origin);
    config.has_elevation = any_bool();
    config.unknown_is_free = any_bool();
    config.has_costs = any_bool();
    config.has_classes = any_bool();
    (void)jp_map_code_size(&config);
    if (jp_terrain_init(&other, &config, other_block, sizeof other_block, &field) != JP_OK) {
        return;
    }
    ANY_TIMES
    {
        (void)jp_terrain_set_cell(&other, any_int(), any_int(), (enum jp_cell)any_between(0, 3));
    }
    (void)jp_map_encode(&other, &origin, bytes, any_unsigned(sizeof bytes));
}

int main(void)
{
    const struct jp_map_room room = {
        .block = block, .size = any_unsigned(sizeof block), .resolution = any_between(1, INT32_MAX)};

    jp_map_decoder_start(&decoder, &room);
    ANY_TIMES
    {
        if (jp_map_decoder_is_ready(&decoder)) {
            (void)jp_map_decoder_take(&decoder, (uint8_t)any_unsigned(UINT8_MAX));
        }
        jp_map_decoder_work(&decoder);
    }
    if (decoder.state == JP_MAP_WHOLE) {
        (void)jp_map_encode(&decoder.terrain, &decoder.origin, bytes, sizeof bytes);
    }
    encode_other();
    ARRIVED();
    return 0;
}
