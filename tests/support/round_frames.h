/** Frames of an operator that sends a round, and of a charger, as map_frames.h has those of maps. */
#ifndef JOULEPATH_TESTS_SUPPORT_ROUND_FRAMES_H
#define JOULEPATH_TESTS_SUPPORT_ROUND_FRAMES_H

#include "hal/can/round_link.h"
#include "hal/storage/crc32.h"
#include "tests/support/commands.h"

struct sent_round {
    const uint8_t *bytes;
    uint8_t stops;
    uint8_t map;
    uint8_t id;
    uint32_t crc_error; /**< on top of the checksum of its offer */
    uint8_t offers;
    uint8_t data;
    uint8_t charges;
};

static inline struct jp_can_frame round_offer(struct sent_round *round)
{
    const struct jp_can_round_offer_t signals = {.map_id = round->map,
                                                 .round_id = round->id,
                                                 .stops = round->stops,
                                                 .round_crc = jp_crc32(0, round->bytes, JP_ROUND_BYTES(round->stops)) +
                                                              round->crc_error};
    struct jp_can_frame frame = {.id = JP_CAN_ROUND_OFFER_FRAME_ID, .length = JP_CAN_ROUND_OFFER_LENGTH};

    (void)jp_can_round_offer_pack(frame.data, &signals, sizeof frame.data);
    jp_e2e_protect(&round->offers, JP_DATA_ID_ROUND_OFFER, frame.data, frame.length);
    return frame;
}

static inline struct jp_can_frame round_data(struct sent_round *round, uint32_t index)
{
    struct jp_can_round_data_t signals = {.index = (uint16_t)(index & 0xFFFU)};
    struct jp_can_frame frame = {.id = JP_CAN_ROUND_DATA_FRAME_ID, .length = JP_CAN_ROUND_DATA_LENGTH};

    for (uint32_t i = 0; i < JP_ROUND_DATA && index * JP_ROUND_DATA + i < JP_ROUND_BYTES(round->stops); i++) {
        signals.data |= (uint64_t)round->bytes[index * JP_ROUND_DATA + i] << (8U * i);
    }
    (void)jp_can_round_data_pack(frame.data, &signals, sizeof frame.data);
    jp_e2e_protect(&round->data, JP_DATA_ID_ROUND_DATA, frame.data, frame.length);
    return frame;
}

static inline struct jp_can_frame battery_charge(struct sent_round *round, uint32_t held)
{
    const struct jp_can_battery_charge_t signals = {.held = held};
    struct jp_can_frame frame = {.id = JP_CAN_BATTERY_CHARGE_FRAME_ID, .length = JP_CAN_BATTERY_CHARGE_LENGTH};

    (void)jp_can_battery_charge_pack(frame.data, &signals, sizeof frame.data);
    jp_e2e_protect(&round->charges, JP_DATA_ID_BATTERY_CHARGE, frame.data, frame.length);
    return frame;
}

#endif
