#include "hal/app/operator.h"

#define COMMAND_PERIOD_MS 100U
#define UPLOAD_PERIOD_MS  5U /* the ECU empties its queue between two plans */
#define UPLOAD_TIMEOUT_MS 500U
#define UPLOAD_ATTEMPTS   5U
#define STAND_UP_MS       10000U
#define BEGIN_MS          5000U

const char *jp_operator_failure_text(enum jp_operator_failure failure)
{
    static const char *const texts[JP_FAILURES] = {
        [JP_FAILURE_SILENCE] = "no EcuStatus and RouteStatus on the bus: is the controller on it, and switched on?",
        [JP_FAILURE_STAND_UP] = "the robot does not stand up: is it upright?",
        [JP_FAILURE_FALLEN] = "the robot has fallen: switch it off and set it up again",
        [JP_FAILURE_FAULT] = "the robot reports a fault: see Faults in EcuErrors, and switch it off",
        [JP_FAILURE_UPLOAD] =
            "the route did not arrive whole in 5 attempts: is another operator on the bus, or does it lose frames?",
        [JP_FAILURE_LENGTH] = "the ECU takes no route of this length",
        [JP_FAILURE_NO_START] = "the ECU does not begin to drive",
        [JP_FAILURE_RESTART] = "the ECU has restarted and knows no route",
        [JP_FAILURE_REPLACED] = "another operator has replaced the route",
        [JP_FAILURE_PLAN] = "the ECU could plan no segment of the route: see PlanStatus",
        [JP_FAILURE_COMMAND] = "the robot was told to stand",
        [JP_FAILURE_TIMEOUT] = "the robot heard no commands for 500 ms and stands",
        [JP_FAILURE_SWITCHED_OFF] = "the robot has fallen or was switched off",
        [JP_FAILURE_STOPPED] = "the ECU stopped the route",
    };

    return texts[failure];
}

static void enter(struct jp_operator *self, enum jp_operator_phase phase)
{
    self->phase = phase;
    self->failure = JP_FAILURE_NONE;
    self->in_phase_ms = 0;
}

static void command_at_once(struct jp_operator *self)
{
    self->commanding = true;
    self->since_command_ms = COMMAND_PERIOD_MS;
}

static void fail(struct jp_operator *self, enum jp_operator_failure failure)
{
    enter(self, JP_OPERATOR_FAILED);
    self->failure = failure;
    command_at_once(self);
}

/* The task. */

static void begin_attempt(struct jp_operator *self)
{
    /* An id that is neither that of the last attempt nor that of the route which the ECU reports. */
    do {
        self->task.id = (uint8_t)(self->task.id == UINT8_MAX ? 1U : self->task.id + 1U);
    } while (self->task.id == self->progress.route_id);
    self->sent = 0;
    self->since_upload_ms = UPLOAD_PERIOD_MS;
    self->attempts++;
}

static void upload(struct jp_operator *self)
{
    enter(self, JP_OPERATOR_UPLOADING);
    self->attempts = 0;
    begin_attempt(self);
}

static void try_upload_again(struct jp_operator *self)
{
    if (self->attempts >= UPLOAD_ATTEMPTS) {
        fail(self, JP_FAILURE_UPLOAD);
        return;
    }
    begin_attempt(self);
}

static bool is_route(const struct jp_point *points, size_t count)
{
    if (points == NULL || count < 1U || count > JP_ROUTE_LENGTH_MAX) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        if (!jp_can_waypoint_x_is_in_range(points[i].x) || !jp_can_waypoint_y_is_in_range(points[i].y)) {
            return false;
        }
    }
    return true;
}

enum jp_status jp_operator_route(struct jp_operator *self, const struct jp_point *points, size_t count)
{
    if (self == NULL || !is_route(points, count)) {
        return JP_ERR_ARGUMENT;
    }
    if (self->phase == JP_OPERATOR_DRIVING && self->begun) {
        self->old_task = self->task.id;
    } else if (self->phase != JP_OPERATOR_UPLOADING) {
        self->old_task = JP_ROUTE_GOAL;
    }
    self->task.length = (uint8_t)count;
    for (size_t i = 0; i < count; i++) {
        self->task.points[i] = points[i];
    }
    self->begun = false;
    if (self->old_task != JP_ROUTE_GOAL) {
        upload(self);
        return JP_OK;
    }
    enter(self, JP_OPERATOR_STANDING_UP);
    command_at_once(self);
    return JP_OK;
}

enum jp_status jp_operator_goal(struct jp_operator *self, const struct jp_point *goal)
{
    return jp_operator_route(self, goal, 1);
}

void jp_operator_stop(struct jp_operator *self)
{
    enter(self, JP_OPERATOR_IDLE);
    if (self->commanding) {
        command_at_once(self);
    }
}

/* What the ECU says. */

static bool is_busy(const struct jp_operator *self)
{
    return self->phase == JP_OPERATOR_STANDING_UP || self->phase == JP_OPERATOR_UPLOADING ||
           self->phase == JP_OPERATOR_DRIVING;
}

