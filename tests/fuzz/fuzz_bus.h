/** An operator, a scanner and strangers on the bus of a controller, as the input of a fuzz target has them. */
#ifndef JOULEPATH_TESTS_FUZZ_FUZZ_BUS_H
#define JOULEPATH_TESTS_FUZZ_FUZZ_BUS_H

#include "hal/app/ecu.h"
#include "hal/can/jp_can.h"
#include "hal/can/map_link.h"
#include "hal/can/round_link.h"
#include "hal/can/scan_link.h"
#include "hal/storage/crc32.h"
#include "tests/fuzz/fuzz_input.h"

#define FUZZ_MAP_SIDE   40U
#define FUZZ_MAP_STREAM 2048U
#define FUZZ_BEAMS      360U

struct fuzz_bus {
    struct jp_ecu *ecu;
    bool was_told_to_run; /**< a frame said Stand or more, whatever else was wrong with it */
    uint8_t counters[16]; /**< of the messages with an id of 0x100… */
    uint8_t scan_counter;
    struct jp_scan_counters scans;
    uint8_t map_id;
    jp_q16 resolution; /**< of maps, m */
    uint64_t map_block[FUZZ_MAP_SIDE * FUZZ_MAP_SIDE];
    uint8_t stream[FUZZ_MAP_STREAM];
    uint16_t ranges[FUZZ_BEAMS];
    uint16_t beams; /**< 0: there is no scanner */
};

static inline void fuzz_bus_put(struct fuzz_bus *bus, const struct jp_can_frame *frame)
{
    if (frame->id == JP_CAN_OPERATOR_COMMAND_FRAME_ID && ((frame->data[1] >> 4) & 7U) != JP_MODE_OFF) {
        bus->was_told_to_run = true;
    }
    (void)jp_ecu_accept(bus->ecu, frame);
}

/** What is in a frame but its protection. */
static inline void fuzz_bus_protected(struct fuzz_bus *bus, struct jp_can_frame *frame, enum jp_data_id data_id)
{
    jp_e2e_protect(&bus->counters[frame->id & 15U], (uint8_t)data_id, frame->data, frame->length);
    fuzz_bus_put(bus, frame);
}

/** Some in a row, as many as it takes to be believed. */
static inline void fuzz_bus_command(struct fuzz_bus *bus, struct fuzz_input *input)
{
    const uint8_t mode = (uint8_t)fuzz_below(input, 8);
    const uint8_t route = fuzz_u8(input);

    for (unsigned left = 1U + fuzz_below(input, 4); left > 0U; left--) {
        struct jp_can_frame frame = {.id = JP_CAN_OPERATOR_COMMAND_FRAME_ID, .length = 4};

        frame.data[1] = (uint8_t)(mode << 4);
        frame.data[2] = route;
        fuzz_bus_protected(bus, &frame, JP_DATA_ID_OPERATOR_COMMAND);
    }
}

static inline void fuzz_bus_waypoint(struct fuzz_bus *bus, uint32_t id, enum jp_data_id data_id,
                                     const struct jp_point *point)
{
    const uint64_t x = (uint32_t)point->x & 0x3FFFFFFU;
    const uint64_t y = (uint32_t)point->y & 0x3FFFFFFU;
    const uint64_t bits = x << 12 | y << 38;
    struct jp_can_frame frame = {.id = id, .length = 8};

    memcpy(frame.data, &bits, sizeof frame.data);
    fuzz_bus_protected(bus, &frame, data_id);
}

static inline struct jp_point fuzz_bus_point(struct fuzz_input *input)
{
    const int32_t most = fuzz_bool(input) ? JP_Q16(2) : JP_Q16(511);

    return (struct jp_point){fuzz_range(input, -most, most), fuzz_range(input, -most, most)};
}

