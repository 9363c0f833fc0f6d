#include "hal/can/round_link.h"

#include "hal/can/jp_can.h"
#include "hal/storage/crc32.h"

void jp_round_link_reject(struct jp_round_link *link, enum jp_round_reason reason, enum jp_round_field field)
{
    link->state = JP_ROUND_LINK_REJECTED;
    link->reason = reason;
    link->field = field;
}

/** What was rejected is begun anew. */
static bool is_there(const struct jp_round_link *link, const struct jp_can_round_offer_t *signals)
{
    const bool is_taken = link->state == JP_ROUND_LINK_RECEIVING || link->state == JP_ROUND_LINK_WHOLE;

    return is_taken && link->map == signals->map_id && link->id == signals->round_id && link->stops == signals->stops &&
           link->crc == signals->round_crc;
}

static void begin(struct jp_round_link *link, const struct jp_can_round_offer_t *signals, uint8_t map)
{
    link->state = JP_ROUND_LINK_RECEIVING;
    link->reason = JP_ROUND_REASON_NONE;
    link->field = JP_ROUND_FIELD_NONE;
    link->map = signals->map_id;
    link->id = signals->round_id;
    link->stops = signals->stops;
    link->crc = signals->round_crc;
    link->frames = 0;
    if (!jp_can_round_offer_round_id_is_in_range(signals->round_id) ||
        !jp_can_round_offer_stops_is_in_range(signals->stops)) {
        jp_round_link_reject(link, JP_ROUND_REASON_FIELD, JP_ROUND_FIELD_STOPS);
    } else if (map == 0U) {
        jp_round_link_reject(link, JP_ROUND_REASON_NO_MAP, JP_ROUND_FIELD_NONE);
    } else if (map != signals->map_id) {
        jp_round_link_reject(link, JP_ROUND_REASON_OTHER_MAP, JP_ROUND_FIELD_NONE);
    } else {
        /* Its frames may come. */
    }
}

enum jp_e2e_result jp_round_link_accept_offer(struct jp_round_link *link, const struct jp_can_frame *frame, uint8_t map,
                                              bool may_replace)
{
    struct jp_can_round_offer_t signals;

    if (jp_e2e_check(&link->offer_receiver, JP_DATA_ID_ROUND_OFFER, frame->data, frame->length) == JP_E2E_CRC) {
        return JP_E2E_CRC;
    }
    /* The whole round has its own check, so an offer need not follow the one before: its sender may be new. */
    (void)jp_can_round_offer_unpack(&signals, frame->data, frame->length);
    if (is_there(link, &signals)) {
        return JP_E2E_OK;
    }
    if (may_replace) {
        begin(link, &signals, map);
    } else {
        link->reason = JP_ROUND_REASON_UNDER_WAY;
    }
    return JP_E2E_OK;
}

static void keep(struct jp_round_link *link, const uint8_t *bytes)
{
    for (uint32_t i = 0; i < JP_ROUND_DATA; i++) {
        link->bytes[link->frames * JP_ROUND_DATA + i] = bytes[i];
    }
    link->frames++;
    if (link->frames < JP_ROUND_FRAMES(link->stops)) {
        return;
    }
    if (jp_crc32(0, link->bytes, JP_ROUND_BYTES(link->stops)) == link->crc) {
        link->state = JP_ROUND_LINK_WHOLE;
    } else {
        jp_round_link_reject(link, JP_ROUND_REASON_CRC, JP_ROUND_FIELD_NONE);
    }
}

enum jp_e2e_result jp_round_link_accept_data(struct jp_round_link *link, const struct jp_can_frame *frame)
{
    struct jp_can_round_data_t signals;
    const enum jp_e2e_result result =
        jp_e2e_check(&link->data_receiver, JP_DATA_ID_ROUND_DATA, frame->data, frame->length);

    if (result == JP_E2E_CRC) {
        return result;
    }
    (void)jp_can_round_data_unpack(&signals, frame->data, frame->length);
    if (link->state == JP_ROUND_LINK_RECEIVING && signals.index == link->frames) {
        keep(link, &frame->data[frame->length - JP_ROUND_DATA]);
    }
    return result == JP_E2E_FIRST ? JP_E2E_OK : result;
}

enum jp_e2e_result jp_round_link_accept_charge(struct jp_round_link *link, const struct jp_can_frame *frame,
                                               uint32_t *held)
{
    struct jp_can_battery_charge_t signals;
    const enum jp_e2e_result result =
        jp_e2e_check(&link->charge_receiver, JP_DATA_ID_BATTERY_CHARGE, frame->data, frame->length);

    if (result == JP_E2E_OK) {
        (void)jp_can_battery_charge_unpack(&signals, frame->data, frame->length);
        *held = signals.held;
    }
    return result;
}
