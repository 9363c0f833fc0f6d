#include "hal/app/navigation_operator.h"

#include <stddef.h>

#include "hal/storage/crc32.h"

#define COMMAND_PERIOD_MS 100U
#define DATA_PERIOD_MS    2U
#define REQUEST_PERIOD_MS 100U
#define REFUSAL_MS        300U /* in which two statuses tell of it */
#define OFFERS_MAX        50U
#define STAND_UP_MS       10000U
#define SENDING_MS        120000U
#define BEGIN_MS          5000U

/** MapData on its way: what is sent between two statuses, twice. */
#define DATA_WINDOW 128U

/** CellChanges on their way: their counter has four bits. */
#define CHANGES_WINDOW 8U

/** What is not acknowledged for so long is sent again. */
#define CHANGES_LOST_MS 250U

const char *jp_navigation_failure_text(enum jp_navigation_failure failure)
{
    static const char *const texts[JP_NAVIGATION_FAILURES] = {
        [JP_NAVIGATION_NO_FAILURE] = "nothing has failed",
        [JP_NAVIGATION_SILENCE] = "no EcuStatus and MapStatus on the bus: is the controller on it, with a navigator?",
        [JP_NAVIGATION_STAND_UP] = "the robot does not stand up: is it upright?",
        [JP_NAVIGATION_FALLEN] = "the robot has fallen: switch it off and set it up again",
        [JP_NAVIGATION_FAULT] = "the robot reports a fault: see Faults in EcuErrors, and switch it off",
        [JP_NAVIGATION_MAP] = "the ECU refuses the map: see Reason in MapStatus",
        [JP_NAVIGATION_LOST] = "the map did not arrive whole: does the bus lose frames, or is another operator on it?",
        [JP_NAVIGATION_GOAL] = "the ECU refuses the goal: see Answer in NavigationStatus",
        [JP_NAVIGATION_NO_START] = "the ECU does not begin to drive",
        [JP_NAVIGATION_RESTART] = "the ECU has restarted or was given another task, and has lost this one",
        [JP_NAVIGATION_UNREACHABLE] = "no way leads to the goal: give another one",
        [JP_NAVIGATION_GAVE_UP] = "the navigator gave up: see Reason in NavigationStatus",
        [JP_NAVIGATION_STOPPED] = "the robot was told to stand, or heard no commands for 500 ms",
        [JP_NAVIGATION_CAME_HOME] = "the robot has come home again: charge it, or give a goal that can be reached",
        [JP_NAVIGATION_NO_WAY_HOME] = "no way leads home: see HomeState in HomeStatus",
        [JP_NAVIGATION_ROUND] = "the ECU refuses the round: see Reason, Field and Stop in RoundStatus",
        [JP_NAVIGATION_ROUND_ENDED] = "the robot has given the round up: see Reason and Stop in RoundStatus",
    };

    return texts[failure];
}

static void enter(struct jp_navigation_operator *self, enum jp_navigation_phase phase)
{
    self->phase = phase;
    self->failure = JP_NAVIGATION_NO_FAILURE;
    self->in_phase_ms = 0;
    self->since_request_ms = REQUEST_PERIOD_MS;
}

static void command_at_once(struct jp_navigation_operator *self)
{
    self->commanding = true;
    self->since_command_ms = COMMAND_PERIOD_MS;
}

static void fail(struct jp_navigation_operator *self, enum jp_navigation_failure failure)
{
    enter(self, JP_NAVIGATION_FAILED);
    self->failure = failure;
    command_at_once(self);
}

/* The task. */

static bool is_in_range(const struct jp_map_stream *stream)
{
    return stream->bytes != NULL && jp_can_map_offer_map_id_is_in_range(stream->id) && stream->id <= 15U &&
           jp_can_map_offer_bytes_is_in_range(stream->length);
}