/** A route that is whole; its queue is emptied meanwhile. */
static inline void fuzz_bus_route(struct fuzz_bus *bus, struct fuzz_input *input)
{
    struct jp_point points[8];
    struct jp_can_frame frame = {.id = JP_CAN_ROUTE_OFFER_FRAME_ID, .length = 8};
    const uint8_t length = (uint8_t)(1U + fuzz_below(input, 8));
    uint32_t crc = JP_ROUTE_CRC_START;

    for (unsigned i = 0; i < length; i++) {
        points[i] = fuzz_bus_point(input);
        crc = jp_route_crc(crc, &points[i]);
    }
    frame.data[2] = fuzz_u8(input);
    frame.data[3] = length;
    memcpy(&frame.data[4], &crc, sizeof crc);
    fuzz_bus_protected(bus, &frame, JP_DATA_ID_ROUTE_OFFER);
    for (unsigned i = 0; i < length; i++) {
        fuzz_bus_waypoint(bus, JP_CAN_WAYPOINT_FRAME_ID, JP_DATA_ID_WAYPOINT, &points[i]);
        if (fuzz_bool(input)) {
            jp_ecu_work(bus->ecu);
        }
    }
}

static inline size_t fuzz_bus_draw_map(struct fuzz_bus *bus, struct fuzz_input *input)
{
    const struct jp_terrain_config config = {.width = (uint16_t)(4U + fuzz_below(input, FUZZ_MAP_SIDE - 3U)),
                                             .height = (uint16_t)(4U + fuzz_below(input, FUZZ_MAP_SIDE - 3U)),
                                             .resolution = bus->resolution,
                                             .unknown_is_free = true,
                                             .has_classes = fuzz_bool(input)};
    const struct jp_place origin = {.point = {fuzz_range(input, 0, config.resolution * (jp_q16)config.width),
                                              fuzz_range(input, 0, config.resolution * (jp_q16)config.height)},
                                    .heading = fuzz_u32(input)};
    struct jp_terrain terrain;
    const char *field;

    if (jp_terrain_init(&terrain, &config, bus->map_block, sizeof bus->map_block, &field) != JP_OK) {
        return 0;
    }
    for (unsigned left = fuzz_below(input, 64); left > 0U; left--) {
        (void)jp_terrain_set_cell(&terrain, (int32_t)fuzz_below(input, config.width),
                                  (int32_t)fuzz_below(input, config.height), (enum jp_cell)fuzz_below(input, 3));
    }
    return jp_map_encode(&terrain, &origin, bus->stream, sizeof bus->stream);
}

/** A map that is whole, or its stream with a byte of another value. */
static inline void fuzz_bus_map(struct fuzz_bus *bus, struct fuzz_input *input)
{
    struct jp_can_frame frame = {.id = JP_CAN_MAP_OFFER_FRAME_ID, .length = 8};
    const size_t length = fuzz_bus_draw_map(bus, input);

    if (fuzz_below(input, 4) == 3U && length > 0U) {
        bus->stream[fuzz_below(input, (uint32_t)length)] = fuzz_u8(input);
    }

    const struct jp_can_map_offer_t offer = {
        .map_id = ++bus->map_id, .bytes = (uint16_t)length, .map_crc = jp_crc32(0, bus->stream, length)};

    (void)jp_can_map_offer_pack(frame.data, &offer, sizeof frame.data);
    fuzz_bus_protected(bus, &frame, JP_DATA_ID_MAP_OFFER);
    jp_ecu_work(bus->ecu);
    for (uint16_t i = 0; (size_t)i * JP_MAP_DATA < length; i++) {
        struct jp_can_map_data_t data = {.index = i};
        const size_t left = length - (size_t)i * JP_MAP_DATA;
        uint8_t five[8] = {0};

        memcpy(five, bus->stream + (size_t)i * JP_MAP_DATA, left < JP_MAP_DATA ? left : JP_MAP_DATA);
        memcpy(&data.data, five, sizeof data.data);
        frame = (struct jp_can_frame){.id = JP_CAN_MAP_DATA_FRAME_ID, .length = 8};
        (void)jp_can_map_data_pack(frame.data, &data, sizeof frame.data);
        fuzz_bus_protected(bus, &frame, JP_DATA_ID_MAP_DATA);
        jp_ecu_work(bus->ecu);
    }
}

