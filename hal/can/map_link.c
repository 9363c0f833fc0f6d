#include "hal/can/map_link.h"

#include "hal/can/jp_can.h"
#include "hal/storage/crc32.h"

#define INDEX_MASK 0xFFFU

/** Of the signal Heading to turn/2³². */
#define HEADING_SHIFT 20U

void jp_map_link_start(struct jp_map_link *link, const struct jp_map_room *room)
{
    *link = (struct jp_map_link){.room = *room, .state = JP_MAP_LINK_NONE};
}

void jp_map_link_reject(struct jp_map_link *link, enum jp_map_reason reason)
{
    link->state = JP_MAP_LINK_REJECTED;
    link->reason = reason;
}

/* The map. */

static bool has_map(const struct jp_map_link *link)
{
    return link->state == JP_MAP_LINK_RECEIVING || link->state == JP_MAP_LINK_READY;
}

static bool is_offered(const struct jp_map_link *link, const struct jp_can_map_offer_t *signals)
{
    return has_map(link) && link->id == signals->map_id && link->length == signals->bytes &&
           link->crc == signals->map_crc;
}

static void begin(struct jp_map_link *link, const struct jp_can_map_offer_t *signals)
{
    jp_map_decoder_start(&link->decoder, &link->room);
    link->state = JP_MAP_LINK_RECEIVING;
    link->reason = JP_MAP_REASON_NONE;
    link->id = signals->map_id;
    link->length = signals->bytes;
    link->crc = signals->map_crc;
    link->sum = 0;
    link->frames = 0;
    link->decoded = 0;
    if (!jp_can_map_offer_map_id_is_in_range(signals->map_id) || !jp_can_map_offer_bytes_is_in_range(signals->bytes)) {
        jp_map_link_reject(link, JP_MAP_REASON_FORMAT);
    }
}

enum jp_e2e_result jp_map_link_accept_offer(struct jp_map_link *link, const struct jp_can_frame *frame,
                                            bool may_replace)
{
    struct jp_can_map_offer_t signals;

    if (jp_e2e_check(&link->offer_receiver, JP_DATA_ID_MAP_OFFER, frame->data, frame->length) == JP_E2E_CRC) {
        return JP_E2E_CRC;
    }
    /* The whole map has its own check, so an offer need not follow the one before: its sender may be new. */
    (void)jp_can_map_offer_unpack(&signals, frame->data, frame->length);
    if (is_offered(link, &signals)) {
        return JP_E2E_OK;
    }
    if (may_replace) {
        begin(link, &signals);
    } else {
        link->reason = JP_MAP_REASON_UNDER_WAY;
    }
    return JP_E2E_OK;
}

/** Bytes of the stream that have arrived. */
static uint32_t arrived(const struct jp_map_link *link)
{
    const uint32_t bytes = (uint32_t)link->frames * JP_MAP_DATA;

    return bytes < link->length ? bytes : link->length;
}

static void keep(struct jp_map_link *link, const uint8_t *bytes)
{
    const uint32_t before = arrived(link);

    link->frames++;
    const uint32_t count = arrived(link) - before;

    for (uint32_t i = 0; i < count; i++) {
        link->waiting[(before + i) % JP_MAP_WAITING] = bytes[i];
    }
    link->sum = jp_crc32(link->sum, bytes, count);
}

enum jp_e2e_result jp_map_link_accept_data(struct jp_map_link *link, const struct jp_can_frame *frame)
{
    struct jp_can_map_data_t signals;
    const enum jp_e2e_result result =
        jp_e2e_check(&link->data_receiver, JP_DATA_ID_MAP_DATA, frame->data, frame->length);

    if (result == JP_E2E_CRC) {
        return result;
    }
    (void)jp_can_map_data_unpack(&signals, frame->data, frame->length);
    const bool is_next = link->state == JP_MAP_LINK_RECEIVING && signals.index == (link->frames & INDEX_MASK) &&
                         arrived(link) < link->length;