static bool is_heard(const struct jp_operator *self)
{
    return self->ecu_ear.heard && self->progress_ear.heard;
}

static bool is_obeyed(const struct jp_operator *self)
{
    return self->ecu.operator_state == JP_OPERATOR_ALIVE;
}

static void hear_ecu(struct jp_operator *self)
{
    if (!is_busy(self)) {
        return;
    }
    if (self->ecu.state == JP_CAN_ECU_STATUS_STATE_FALLEN_CHOICE) {
        fail(self, JP_FAILURE_FALLEN);
    } else if (self->ecu.state == JP_CAN_ECU_STATUS_STATE_FAULT_CHOICE) {
        fail(self, JP_FAILURE_FAULT);
    } else if (self->phase == JP_OPERATOR_STANDING_UP && is_heard(self) && is_obeyed(self) &&
               self->ecu.state == JP_CAN_ECU_STATUS_STATE_STANDING_CHOICE) {
        upload(self);
    }
}

static enum jp_operator_failure failure_of(uint8_t reason)
{
    switch ((enum jp_route_reason)reason) {
    case JP_REASON_LENGTH:
        return JP_FAILURE_LENGTH;
    case JP_REASON_PLAN:
        return JP_FAILURE_PLAN;
    case JP_REASON_COMMAND:
        return JP_FAILURE_COMMAND;
    case JP_REASON_TIMEOUT:
        return JP_FAILURE_TIMEOUT;
    case JP_REASON_SWITCHED_OFF:
        return JP_FAILURE_SWITCHED_OFF;
    case JP_REASON_SEQUENCE:
    case JP_REASON_ROUTE_CRC:
    case JP_REASON_NONE:
    default:
        return JP_FAILURE_STOPPED;
    }
}

static void hear_upload(struct jp_operator *self)
{
    if (self->progress.route_id != self->task.id) {
        return;
    }
    if (self->progress.state == JP_ROUTE_READY) {
        enter(self, JP_OPERATOR_DRIVING);
        self->old_task = JP_ROUTE_GOAL;
    } else if (self->progress.state == JP_ROUTE_REJECTED && self->progress.reason == JP_REASON_LENGTH) {
        fail(self, failure_of(self->progress.reason));
    } else if (self->progress.state == JP_ROUTE_REJECTED) {
        try_upload_again(self);
    }
}

static void hear_driving(struct jp_operator *self)
{
    if (self->progress.state == JP_ROUTE_NONE) {
        fail(self, JP_FAILURE_RESTART);
    } else if (self->progress.route_id != self->task.id) {
        fail(self, JP_FAILURE_REPLACED);
    } else if (self->progress.state == JP_ROUTE_DRIVING) {
        self->begun = true;
    } else if (self->progress.state == JP_ROUTE_DONE) {
        enter(self, JP_OPERATOR_DONE);
    } else if (self->progress.state != JP_ROUTE_READY) {
        fail(self, failure_of(self->progress.reason));
    }
}

static void hear_progress(struct jp_operator *self)
{
    if (self->phase == JP_OPERATOR_UPLOADING) {
        hear_upload(self);
    } else if (self->phase == JP_OPERATOR_DRIVING) {
        hear_driving(self);
    }
}

/* Statuses have no checksum of their own, so only what two in a row say counts. */

static void accept_ecu_status(struct jp_operator *self, const struct jp_can_frame *frame)
{
    const struct jp_can_ecu_status_t before = self->ecu;

    (void)jp_can_ecu_status_unpack(&self->ecu, frame->data, frame->length);
    self->ecu_ear = (struct jp_operator_ear){.heard = true};
    if (self->ecu.state == before.state && self->ecu.operator_state == before.operator_state) {
        hear_ecu(self);
    }
}

static void accept_route_status(struct jp_operator *self, const struct jp_can_frame *frame)
{
    const struct jp_can_route_status_t before = self->progress;

    (void)jp_can_route_status_unpack(&self->progress, frame->data, frame->length);
    self->progress_ear = (struct jp_operator_ear){.heard = true};
    if (self->progress.route_id == before.route_id && self->progress.state == before.state &&
        self->progress.reason == before.reason) {
        hear_progress(self);
    }
}

void jp_operator_accept(struct jp_operator *self, const struct jp_can_frame *frame)
{
    if (frame->id == JP_CAN_ECU_STATUS_FRAME_ID && frame->length == JP_CAN_ECU_STATUS_LENGTH) {
        accept_ecu_status(self, frame);
    } else if (frame->id == JP_CAN_ROUTE_STATUS_FRAME_ID && frame->length == JP_CAN_ROUTE_STATUS_LENGTH) {
        accept_route_status(self, frame);
    }
}

/* What is sent. */

/** The route to be driven, or JP_ROUTE_GOAL to stand. An ECU that has lost its operator obeys only after a Stand. */
static uint8_t driven_route(const struct jp_operator *self)
{
    if (self->phase == JP_OPERATOR_UPLOADING) {
        return self->old_task;
    }
    return self->phase == JP_OPERATOR_DRIVING && (self->begun || is_obeyed(self)) ? self->task.id : JP_ROUTE_GOAL;
}

