/**
 * The stream of a map: what any bytes decode to can be encoded and decoded to the same map, and any map that the input
 * draws comes back from its stream; over frames that are lost, repeated and spoilt a map is there whole or not at all.
 */
#include "hal/can/jp_can.h"
#include "hal/can/map_link.h"
#include "hal/storage/crc32.h"
#include "tests/fuzz/fuzz_input.h"

#define ROOM   4096U
#define STREAM 8192U
#define SIDE   24U

static uint64_t blocks[3][ROOM / sizeof(uint64_t)];
static uint8_t stream[STREAM];
static uint8_t again[STREAM];

static struct jp_map_room room_of(unsigned index)
{
    return (struct jp_map_room){.block = blocks[index], .size = ROOM, .resolution = JP_Q16(0.05)};
}

static enum jp_map_state decode(struct jp_map_decoder *decoder, unsigned block, const uint8_t *bytes, size_t length)
{
    const struct jp_map_room room = room_of(block);
    enum jp_map_state state = JP_MAP_DECODING;

    jp_map_decoder_start(decoder, &room);
    for (size_t i = 0; i < length; i++) {
        while (!jp_map_decoder_is_ready(decoder)) {
            jp_map_decoder_work(decoder);
        }
        state = jp_map_decoder_take(decoder, bytes[i]);
    }
    while (!jp_map_decoder_is_ready(decoder)) {
        jp_map_decoder_work(decoder);
    }
    return length == 0U ? state : decoder->state;
}

static void expect_equal(const struct jp_terrain *a, const struct jp_terrain *b)
{
    fuzz_require(a->config.width == b->config.width && a->config.height == b->config.height &&
                     a->config.resolution == b->config.resolution &&
                     a->config.unknown_is_free == b->config.unknown_is_free &&
                     a->config.has_classes == b->config.has_classes,
                 "another size");
    for (int32_t y = 0; y < a->config.height; y++) {
        for (int32_t x = 0; x < a->config.width; x++) {
            fuzz_require(jp_terrain_cell(a, x, y) == jp_terrain_cell(b, x, y), "another cell");
            fuzz_require(jp_terrain_class(a, x, y) == jp_terrain_class(b, x, y), "another class");
        }
    }
}

/** A whole map, through the encoder and the decoder. */
static void expect_same_again(const struct jp_terrain *terrain, const struct jp_place *origin)
{
    struct jp_map_decoder second;
    const size_t length = jp_map_encode(terrain, origin, again, sizeof again);

    fuzz_require(length > 0U && length <= jp_map_code_size(&terrain->config), "a map that cannot be encoded");
    fuzz_require(decode(&second, 1, again, length) == JP_MAP_WHOLE, "a map's own stream");
    expect_equal(terrain, &second.terrain);
}

static void decode_any(const uint8_t *bytes, size_t size)
{
    struct jp_map_decoder decoder;

    if (decode(&decoder, 0, bytes, size) == JP_MAP_WHOLE) {
        fuzz_require(jp_terrain_size(&decoder.terrain.config) <= ROOM, "a map beyond its room");
        expect_same_again(&decoder.terrain, &decoder.origin);
    }
}

static size_t draw_map(struct fuzz_input *input, struct jp_terrain *terrain)
{
    const struct jp_terrain_config config = {.width = (uint16_t)(1U + fuzz_below(input, SIDE)),
                                             .height = (uint16_t)(1U + fuzz_below(input, SIDE)),
                                             .resolution = JP_Q16(0.05),
                                             .unknown_is_free = fuzz_bool(input),
                                             .has_classes = fuzz_bool(input)};
    const struct jp_place origin = {.point = {fuzz_range(input, 0, JP_Q16(1)), fuzz_range(input, 0, JP_Q16(1))},
                                    .heading = fuzz_u32(input)};
    const char *field;

    fuzz_require(jp_terrain_init(terrain, &config, blocks[2], ROOM, &field) == JP_OK, "a small map");
    for (unsigned left = fuzz_u8(input); left > 0U; left--) {
        const int32_t x = (int32_t)fuzz_below(input, config.width);
        const int32_t y = (int32_t)fuzz_below(input, config.height);
        const uint8_t cell = fuzz_u8(input);

        (void)jp_terrain_set_cell(terrain, x, y, (enum jp_cell)(cell % 3U));
        (void)jp_terrain_set_class(terrain, x, y, (uint8_t)(cell / 4U % JP_GROUND_CLASSES));
    }
    return jp_map_encode(terrain, &origin, stream, sizeof stream);
}

static void protect(struct jp_can_frame *frame, uint8_t *counter, enum jp_data_id data_id)
{
    jp_e2e_protect(counter, (uint8_t)data_id, frame->data, frame->length);
}

