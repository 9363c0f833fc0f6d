/**
 * A round between places that arrives in frames: RoundOffer, then RoundData; and what the battery holds: BatteryCharge.
 *
 * A round counts only whole, with the right CRC-32 over its bytes. What is lost of it is asked for again: RoundData is
 * taken in its order, and `frames` says which one comes next. round_code.h says what the bytes mean.
 */
#ifndef JOULEPATH_HAL_CAN_ROUND_LINK_H
#define JOULEPATH_HAL_CAN_ROUND_LINK_H

#include <stdbool.h>

#include "hal/can/messages.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Bytes of a RoundData; and of a round before its stops, and of each of them. */
#define JP_ROUND_DATA 5U
#define JP_ROUND_HEAD 24U
#define JP_ROUND_STOP 16U

#define JP_ROUND_STOPS_MAX 15U

#define JP_ROUND_BYTES(stops)  (JP_ROUND_HEAD + (stops)*JP_ROUND_STOP)
#define JP_ROUND_FRAMES(stops) ((JP_ROUND_BYTES(stops) + JP_ROUND_DATA - 1U) / JP_ROUND_DATA)
#define JP_ROUND_BYTES_MAX     (JP_ROUND_FRAMES(JP_ROUND_STOPS_MAX) * JP_ROUND_DATA)

enum jp_round_link_state { JP_ROUND_LINK_NONE, JP_ROUND_LINK_RECEIVING, JP_ROUND_LINK_REJECTED, JP_ROUND_LINK_WHOLE };

/** Values of Reason in RoundStatus. */
enum jp_round_reason {
    JP_ROUND_REASON_NONE,
    JP_ROUND_REASON_UNDER_WAY,
    JP_ROUND_REASON_NO_MAP,
    JP_ROUND_REASON_OTHER_MAP,
    JP_ROUND_REASON_CRC,
    JP_ROUND_REASON_FIELD,
    JP_ROUND_REASON_BLOCKED,
    JP_ROUND_REASON_NO_BATTERY,
    JP_ROUND_REASON_NO_WAY,
    JP_ROUND_REASON_NO_ENERGY,
    JP_ROUND_REASON_DRIVES_OFF,
    JP_ROUND_REASON_FAULT,
    JP_ROUND_REASON_TOLD,
    JP_ROUND_REASON_MAP_GONE
};

/** Values of Field in RoundStatus. */
enum jp_round_field {
    JP_ROUND_FIELD_NONE,
    JP_ROUND_FIELD_STOP_POSE,
    JP_ROUND_FIELD_STOP_DWELL,
    JP_ROUND_FIELD_CHARGER,
    JP_ROUND_FIELD_FULL,
    JP_ROUND_FIELD_RESERVE,
    JP_ROUND_FIELD_DEVIATIONS,
    JP_ROUND_FIELD_STOPS
};

/** All zero at the start. The members but the receivers may be read. */
struct jp_round_link {
    struct jp_e2e_receiver offer_receiver;
    struct jp_e2e_receiver data_receiver;
    struct jp_e2e_receiver charge_receiver;
    enum jp_round_link_state state;
    enum jp_round_reason reason; /**< why it was rejected, or the last offer refused */
    enum jp_round_field field;
    uint8_t map;
    uint8_t id; /**< 0: none was offered */
    uint8_t stops;
    uint32_t crc;
    uint8_t frames; /**< taken: number of the RoundData that comes next */
    uint8_t bytes[JP_ROUND_BYTES_MAX];
};

/* These take frames of the right length. Constant time. */

/** JP_E2E_OK although the offer is refused: then the reason says so. `map`: id of that which is there, 0: none.
 *  `may_replace`: whether another round may be replaced now. */
enum jp_e2e_result jp_round_link_accept_offer(struct jp_round_link *link, const struct jp_can_frame *frame, uint8_t map,
                                              bool may_replace);

/** Work: with the last frame the CRC-32 of the round. */
enum jp_e2e_result jp_round_link_accept_data(struct jp_round_link *link, const struct jp_can_frame *frame);

/** *held, 2⁻⁴ J, is written only with JP_E2E_OK. */
enum jp_e2e_result jp_round_link_accept_charge(struct jp_round_link *link, const struct jp_can_frame *frame,
                                               uint32_t *held);

/** The round is not what the rest of the application can take. */
void jp_round_link_reject(struct jp_round_link *link, enum jp_round_reason reason, enum jp_round_field field);

#ifdef __cplusplus
}
#endif

#endif