    if (is_next && arrived(link) + JP_MAP_DATA - link->decoded <= JP_MAP_WAITING) {
        keep(link, &frame->data[frame->length - JP_MAP_DATA]);
    }
    return result == JP_E2E_FIRST ? JP_E2E_OK : result;
}

static enum jp_map_reason reason_of(enum jp_map_state state)
{
    switch (state) {
    case JP_MAP_TOO_LARGE:
        return JP_MAP_REASON_TOO_LARGE;
    case JP_MAP_OTHER_CELLS:
        return JP_MAP_REASON_CELL_SIZE;
    default:
        return JP_MAP_REASON_FORMAT;
    }
}

static void end(struct jp_map_link *link)
{
    if (link->sum != link->crc) {
        jp_map_link_reject(link, JP_MAP_REASON_CRC);
    } else if (link->decoder.state != JP_MAP_WHOLE) {
        jp_map_link_reject(link, reason_of(link->decoder.state));
    } else {
        link->state = JP_MAP_LINK_READY;
    }
}

/** One frame's bytes at most. */
static void decode(struct jp_map_link *link)
{
    for (unsigned i = 0; i < JP_MAP_DATA && link->decoded < arrived(link) && jp_map_decoder_is_ready(&link->decoder) &&
                         (link->decoder.state == JP_MAP_DECODING || link->decoder.state == JP_MAP_WHOLE);
         i++) {
        (void)jp_map_decoder_take(&link->decoder, link->waiting[link->decoded % JP_MAP_WAITING]);
        link->decoded++;
    }
}

void jp_map_link_work(struct jp_map_link *link)
{
    if (link->state != JP_MAP_LINK_RECEIVING) {
        return;
    }
    if (!jp_map_decoder_is_ready(&link->decoder)) {
        jp_map_decoder_work(&link->decoder);
    } else {
        decode(link);
    }
    if (link->decoder.state != JP_MAP_DECODING && link->decoder.state != JP_MAP_WHOLE) {
        jp_map_link_reject(link, reason_of(link->decoder.state));
    } else if (link->decoded == link->length && jp_map_decoder_is_ready(&link->decoder)) {
        end(link);
    } else {
        /* There is more to come. */
    }
}

/* Changes and goals. */

enum jp_e2e_result jp_map_link_accept_cells(struct jp_map_link *link, const struct jp_can_frame *frame,
                                            struct jp_cell_changes *changes)
{
    struct jp_can_cell_changes_t signals;
    const enum jp_e2e_result result =
        jp_e2e_check(&link->cells_receiver, JP_DATA_ID_CELL_CHANGES, frame->data, frame->length);

    if (result == JP_E2E_CRC) {
        return result;
    }
    (void)jp_can_cell_changes_unpack(&signals, frame->data, frame->length);
    *changes =
        (struct jp_cell_changes){.map = signals.map_id, .x = signals.column, .y = signals.row, .cells = signals.cells};
    if (signals.counter == ((link->cell_counter + 1U) & 0x0FU)) {
        link->cell_counter = signals.counter;
    }
    return result == JP_E2E_FIRST ? JP_E2E_OK : result;
}

enum jp_e2e_result jp_map_link_accept_goal(struct jp_map_link *link, const struct jp_can_frame *frame,
                                           struct jp_map_goal *goal)
{
    struct jp_can_map_goal_t signals;
    const enum jp_e2e_result result =
        jp_e2e_check(&link->goal_receiver, JP_DATA_ID_MAP_GOAL, frame->data, frame->length);

    if (result == JP_E2E_OK) {
        (void)jp_can_map_goal_unpack(&signals, frame->data, frame->length);
        *goal = (struct jp_map_goal){.map = signals.map_id,
                                     .id = signals.goal_id,
                                     .x = signals.column,
                                     .y = signals.row,
                                     .has_heading = signals.has_heading != 0U,
                                     .heading = (jp_angle)(int32_t)signals.heading << HEADING_SHIFT};
    }
    return result;
}