static struct jp_can_frame offer_of(size_t length, uint8_t id, uint8_t *counter, uint32_t crc)
{
    struct jp_can_map_offer_t message = {.map_id = id, .bytes = (uint16_t)length, .map_crc = crc};
    struct jp_can_frame frame = {.id = JP_CAN_MAP_OFFER_FRAME_ID, .length = 8};

    (void)jp_can_map_offer_pack(frame.data, &message, sizeof frame.data);
    protect(&frame, counter, JP_DATA_ID_MAP_OFFER);
    return frame;
}

static struct jp_can_frame data_of(uint16_t number, size_t length, uint8_t *counter)
{
    struct jp_can_frame frame = {.id = JP_CAN_MAP_DATA_FRAME_ID, .length = 8};
    const size_t at = (size_t)number * JP_MAP_DATA;

    if (at < length) {
        memcpy(frame.data + 3, stream + at, length - at < JP_MAP_DATA ? length - at : JP_MAP_DATA);
    }
    protect(&frame, counter, JP_DATA_ID_MAP_DATA);
    return frame;
}

/** The stream, frame by frame over a link that loses and spoils some; what is lost is sent again. */
static void send(struct fuzz_input *input, const struct jp_terrain *terrain, size_t length)
{
    const struct jp_map_room room = room_of(0);
    const uint32_t crc = jp_crc32(0, stream, length);
    struct jp_map_link link;
    uint8_t offers = 0;
    uint8_t counter = 0;
    struct jp_can_frame frame;

    jp_map_link_start(&link, &room);
    for (unsigned i = 0; i < 2U; i++) {
        frame = offer_of(length, 7, &offers, crc);
        (void)jp_map_link_accept_offer(&link, &frame, true);
    }
    for (unsigned left = 4U * STREAM / JP_MAP_DATA; left > 0U && link.state == JP_MAP_LINK_RECEIVING; left--) {
        const uint8_t luck = fuzz_u8(input);

        frame = data_of(link.frames, length, &counter);
        if (luck >= 250U) {
            frame.data[fuzz_below(input, 8)] ^= fuzz_u8(input);
        }
        if (luck == 249U) {
            frame = offer_of(length, fuzz_bool(input) ? 7 : 8, &offers, crc);
            (void)jp_map_link_accept_offer(&link, &frame, fuzz_bool(input));
        } else if (luck != 248U) {
            (void)jp_map_link_accept_data(&link, &frame);
        }
        jp_map_link_work(&link);
    }
    for (unsigned left = 2000; left > 0U && link.state == JP_MAP_LINK_RECEIVING; left--) {
        jp_map_link_work(&link);
    }
    if (link.state == JP_MAP_LINK_READY) {
        expect_equal(terrain, &link.decoder.terrain);
    }
}

static void take_any_frames(struct fuzz_input *input)
{
    const struct jp_map_room room = room_of(0);
    struct jp_map_link link;
    struct jp_cell_changes changes;
    struct jp_map_goal goal;
    uint8_t counters[4] = {0};

    jp_map_link_start(&link, &room);
    while (fuzz_more(input)) {
        struct jp_can_frame frame = {.length = 8};
        const unsigned kind = fuzz_below(input, 4);

        fuzz_fill(input, frame.data, sizeof frame.data);
        if (fuzz_below(input, 8) != 0U) {
            static const enum jp_data_id ids[] = {JP_DATA_ID_MAP_OFFER, JP_DATA_ID_MAP_DATA, JP_DATA_ID_CELL_CHANGES,
                                                  JP_DATA_ID_MAP_GOAL};

            protect(&frame, &counters[kind], ids[kind]);
        }
        switch (kind) {
        case 0:
            (void)jp_map_link_accept_offer(&link, &frame, fuzz_bool(input));
            break;
        case 1:
            (void)jp_map_link_accept_data(&link, &frame);
            break;
        case 2:
            (void)jp_map_link_accept_cells(&link, &frame, &changes);
            break;
        default:
            (void)jp_map_link_accept_goal(&link, &frame, &goal);
            break;
        }
        jp_map_link_work(&link);
        fuzz_require(link.state <= JP_MAP_LINK_REJECTED && link.reason <= JP_MAP_REASON_UNDER_WAY, "state of the link");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct jp_terrain terrain;

    decode_any(bytes, size);

    const size_t length = draw_map(&input, &terrain);

    fuzz_require(length > 0U, "a map that cannot be encoded");
    if (fuzz_bool(&input)) {
        send(&input, &terrain, length);
    }
    take_any_frames(&input);
    return 0;
}