static void begin(struct jp_navigation_operator *self, const struct jp_map_stream *stream)
{
    const uint32_t crc = jp_crc32(0, stream->bytes, stream->length);

    if (crc != self->crc || stream->id != self->stream.id) {
        /* What was seen otherwise than on another map. */
        self->changes.count = 0;
        self->changes.sent = 0;
    }
    self->stream = *stream;
    self->crc = crc;
    self->goal.map = stream->id;
    self->offers = 0;
    self->begun = false;
    enter(self, JP_NAVIGATION_STANDING_UP);
    command_at_once(self);
}

enum jp_status jp_navigation_operator_go(struct jp_navigation_operator *self, const struct jp_map_stream *stream,
                                         const struct jp_map_goal *goal)
{
    if (self == NULL || stream == NULL || goal == NULL || !is_in_range(stream)) {
        return JP_ERR_ARGUMENT;
    }
    const uint8_t before = self->goal.id;

    self->is_round = false;
    self->goal = *goal;
    self->goal.id = before;
    begin(self, stream);
    return JP_OK;
}

enum jp_status jp_navigation_operator_patrol(struct jp_navigation_operator *self, const struct jp_map_stream *stream,
                                             const struct jp_round_bytes *round)
{
    if (self == NULL || stream == NULL || round == NULL || !is_in_range(stream) || round->bytes == NULL ||
        !jp_can_round_offer_stops_is_in_range(round->stops)) {
        return JP_ERR_ARGUMENT;
    }
    self->is_round = true;
    self->round_bytes = *round;
    begin(self, stream);
    return JP_OK;
}

void jp_navigation_operator_stop(struct jp_navigation_operator *self)
{
    enter(self, JP_NAVIGATION_IDLE);
    if (self->commanding) {
        command_at_once(self);
    }
}

static bool has_map(const struct jp_navigation_operator *self)
{
    return self->map.map_id == self->stream.id && self->map.map_crc == self->crc;
}

static void send_map(struct jp_navigation_operator *self)
{
    enter(self, JP_NAVIGATION_SENDING);
    self->next_frame = has_map(self) ? self->map.received : 0U;
    self->frames_before = self->next_frame;
    self->since_data_ms = DATA_PERIOD_MS;
}

/** With an id that is neither that of the last goal nor one that the ECU reports. */
static void ask(struct jp_navigation_operator *self)
{
    enter(self, JP_NAVIGATION_ASKING);
    self->begun = false;
    do {
        self->goal.id = (uint8_t)(self->goal.id == UINT8_MAX ? 1U : self->goal.id + 1U);
    } while (self->goal.id == self->navigator.goal_id || self->goal.id == self->round.round_id);
    if (self->is_round) {
        jp_round_sender_begin(&self->sender, &self->round_bytes, self->stream.id, self->goal.id);
    }
}

/* Changes of the map. */

static struct jp_cell_changes *change_at(struct jp_change_queue *queue, unsigned index)
{
    return &queue->items[(queue->head + index) % JP_CHANGES_WAITING];
}

static uint32_t with_cell(uint32_t cells, unsigned index, uint32_t cell)
{
    return (cells & ~(JP_CELL_UNCHANGED << (2U * index))) | (cell << (2U * index));
}

/** Into a frame that waits to be sent. */
static bool joins(struct jp_change_queue *queue, uint16_t x, uint16_t y, enum jp_cell cell)
{
    struct jp_cell_changes *last = change_at(queue, queue->count - 1U);

    if (queue->count == queue->sent || last->y != y || x < last->x || x >= last->x + JP_CELL_CHANGES) {
        return false;
    }
    last->cells = with_cell(last->cells, (unsigned)x - last->x, (uint32_t)cell);
    return true;
}

enum jp_status jp_navigation_operator_see(struct jp_navigation_operator *self, uint16_t x, uint16_t y,
                                          enum jp_cell cell)
{
    struct jp_change_queue *queue = &self->changes;

    if (queue->count > 0U && joins(queue, x, y, cell)) {
        return JP_OK;
    }
    if (queue->count == JP_CHANGES_WAITING) {
        return JP_ERR_BUSY;
    }
    queue->count++;
    *change_at(queue, queue->count - 1U) =
        (struct jp_cell_changes){.x = x, .y = y, .cells = with_cell(0xFFFFFFU, 0, (uint32_t)cell)};
    return JP_OK;
}

