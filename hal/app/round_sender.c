#include "hal/app/round_sender.h"

#include "hal/storage/crc32.h"

#define OFFER_PERIOD_MS 100U
#define DATA_PERIOD_MS  2U

void jp_round_sender_begin(struct jp_round_sender *sender, const struct jp_round_bytes *round, uint8_t map, uint8_t id)
{
    sender->round = *round;
    sender->map = map;
    sender->id = id;
    sender->crc = jp_crc32(0, round->bytes, JP_ROUND_BYTES(round->stops));
    sender->has_offered = false;
    sender->is_asked_for = false;
    sender->next_frame = 0;
    sender->frames_before = 0;
    sender->since_offer_ms = OFFER_PERIOD_MS;
    sender->since_data_ms = DATA_PERIOD_MS;
}

/** What the ECU has taken since the status before, or goes on from where it was when it has taken nothing. */
static void hear_growing(struct jp_round_sender *sender, uint8_t received)
{
    if (!sender->is_asked_for || received == sender->frames_before) {
        sender->next_frame = received;
    }
    sender->is_asked_for = true;
    sender->frames_before = received;
}

enum jp_round_answer jp_round_sender_hear(struct jp_round_sender *sender, const struct jp_can_round_status_t *status)
{
    const bool is_other = status->round_id != sender->id;

    if (is_other && sender->has_offered && status->reason == (uint8_t)JP_ROUND_REASON_UNDER_WAY) {
        return JP_ROUND_ANSWER_REFUSED;
    }
    if (is_other) {
        return JP_ROUND_ANSWER_NONE;
    }
    switch (status->state) {
    case JP_CAN_ROUND_STATUS_STATE_RECEIVING_CHOICE:
        hear_growing(sender, status->received);
        return JP_ROUND_ANSWER_NONE;
    case JP_CAN_ROUND_STATUS_STATE_REJECTED_CHOICE:
        return JP_ROUND_ANSWER_REFUSED;
    case JP_CAN_ROUND_STATUS_STATE_READY_CHOICE:
        return JP_ROUND_ANSWER_TAKEN;
    default:
        return JP_ROUND_ANSWER_NONE;
    }
}

void jp_round_sender_pass(struct jp_round_sender *sender, uint32_t elapsed_ms)
{
    sender->since_offer_ms += elapsed_ms;
    sender->since_data_ms += elapsed_ms;
}

static void send_offer(struct jp_round_sender *sender, const struct jp_can_port *port)
{
    const struct jp_can_round_offer_t signals = {
        .map_id = sender->map, .round_id = sender->id, .stops = sender->round.stops, .round_crc = sender->crc};
    struct jp_can_frame frame = {.id = JP_CAN_ROUND_OFFER_FRAME_ID, .length = JP_CAN_ROUND_OFFER_LENGTH};

    (void)jp_can_round_offer_pack(frame.data, &signals, sizeof frame.data);
    if (jp_operator_send(port, &frame, JP_DATA_ID_ROUND_OFFER, &sender->offer_counter)) {
        sender->has_offered = true;
        sender->since_offer_ms = 0;
    }
}

static void send_data(struct jp_round_sender *sender, const struct jp_can_port *port)
{
    const uint32_t first = sender->next_frame * JP_ROUND_DATA;
    struct jp_can_round_data_t signals = {.index = sender->next_frame};
    struct jp_can_frame frame = {.id = JP_CAN_ROUND_DATA_FRAME_ID, .length = JP_CAN_ROUND_DATA_LENGTH};

    for (uint32_t i = 0; i < JP_ROUND_DATA && first + i < JP_ROUND_BYTES(sender->round.stops); i++) {
        signals.data |= (uint64_t)sender->round.bytes[first + i] << (8U * i);
    }
    (void)jp_can_round_data_pack(frame.data, &signals, sizeof frame.data);
    if (jp_operator_send(port, &frame, JP_DATA_ID_ROUND_DATA, &sender->data_counter)) {
        sender->next_frame++;
        sender->since_data_ms = 0;
    }
}

void jp_round_sender_send(struct jp_round_sender *sender, const struct jp_can_port *port)
{
    if (!sender->is_asked_for) {
        if (sender->since_offer_ms >= OFFER_PERIOD_MS) {
            send_offer(sender, port);
        }
    } else if (sender->next_frame < JP_ROUND_FRAMES(sender->round.stops) && sender->since_data_ms >= DATA_PERIOD_MS) {
        send_data(sender, port);
    } else {
        /* Its end is on its way. */
    }
}
