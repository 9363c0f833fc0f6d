/** An operator's side of a round (round_link.h): sends it in frames until the ECU has it, by what RoundStatus says. */
#ifndef JOULEPATH_HAL_APP_ROUND_SENDER_H
#define JOULEPATH_HAL_APP_ROUND_SENDER_H

#include <stdbool.h>

#include "hal/app/operator_bus.h"
#include "hal/can/jp_can.h"
#include "hal/can/round_link.h"

#ifdef __cplusplus
extern "C" {
#endif

struct jp_round_bytes {
    const uint8_t *bytes; /**< jp_round_encode() */
    uint8_t stops;        /**< 1…JP_ROUND_STOPS_MAX */
};

/** What becomes of it. */
enum jp_round_answer { JP_ROUND_ANSWER_NONE, JP_ROUND_ANSWER_TAKEN, JP_ROUND_ANSWER_REFUSED };

/** Private. */
struct jp_round_sender {
    struct jp_round_bytes round;
    uint8_t map;
    uint8_t id;
    uint32_t crc;
    bool has_offered;
    bool is_asked_for; /* its frames */
    uint8_t next_frame;
    uint8_t frames_before; /* that the status before had told */
    uint32_t since_offer_ms;
    uint32_t since_data_ms;
    uint8_t offer_counter;
    uint8_t data_counter;
};

/** A round on the map of this id, with an id of its own. What it shows must stay. The counters go on. */
void jp_round_sender_begin(struct jp_round_sender *sender, const struct jp_round_bytes *round, uint8_t map, uint8_t id);

/** Hears a status that two in a row say. */
enum jp_round_answer jp_round_sender_hear(struct jp_round_sender *sender, const struct jp_can_round_status_t *status);

void jp_round_sender_pass(struct jp_round_sender *sender, uint32_t elapsed_ms);

/** Sends one frame at most. Constant time. */
void jp_round_sender_send(struct jp_round_sender *sender, const struct jp_can_port *port);

#ifdef __cplusplus
}
#endif

#endif