static void hear_changes(struct jp_change_queue *queue, uint8_t counter)
{
    const uint8_t taken = (uint8_t)((counter - queue->acknowledged) & 0x0FU);

    if (taken > 0U && taken <= queue->sent) {
        queue->head = (uint8_t)((queue->head + taken) % JP_CHANGES_WAITING);
        queue->count = (uint8_t)(queue->count - taken);
        queue->sent = (uint8_t)(queue->sent - taken);
        queue->acknowledged = counter;
        queue->quiet_ms = 0;
    } else if (queue->sent == 0U || queue->quiet_ms >= CHANGES_LOST_MS) {
        queue->acknowledged = counter;
        queue->counter = counter;
        queue->sent = 0;
        queue->quiet_ms = 0;
    } else {
        /* They may be on their way. */
    }
}

/* What the ECU says. */

static bool is_busy(const struct jp_navigation_operator *self)
{
    return self->phase >= JP_NAVIGATION_STANDING_UP && self->phase <= JP_NAVIGATION_DRIVING;
}

static bool is_heard(const struct jp_navigation_operator *self)
{
    return self->ecu_ear.heard && self->map_ear.heard;
}

static bool is_obeyed(const struct jp_navigation_operator *self)
{
    return self->ecu.operator_state == JP_OPERATOR_ALIVE;
}

static void hear_ecu(struct jp_navigation_operator *self)
{
    if (!is_busy(self)) {
        return;
    }
    if (self->ecu.state == JP_CAN_ECU_STATUS_STATE_FALLEN_CHOICE) {
        fail(self, JP_NAVIGATION_FALLEN);
    } else if (self->ecu.state == JP_CAN_ECU_STATUS_STATE_FAULT_CHOICE) {
        fail(self, JP_NAVIGATION_FAULT);
    } else if (self->phase == JP_NAVIGATION_STANDING_UP && is_heard(self) && is_obeyed(self) &&
               self->ecu.state == JP_CAN_ECU_STATUS_STATE_STANDING_CHOICE) {
        send_map(self);
    }
}

/** What the ECU has taken since the status before, or goes on from where it was when it has taken nothing. */
static void hear_map_growing(struct jp_navigation_operator *self)
{
    if (self->map.received == self->frames_before) {
        self->next_frame = self->map.received;
    }
    self->frames_before = self->map.received;
}

static void hear_map_refused(struct jp_navigation_operator *self)
{
    const bool may_be_damaged = self->map.reason == JP_MAP_REASON_CRC || self->map.reason == JP_MAP_REASON_FORMAT;

    if (self->offers > 0U && (!may_be_damaged || self->offers >= OFFERS_MAX)) {
        fail(self, JP_NAVIGATION_MAP);
    }
}

static void hear_map_while_sending(struct jp_navigation_operator *self)
{
    if (self->offers > 0U && self->map.reason == JP_MAP_REASON_UNDER_WAY) {
        fail(self, JP_NAVIGATION_MAP);
    } else if (!has_map(self) || self->map.state == JP_MAP_LINK_NONE) {
        self->next_frame = 0;
        self->frames_before = 0;
    } else if (self->map.state == JP_MAP_LINK_READY) {
        ask(self);
    } else if (self->map.state == JP_MAP_LINK_REJECTED) {
        hear_map_refused(self);
    } else {
        hear_map_growing(self);
    }
}

static void hear_map(struct jp_navigation_operator *self)
{
    if (self->phase == JP_NAVIGATION_SENDING) {
        hear_map_while_sending(self);
    } else if ((self->phase == JP_NAVIGATION_ASKING || self->phase == JP_NAVIGATION_DRIVING) &&
               (!has_map(self) || self->map.state != JP_MAP_LINK_READY)) {
        fail(self, JP_NAVIGATION_RESTART);
    } else {
        /* The map is of no account, or there. */
    }
}

