/** Frames of an operator that sends a map, changes and a goal, as commands.h has those of routes. */
#ifndef JOULEPATH_TESTS_SUPPORT_MAP_FRAMES_H
#define JOULEPATH_TESTS_SUPPORT_MAP_FRAMES_H

#include "hal/can/map_link.h"
#include "hal/storage/crc32.h"
#include "tests/support/commands.h"

struct sent_map {
    const uint8_t *bytes;
    uint16_t length;
    uint8_t id;
    uint32_t crc_error; /**< on top of the checksum of its offer */
    uint8_t offers;
    uint8_t data;
};

static inline struct jp_can_frame map_offer(struct sent_map *map)
{
    const struct jp_can_map_offer_t signals = {
        .map_id = map->id, .bytes = map->length, .map_crc = jp_crc32(0, map->bytes, map->length) + map->crc_error};
    struct jp_can_frame frame = {.id = JP_CAN_MAP_OFFER_FRAME_ID, .length = JP_CAN_MAP_OFFER_LENGTH};

    (void)jp_can_map_offer_pack(frame.data, &signals, sizeof frame.data);
    jp_e2e_protect(&map->offers, JP_DATA_ID_MAP_OFFER, frame.data, frame.length);
    return frame;
}

static inline struct jp_can_frame map_data(struct sent_map *map, uint32_t index)
{
    struct jp_can_map_data_t signals = {.index = (uint16_t)(index & 0xFFFU)};
    struct jp_can_frame frame = {.id = JP_CAN_MAP_DATA_FRAME_ID, .length = JP_CAN_MAP_DATA_LENGTH};

    for (uint32_t i = 0; i < JP_MAP_DATA && index * JP_MAP_DATA + i < map->length; i++) {
        signals.data |= (uint64_t)map->bytes[index * JP_MAP_DATA + i] << (8U * i);
    }
    (void)jp_can_map_data_pack(frame.data, &signals, sizeof frame.data);
    jp_e2e_protect(&map->data, JP_DATA_ID_MAP_DATA, frame.data, frame.length);
    return frame;
}

static inline struct jp_can_frame cell_changes(uint8_t counter, const struct jp_cell_changes *changes)
{
    const struct jp_can_cell_changes_t signals = {
        .map_id = changes->map, .column = changes->x, .row = changes->y, .cells = changes->cells};
    struct jp_can_frame frame = {.id = JP_CAN_CELL_CHANGES_FRAME_ID, .length = JP_CAN_CELL_CHANGES_LENGTH};

    (void)jp_can_cell_changes_pack(frame.data, &signals, sizeof frame.data);
    protect_as(&frame, JP_DATA_ID_CELL_CHANGES, counter);
    return frame;
}

static inline struct jp_can_frame map_goal(uint8_t counter, const struct jp_map_goal *goal)
{
    const struct jp_can_map_goal_t signals = {.map_id = goal->map,
                                              .goal_id = goal->id,
                                              .column = goal->x,
                                              .row = goal->y,
                                              .has_heading = goal->has_heading ? 1U : 0U,
                                              .heading = (int16_t)((int32_t)goal->heading >> 20)};
    struct jp_can_frame frame = {.id = JP_CAN_MAP_GOAL_FRAME_ID, .length = JP_CAN_MAP_GOAL_LENGTH};

    (void)jp_can_map_goal_pack(frame.data, &signals, sizeof frame.data);
    protect_as(&frame, JP_DATA_ID_MAP_GOAL, counter);
    return frame;
}

#endif