static inline void fuzz_bus_map_goal(struct fuzz_bus *bus, struct fuzz_input *input)
{
    const struct jp_can_map_goal_t goal = {.map_id = fuzz_below(input, 8) == 7U ? fuzz_u8(input) : bus->map_id,
                                           .goal_id = fuzz_u8(input),
                                           .column = (uint16_t)fuzz_below(input, FUZZ_MAP_SIDE + 2U),
                                           .row = (uint16_t)fuzz_below(input, FUZZ_MAP_SIDE + 2U),
                                           .has_heading = fuzz_u8(input) & 1U};
    struct jp_can_frame frame = {.id = JP_CAN_MAP_GOAL_FRAME_ID, .length = 8};

    (void)jp_can_map_goal_pack(frame.data, &goal, sizeof frame.data);
    fuzz_bus_protected(bus, &frame, JP_DATA_ID_MAP_GOAL);
}

static inline void fuzz_bus_cells(struct fuzz_bus *bus, struct fuzz_input *input)
{
    const struct jp_can_cell_changes_t cells = {.map_id = bus->map_id,
                                                .column = (uint16_t)fuzz_below(input, FUZZ_MAP_SIDE + 2U),
                                                .row = (uint16_t)fuzz_below(input, FUZZ_MAP_SIDE + 2U),
                                                .cells = fuzz_u32(input) & 0xFFFFFFU};
    struct jp_can_frame frame = {.id = JP_CAN_CELL_CHANGES_FRAME_ID, .length = 8};

    (void)jp_can_cell_changes_pack(frame.data, &cells, sizeof frame.data);
    fuzz_bus_protected(bus, &frame, JP_DATA_ID_CELL_CHANGES);
}

/** A whole scan. */
static inline void fuzz_bus_scan(struct fuzz_bus *bus, struct fuzz_input *input)
{
    const uint16_t everywhere = (uint16_t)fuzz_below(input, JP_SCAN_RANGE_DROPPED + 1U);
    struct jp_can_frame frame;

    for (unsigned i = 0; i < bus->beams; i++) {
        bus->ranges[i] = everywhere;
    }
    for (unsigned left = fuzz_below(input, 32); left > 0U && bus->beams > 0U; left--) {
        const uint32_t from = fuzz_below(input, bus->beams);
        const uint16_t range = (uint16_t)fuzz_below(input, JP_SCAN_RANGE_DROPPED + 1U);

        for (uint32_t i = from; i < bus->beams && i < from + 1U + fuzz_below(input, 32); i++) {
            bus->ranges[i] = range;
        }
    }
    for (unsigned i = 0; bus->beams > 0U && i < JP_SCAN_FRAMES(bus->beams); i++) {
        jp_scan_pack(&bus->scans, bus->ranges, bus->beams, i, &frame);
        fuzz_bus_put(bus, &frame);
    }
}

static inline void fuzz_bus_put_word(uint8_t *bytes, uint32_t word)
{
    for (unsigned i = 0; i < 4U; i++) {
        bytes[i] = (uint8_t)(word >> (8U * i));
    }
}

/** A place on the map or anywhere, and a stay or anything. */
static inline void fuzz_bus_place(struct fuzz_input *input, uint8_t *bytes)
{
    const uint32_t side = FUZZ_MAP_SIDE << 12U; /* of cells of 1/16 m, 2⁻¹⁶ m */

    fuzz_bus_put_word(&bytes[0], fuzz_below(input, 8) == 7U ? fuzz_u32(input) : fuzz_below(input, side));
    fuzz_bus_put_word(&bytes[4], fuzz_below(input, 8) == 7U ? fuzz_u32(input) : fuzz_below(input, side));
    fuzz_bus_put_word(&bytes[8], fuzz_u32(input));
}

static inline void fuzz_bus_charge(struct fuzz_bus *bus, uint32_t held)
{
    const struct jp_can_battery_charge_t charge = {.held = held};
    struct jp_can_frame frame = {.id = JP_CAN_BATTERY_CHARGE_FRAME_ID, .length = 8};

    (void)jp_can_battery_charge_pack(frame.data, &charge, sizeof frame.data);
    fuzz_bus_protected(bus, &frame, JP_DATA_ID_BATTERY_CHARGE);
}