static void hear_asking(struct jp_navigation_operator *self)
{
    if (self->navigator.goal_id != self->goal.id) {
        return;
    }
    if (self->navigator.answer == JP_GOAL_TAKEN) {
        enter(self, JP_NAVIGATION_DRIVING);
    } else {
        fail(self, JP_NAVIGATION_GOAL);
    }
}

/** It comes home instead, or did not leave. */
static void hear_coming_home(struct jp_navigation_operator *self)
{
    const enum jp_navigator_state state = (enum jp_navigator_state)self->navigator.state;

    if (state == JP_NAVIGATOR_ARRIVED) {
        fail(self, JP_NAVIGATION_CAME_HOME);
    } else if (state == JP_NAVIGATOR_IDLE && self->navigator.reason == JP_NAVIGATOR_TOLD) {
        fail(self, JP_NAVIGATION_STOPPED);
    } else if (state == JP_NAVIGATOR_IDLE || state > JP_NAVIGATOR_ARRIVED) {
        fail(self, JP_NAVIGATION_NO_WAY_HOME);
    } else {
        self->begun = true;
    }
}

static void hear_driving(struct jp_navigation_operator *self)
{
    const enum jp_navigator_state state = (enum jp_navigator_state)self->navigator.state;

    if (self->navigator.goal_id != self->goal.id) {
        fail(self, JP_NAVIGATION_RESTART);
    } else if (self->navigator.answer == JP_GOAL_BLOCKED) {
        fail(self, JP_NAVIGATION_GOAL);
    } else if (self->navigator.answer == JP_GOAL_HOME) {
        hear_coming_home(self);
    } else if (self->navigator.answer != JP_GOAL_DRIVEN) {
        /* It has not begun yet. */
    } else if (state == JP_NAVIGATOR_ARRIVED) {
        enter(self, JP_NAVIGATION_DONE);
    } else if (state == JP_NAVIGATOR_UNREACHABLE) {
        fail(self, JP_NAVIGATION_UNREACHABLE);
    } else if (state == JP_NAVIGATOR_FAILED) {
        fail(self, JP_NAVIGATION_GAVE_UP);
    } else if (state == JP_NAVIGATOR_IDLE) {
        fail(self, JP_NAVIGATION_STOPPED);
    } else {
        self->begun = true;
    }
}

static void hear_navigator(struct jp_navigation_operator *self)
{
    if (self->is_round) {
        return; /* RoundStatus tells of it */
    }
    if (self->phase == JP_NAVIGATION_ASKING) {
        hear_asking(self);
    } else if (self->phase == JP_NAVIGATION_DRIVING) {
        hear_driving(self);
    } else {
        /* It is of no account. */
    }
}

static void hear_asking_round(struct jp_navigation_operator *self)
{
    switch (jp_round_sender_hear(&self->sender, &self->round)) {
    case JP_ROUND_ANSWER_TAKEN:
        enter(self, JP_NAVIGATION_DRIVING);
        break;
    case JP_ROUND_ANSWER_REFUSED:
        fail(self, JP_NAVIGATION_ROUND);
        break;
    case JP_ROUND_ANSWER_NONE:
    default:
        break;
    }
}

static void hear_driving_round(struct jp_navigation_operator *self)
{
    if (self->round.round_id != self->goal.id) {
        fail(self, JP_NAVIGATION_RESTART);
    } else if (self->round.state == JP_CAN_ROUND_STATUS_STATE_FAILED_CHOICE) {
        fail(self, JP_NAVIGATION_ROUND_ENDED);
    } else if (self->round.state == JP_CAN_ROUND_STATUS_STATE_STOPPED_CHOICE) {
        fail(self, JP_NAVIGATION_STOPPED);
    } else {
        self->begun = self->round.state != JP_CAN_ROUND_STATUS_STATE_READY_CHOICE;
    }
}

static void hear_round(struct jp_navigation_operator *self)
{
    if (!self->is_round) {
        return; /* it is of another operator */
    }
    if (self->phase == JP_NAVIGATION_ASKING) {
        hear_asking_round(self);
    } else if (self->phase == JP_NAVIGATION_DRIVING) {
        hear_driving_round(self);
    } else {
        /* It is of no account. */
    }
}

