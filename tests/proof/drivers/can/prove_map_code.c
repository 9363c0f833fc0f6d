// eva: -eva-precision 0 -eva-auto-loop-unroll 8 -eva-slevel-function main:20,jp_terrain_init:30
/** Any bytes of a stream, for ever, into any room; the map that was decoded, and any other one, as a stream again. */
#include "hal/can/map_code.h"
#include "tests/proof/any_terrain.h"

static uint64_t block[64];
static uint8_t bytes[256];
static struct jp_map_decoder decoder;

static void encode_other(void)
{
    const struct jp_terrain *other = any_terrain();
    struct jp_terrain_config config;
    struct jp_place origin;

    any_terrain_config(&config);
    (void)jp_map_code_size(&config);
    ANY(origin);
    (void)jp_map_encode(other, &origin, bytes, any_unsigned(sizeof bytes));
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