/** A round, what the battery holds, and the command to drive it. */
static inline void fuzz_bus_round(struct fuzz_bus *bus, struct fuzz_input *input)
{
    const uint8_t stops = (uint8_t)(1U + fuzz_below(input, 3));
    const uint8_t id = fuzz_u8(input);
    uint8_t bytes[JP_ROUND_BYTES_MAX] = {0};
    struct jp_can_frame frame = {.id = JP_CAN_ROUND_OFFER_FRAME_ID, .length = 8};

    fuzz_bus_place(input, bytes);
    fuzz_bus_put_word(&bytes[12], fuzz_u32(input) >> fuzz_below(input, 20));
    fuzz_bus_put_word(&bytes[16], fuzz_u32(input) >> fuzz_below(input, 32));
    fuzz_bus_put_word(&bytes[20], fuzz_u32(input) >> (12U + fuzz_below(input, 20)));
    for (unsigned i = 0; i < stops; i++) {
        fuzz_bus_place(input, &bytes[JP_ROUND_BYTES(i)]);
        fuzz_bus_put_word(&bytes[JP_ROUND_BYTES(i) + 12U], fuzz_u32(input) >> (4U + fuzz_below(input, 20)));
    }

    const struct jp_can_round_offer_t offer = {.map_id = bus->map_id & 15U,
                                               .round_id = id,
                                               .stops = fuzz_below(input, 8) == 7U ? fuzz_u8(input) : stops,
                                               .round_crc = jp_crc32(0, bytes, JP_ROUND_BYTES(stops)) +
                                                            (fuzz_below(input, 8) == 7U ? 1U : 0U)};

    (void)jp_can_round_offer_pack(frame.data, &offer, sizeof frame.data);
    fuzz_bus_protected(bus, &frame, JP_DATA_ID_ROUND_OFFER);
    for (uint16_t i = 0; i < JP_ROUND_FRAMES(stops); i++) {
        struct jp_can_round_data_t data = {.index = i};

        for (unsigned k = 0; k < JP_ROUND_DATA; k++) {
            data.data |= (uint64_t)bytes[i * JP_ROUND_DATA + k] << (8U * k);
        }
        frame = (struct jp_can_frame){.id = JP_CAN_ROUND_DATA_FRAME_ID, .length = 8};
        (void)jp_can_round_data_pack(frame.data, &data, sizeof frame.data);
        fuzz_bus_protected(bus, &frame, JP_DATA_ID_ROUND_DATA);
    }
    fuzz_bus_charge(bus, fuzz_u32(input) >> fuzz_below(input, 20));
    fuzz_bus_charge(bus, fuzz_u32(input) >> fuzz_below(input, 20));
    jp_ecu_work(bus->ecu);
    for (unsigned i = fuzz_below(input, 5); i > 0U; i--) {
        const struct jp_can_operator_command_t command = {.mode = JP_MODE_NAVIGATE, .route_id = id};

        frame = (struct jp_can_frame){.id = JP_CAN_OPERATOR_COMMAND_FRAME_ID, .length = 4};
        (void)jp_can_operator_command_pack(frame.data, &command, sizeof frame.data);
        fuzz_bus_protected(bus, &frame, JP_DATA_ID_OPERATOR_COMMAND);
    }
}

/** A frame of any id and content, protected or not. */
static inline void fuzz_bus_any(struct fuzz_bus *bus, struct fuzz_input *input)
{
    struct jp_can_frame frame = {.id = fuzz_u32(input), .length = fuzz_u8(input) % 10U};

    if (fuzz_bool(input)) {
        frame.id = fuzz_below(input, 0x200);
    }
    fuzz_fill(input, frame.data, sizeof frame.data);
    fuzz_bus_put(bus, &frame);
}

/** Something comes over the bus. */
static inline void fuzz_bus_step(struct fuzz_bus *bus, struct fuzz_input *input)
{
    struct jp_point point;

    switch (fuzz_below(input, 10)) {
    case 0:
    case 1:
        fuzz_bus_command(bus, input);
        break;
    case 2:
        fuzz_bus_route(bus, input);
        break;
    case 3:
        point = fuzz_bus_point(input);
        fuzz_bus_waypoint(bus, JP_CAN_GOAL_FRAME_ID, JP_DATA_ID_GOAL, &point);
        break;
    case 4:
        fuzz_bus_map(bus, input);
        break;
    case 5:
        fuzz_bus_map_goal(bus, input);
        break;
    case 6:
        fuzz_bus_cells(bus, input);
        break;
    case 7:
        fuzz_bus_any(bus, input);
        break;
    case 8:
        fuzz_bus_scan(bus, input);
        break;
    default:
        fuzz_bus_round(bus, input);
        break;
    }
}

#endif