/* Statuses have no checksum of their own, so only what two in a row say counts. */

static void accept_ecu_status(struct jp_navigation_operator *self, const struct jp_can_frame *frame)
{
    const struct jp_can_ecu_status_t before = self->ecu;

    (void)jp_can_ecu_status_unpack(&self->ecu, frame->data, frame->length);
    self->ecu_ear = (struct jp_operator_ear){.heard = true};
    if (self->ecu.state == before.state && self->ecu.operator_state == before.operator_state) {
        hear_ecu(self);
    }
}

static void accept_map_status(struct jp_navigation_operator *self, const struct jp_can_frame *frame)
{
    const struct jp_can_map_status_t before = self->map;

    (void)jp_can_map_status_unpack(&self->map, frame->data, frame->length);
    self->map_ear = (struct jp_operator_ear){.heard = true};
    if (self->map.map_id == before.map_id && self->map.state == before.state && self->map.reason == before.reason &&
        self->map.map_crc == before.map_crc) {
        hear_map(self);
        hear_changes(&self->changes, self->map.cell_counter);
    }
}

static void accept_navigation_status(struct jp_navigation_operator *self, const struct jp_can_frame *frame)
{
    const struct jp_can_navigation_status_t before = self->navigator;

    (void)jp_can_navigation_status_unpack(&self->navigator, frame->data, frame->length);
    if (self->navigator.goal_id == before.goal_id && self->navigator.state == before.state &&
        self->navigator.answer == before.answer) {
        hear_navigator(self);
    }
}

static void accept_round_status(struct jp_navigation_operator *self, const struct jp_can_frame *frame)
{
    const struct jp_can_round_status_t before = self->round;

    (void)jp_can_round_status_unpack(&self->round, frame->data, frame->length);
    if (self->round.round_id == before.round_id && self->round.state == before.state &&
        self->round.reason == before.reason) {
        hear_round(self);
    }
}

void jp_navigation_operator_accept(struct jp_navigation_operator *self, const struct jp_can_frame *frame)
{
    if (frame->id == JP_CAN_ECU_STATUS_FRAME_ID && frame->length == JP_CAN_ECU_STATUS_LENGTH) {
        accept_ecu_status(self, frame);
    } else if (frame->id == JP_CAN_MAP_STATUS_FRAME_ID && frame->length == JP_CAN_MAP_STATUS_LENGTH) {
        accept_map_status(self, frame);
    } else if (frame->id == JP_CAN_NAVIGATION_STATUS_FRAME_ID && frame->length == JP_CAN_NAVIGATION_STATUS_LENGTH) {
        accept_navigation_status(self, frame);
    } else if (frame->id == JP_CAN_HOME_STATUS_FRAME_ID && frame->length == JP_CAN_HOME_STATUS_LENGTH) {
        (void)jp_can_home_status_unpack(&self->home, frame->data, frame->length);
    } else if (frame->id == JP_CAN_HOME_BATTERY_FRAME_ID && frame->length == JP_CAN_HOME_BATTERY_LENGTH) {
        (void)jp_can_home_battery_unpack(&self->battery, frame->data, frame->length);
    } else if (frame->id == JP_CAN_ROUND_STATUS_FRAME_ID && frame->length == JP_CAN_ROUND_STATUS_LENGTH) {
        accept_round_status(self, frame);
    } else if (frame->id == JP_CAN_ROUND_BATTERY_FRAME_ID && frame->length == JP_CAN_ROUND_BATTERY_LENGTH) {
        (void)jp_can_round_battery_unpack(&self->round_battery, frame->data, frame->length);
    } else {
        /* It is of others. */
    }
}

/* What is sent. */

static struct jp_can_frame frame_of(uint32_t id, uint8_t length)
{
    return (struct jp_can_frame){.id = id, .length = length};
}