static void send_command(struct jp_operator *self, const struct jp_can_port *port)
{
    const uint8_t route = driven_route(self);
    const struct jp_can_operator_command_t signals = {.mode = route == JP_ROUTE_GOAL ? JP_MODE_STAND : JP_MODE_DRIVE,
                                                      .route_id = route};
    struct jp_can_frame frame = {.id = JP_CAN_OPERATOR_COMMAND_FRAME_ID, .length = JP_CAN_OPERATOR_COMMAND_LENGTH};

    (void)jp_can_operator_command_pack(frame.data, &signals, sizeof frame.data);
    if (jp_operator_send(port, &frame, JP_DATA_ID_OPERATOR_COMMAND, &self->command_counter)) {
        self->since_command_ms = 0;
    }
}

static uint32_t task_crc(const struct jp_route_message *task)
{
    uint32_t crc = JP_ROUTE_CRC_START;

    for (unsigned i = 0; i < task->length; i++) {
        crc = jp_route_crc(crc, &task->points[i]);
    }
    return crc;
}

static bool send_offer(struct jp_operator *self, const struct jp_can_port *port)
{
    const struct jp_can_route_offer_t signals = {
        .route_id = self->task.id, .length = self->task.length, .route_crc = task_crc(&self->task)};
    struct jp_can_frame frame = {.id = JP_CAN_ROUTE_OFFER_FRAME_ID, .length = JP_CAN_ROUTE_OFFER_LENGTH};

    (void)jp_can_route_offer_pack(frame.data, &signals, sizeof frame.data);
    return jp_operator_send(port, &frame, JP_DATA_ID_ROUTE_OFFER, &self->offer_counter);
}

static bool send_waypoint(struct jp_operator *self, const struct jp_can_port *port)
{
    const struct jp_point *point = &self->task.points[self->sent - 1U];
    const struct jp_can_waypoint_t signals = {.x = point->x, .y = point->y};
    struct jp_can_frame frame = {.id = JP_CAN_WAYPOINT_FRAME_ID, .length = JP_CAN_WAYPOINT_LENGTH};

    (void)jp_can_waypoint_pack(frame.data, &signals, sizeof frame.data);
    return jp_operator_send(port, &frame, JP_DATA_ID_WAYPOINT, &self->waypoint_counter);
}

static void send_upload(struct jp_operator *self, const struct jp_can_port *port)
{
    const bool sent = self->sent == 0U ? send_offer(self, port) : send_waypoint(self, port);

    if (sent) {
        self->sent++;
        self->since_upload_ms = 0;
    }
}

static void send_due(struct jp_operator *self, const struct jp_can_port *port)
{
    if (self->commanding && self->since_command_ms >= COMMAND_PERIOD_MS) {
        send_command(self, port);
    } else if (self->phase == JP_OPERATOR_UPLOADING && self->sent <= self->task.length &&
               self->since_upload_ms >= UPLOAD_PERIOD_MS) {
        send_upload(self, port);
    }
}

/* Time. */

static void pass(struct jp_operator *self, uint32_t time_ms)
{
    const uint32_t elapsed = self->ticked ? time_ms - self->last_tick_ms : 0;

    self->ticked = true;
    self->last_tick_ms = time_ms;
    self->in_phase_ms += elapsed;
    self->since_command_ms += elapsed;
    self->since_upload_ms += elapsed;
    jp_operator_ear_age(&self->ecu_ear, elapsed);
    jp_operator_ear_age(&self->progress_ear, elapsed);
}

static void check_stand_up(struct jp_operator *self)
{
    if (self->in_phase_ms >= STAND_UP_MS) {
        fail(self, is_heard(self) ? JP_FAILURE_STAND_UP : JP_FAILURE_SILENCE);
    }
}

static void check_upload(struct jp_operator *self)
{
    if (!is_heard(self)) {
        fail(self, JP_FAILURE_SILENCE);
    } else if (self->since_upload_ms >= UPLOAD_TIMEOUT_MS) {
        try_upload_again(self);
    }
}

static void check_driving(struct jp_operator *self)
{
    if (!is_heard(self)) {
        fail(self, JP_FAILURE_SILENCE);
    } else if (!self->begun && self->in_phase_ms >= BEGIN_MS) {
        fail(self, JP_FAILURE_NO_START);
    }
}

static void check_patience(struct jp_operator *self)
{
    switch (self->phase) {
    case JP_OPERATOR_STANDING_UP:
        check_stand_up(self);
        break;
    case JP_OPERATOR_UPLOADING:
        check_upload(self);
        break;
    case JP_OPERATOR_DRIVING:
        check_driving(self);
        break;
    case JP_OPERATOR_IDLE:
    case JP_OPERATOR_DONE:
    case JP_OPERATOR_FAILED:
    default:
        break;
    }
}

void jp_operator_tick(struct jp_operator *self, uint32_t time_ms, const struct jp_can_port *port)
{
    pass(self, time_ms);
    check_patience(self);
    send_due(self, port);
}