/** An ECU that has lost its operator obeys only after a Stand. */
static void send_command(struct jp_navigation_operator *self, const struct jp_can_port *port)
{
    const bool drives = self->phase == JP_NAVIGATION_DRIVING && (self->begun || is_obeyed(self));
    const struct jp_can_operator_command_t signals = {.mode = drives ? JP_MODE_NAVIGATE : JP_MODE_STAND,
                                                      .route_id = drives ? self->goal.id : 0U};
    struct jp_can_frame frame = frame_of(JP_CAN_OPERATOR_COMMAND_FRAME_ID, JP_CAN_OPERATOR_COMMAND_LENGTH);

    (void)jp_can_operator_command_pack(frame.data, &signals, sizeof frame.data);
    if (jp_operator_send(port, &frame, JP_DATA_ID_OPERATOR_COMMAND, &self->command_counter)) {
        self->since_command_ms = 0;
    }
}

static void send_offer(struct jp_navigation_operator *self, const struct jp_can_port *port)
{
    const struct jp_can_map_offer_t signals = {
        .map_id = self->stream.id, .bytes = self->stream.length, .map_crc = self->crc};
    struct jp_can_frame frame = frame_of(JP_CAN_MAP_OFFER_FRAME_ID, JP_CAN_MAP_OFFER_LENGTH);

    (void)jp_can_map_offer_pack(frame.data, &signals, sizeof frame.data);
    if (jp_operator_send(port, &frame, JP_DATA_ID_MAP_OFFER, &self->offer_counter)) {
        self->since_request_ms = 0;
        self->offers++;
    }
}

static void send_data(struct jp_navigation_operator *self, const struct jp_can_port *port)
{
    const uint32_t first = self->next_frame * JP_MAP_DATA;
    struct jp_can_map_data_t signals = {.index = (uint16_t)(self->next_frame & 0xFFFU)};
    struct jp_can_frame frame = frame_of(JP_CAN_MAP_DATA_FRAME_ID, JP_CAN_MAP_DATA_LENGTH);

    for (uint32_t i = 0; i < JP_MAP_DATA && first + i < self->stream.length; i++) {
        signals.data |= (uint64_t)self->stream.bytes[first + i] << (8U * i);
    }
    (void)jp_can_map_data_pack(frame.data, &signals, sizeof frame.data);
    if (jp_operator_send(port, &frame, JP_DATA_ID_MAP_DATA, &self->data_counter)) {
        self->next_frame++;
        self->since_data_ms = 0;
    }
}

static void send_goal(struct jp_navigation_operator *self, const struct jp_can_port *port)
{
    const struct jp_can_map_goal_t signals = {.map_id = self->goal.map,
                                              .goal_id = self->goal.id,
                                              .column = self->goal.x,
                                              .row = self->goal.y,
                                              .has_heading = self->goal.has_heading ? 1U : 0U,
                                              .heading = (int16_t)((int32_t)self->goal.heading >> 20)};
    struct jp_can_frame frame = frame_of(JP_CAN_MAP_GOAL_FRAME_ID, JP_CAN_MAP_GOAL_LENGTH);

    (void)jp_can_map_goal_pack(frame.data, &signals, sizeof frame.data);
    if (jp_operator_send(port, &frame, JP_DATA_ID_MAP_GOAL, &self->goal_counter)) {
        self->since_request_ms = 0;
    }
}

static void send_changes(struct jp_navigation_operator *self, const struct jp_can_port *port)
{
    struct jp_change_queue *queue = &self->changes;
    const struct jp_cell_changes *changes = change_at(queue, queue->sent);
    const struct jp_can_cell_changes_t signals = {
        .map_id = self->stream.id, .column = changes->x, .row = changes->y, .cells = changes->cells};
    struct jp_can_frame frame = frame_of(JP_CAN_CELL_CHANGES_FRAME_ID, JP_CAN_CELL_CHANGES_LENGTH);

    (void)jp_can_cell_changes_pack(frame.data, &signals, sizeof frame.data);
    if (jp_operator_send(port, &frame, JP_DATA_ID_CELL_CHANGES, &queue->counter)) {
        queue->quiet_ms = queue->sent == 0U ? 0U : queue->quiet_ms;
        queue->sent++;
    }
}

static bool is_map_ready(const struct jp_navigation_operator *self)
{
    return has_map(self) && self->map.state == JP_MAP_LINK_READY;
}

static bool has_changes_to_send(const struct jp_navigation_operator *self)
{
    const struct jp_change_queue *queue = &self->changes;

    return is_map_ready(self) && queue->sent < queue->count && queue->sent < CHANGES_WINDOW;
}

static bool has_data_to_send(const struct jp_navigation_operator *self)
{
    return self->phase == JP_NAVIGATION_SENDING && has_map(self) && self->map.state == JP_MAP_LINK_RECEIVING &&
           self->since_data_ms >= DATA_PERIOD_MS && self->next_frame * JP_MAP_DATA < self->stream.length &&
           self->next_frame < self->map.received + DATA_WINDOW;
}

static bool has_offer_to_send(const struct jp_navigation_operator *self)
{
    const bool is_refused = has_map(self) && self->map.state == JP_MAP_LINK_REJECTED;

    return self->phase == JP_NAVIGATION_SENDING &&
           self->since_request_ms >= (is_refused ? REFUSAL_MS : REQUEST_PERIOD_MS) &&
           !(has_map(self) && (self->map.state == JP_MAP_LINK_RECEIVING || self->map.state == JP_MAP_LINK_READY));
}

/** One frame at most. */
static void send_due(struct jp_navigation_operator *self, const struct jp_can_port *port)
{
    if (self->commanding && self->since_command_ms >= COMMAND_PERIOD_MS) {
        send_command(self, port);
    } else if (has_changes_to_send(self)) {
        send_changes(self, port);
    } else if (has_offer_to_send(self)) {
        send_offer(self, port);
    } else if (has_data_to_send(self)) {
        send_data(self, port);
    } else if (self->phase == JP_NAVIGATION_ASKING && self->is_round) {
        jp_round_sender_send(&self->sender, port);
    } else if (self->phase == JP_NAVIGATION_ASKING && self->since_request_ms >= REQUEST_PERIOD_MS) {
        send_goal(self, port);
    } else {
        /* Nothing is due. */
    }
}

/* Time. */

static void pass(struct jp_navigation_operator *self, uint32_t time_ms)
{
    const uint32_t elapsed = self->ticked ? time_ms - self->last_tick_ms : 0;

    self->ticked = true;
    self->last_tick_ms = time_ms;
    self->in_phase_ms += elapsed;
    self->since_command_ms += elapsed;
    self->since_data_ms += elapsed;
    self->since_request_ms += elapsed;
    self->changes.quiet_ms += elapsed;
    jp_round_sender_pass(&self->sender, elapsed);
    jp_operator_ear_age(&self->ecu_ear, elapsed);
    jp_operator_ear_age(&self->map_ear, elapsed);
}

static enum jp_navigation_failure overdue(const struct jp_navigation_operator *self)
{
    if (self->phase == JP_NAVIGATION_STANDING_UP) {
        if (self->in_phase_ms < STAND_UP_MS) {
            return JP_NAVIGATION_NO_FAILURE;
        }
        return is_heard(self) ? JP_NAVIGATION_STAND_UP : JP_NAVIGATION_SILENCE;
    }
    if (!is_heard(self)) {
        return JP_NAVIGATION_SILENCE;
    }
    if (self->phase == JP_NAVIGATION_SENDING) {
        return self->in_phase_ms < SENDING_MS ? JP_NAVIGATION_NO_FAILURE : JP_NAVIGATION_LOST;
    }
    return self->begun || self->in_phase_ms < BEGIN_MS ? JP_NAVIGATION_NO_FAILURE : JP_NAVIGATION_NO_START;
}

static void check_patience(struct jp_navigation_operator *self)
{
    const enum jp_navigation_failure failure = is_busy(self) ? overdue(self) : JP_NAVIGATION_NO_FAILURE;

    if (failure != JP_NAVIGATION_NO_FAILURE) {
        fail(self, failure);
    }
}

void jp_navigation_operator_tick(struct jp_navigation_operator *self, uint32_t time_ms, const struct jp_can_port *port)
{
    pass(self, time_ms);
    check_patience(self);
    send_due(self, port);
}
