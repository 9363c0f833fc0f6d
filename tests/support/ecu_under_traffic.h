/** A controller that any frames may come to: what must hold after each of them, and after each tick. */
#ifndef JOULEPATH_TESTS_SUPPORT_ECU_UNDER_TRAFFIC_H
#define JOULEPATH_TESTS_SUPPORT_ECU_UNDER_TRAFFIC_H

#include "hal/app/telemetry.h"
#include "sim/balancer/rig.h"
#include "sim/bus/ecu_view.h"
#include "tests/support/command_oracle.h"
#include "tests/support/ecu_traffic.h"

static const struct robot_entry *robot;

struct controller {
    struct jp_ecu ecu;
    struct jp_ecu_balancer balancer;
    struct jp_retained retained;
    struct traffic traffic;
    struct command_oracle oracle;
    struct jp_route_message driven; /**< by the oracle */
    struct ecu_view view;           /**< of what it sends */
    uint32_t bad_bus_one_in;
    uint32_t work_one_in;
    unsigned sent;     /**< frames, in this tick */
    uint32_t segments; /**< that the learner has seen end */
};

static struct controller controller;

static struct {
    unsigned long ticks;
    unsigned long enabled;
    unsigned long resumed;
    unsigned long routes;
    unsigned long segments;
    unsigned long stopped; /**< by a fall or a fault */
    unsigned long lost_operators;
    unsigned long full_queues;
    unsigned long learned; /**< or left out: segments */
} seen;

static void check_motor_command(const struct controller *self, const struct jp_can_frame *frame)
{
    const uint64_t duties = oracle_bits(frame, 14, 50);
    const bool enabled = oracle_bits(frame, 12, 1) != 0U;

    require(frame->data[0] == oracle_crc8(frame->data, 8, JP_DATA_ID_MOTOR_COMMAND), "CRC of MotorCommand");
    require(enabled == jp_ecu_runs(&self->ecu), "the motors run in balancing and driving, and in no other state");
    require(enabled || duties == 0U, "duties of bridges that are off");
}

static enum jp_status take_sent(void *context, const struct jp_can_frame *frame)
{
    struct controller *self = context;
    const struct message *message = message_of(frame->id);

    require(message != NULL && message->kind == FROM_ECU && frame->length == message->length, "a frame of another");
    self->sent++;
    if (frame->id == JP_CAN_MOTOR_COMMAND_FRAME_ID) {
        check_motor_command(self, frame);
    }
    ecu_view_accept(&self->view, frame);
    return one_in(self->bad_bus_one_in) ? JP_ERR_BUSY : JP_OK;
}

static enum jp_can_state bus_state(void *context)
{
    const struct controller *self = context;

    return one_in(self->bad_bus_one_in) ? (enum jp_can_state)below(3) : JP_CAN_ON;
}

/** All that only ever counts up. */
struct counters {
    uint32_t samples_crc, samples_sequence, samples_malformed, samples_rejected;
    uint32_t operator_crc, operator_sequence, operator_malformed, operator_rejected;
    uint32_t bus_offs, conflicts, unknown, send_errors, lost, timeouts, tick;
};
#define COUNTERS (sizeof(struct counters) / sizeof(uint32_t))

static struct counters counters_of(const struct jp_ecu *ecu)
{
    return (struct counters){
        ecu->sample_counts.crc_errors,
        ecu->sample_counts.sequence_errors,
        ecu->sample_counts.malformed,
        ecu->sample_counts.rejected,
        ecu->operator_counts.crc_errors,
        ecu->operator_counts.sequence_errors,
        ecu->operator_counts.malformed,
        ecu->operator_counts.rejected,
        ecu->bus_offs,
        ecu->conflicts,
        ecu->unknown_frames,
        ecu->send_errors,
        ecu->internal.samples.lost,
        ecu->operator_timeouts,
        ecu->tick,
    };
}

static void check_counters(const struct counters *before, const struct jp_ecu *ecu)
{
    const struct counters after = counters_of(ecu);
    uint32_t was[COUNTERS];
    uint32_t is[COUNTERS];
    bool grow = true;

    memcpy(was, before, sizeof was);
    memcpy(is, &after, sizeof is);
    for (unsigned i = 0; i < COUNTERS; i++) {
        grow = grow && is[i] >= was[i];
    }
    require(grow, "a counter went back");
}

static void check_ranges(const struct jp_ecu *ecu)
{
    const struct jp_operator_link *operator_link = &ecu->internal.operator_link;
    const struct jp_route_link *routes = &ecu->internal.routes;
    const struct jp_sample_link *samples = &ecu->internal.samples;

    require(ecu->internal.queue_head < JP_ECU_QUEUE && ecu->internal.queue_tail < JP_ECU_QUEUE, "place in the queue");
    require(jp_ecu_state_now(ecu) <= JP_ECU_FAULT, "state of the robot");
    require(operator_link->state <= JP_OPERATOR_LOST && operator_link->mode <= JP_MODE_NAVIGATE &&
                operator_link->heard <= JP_MODE_NAVIGATE && operator_link->confirmations <= JP_OPERATOR_CONFIRMATIONS,
            "state of the operator");
    require(routes->state <= JP_ROUTE_STOPPED && routes->reason <= JP_REASON_SWITCHED_OFF, "state of the route");
    require(routes->received <= JP_ROUTE_LENGTH_MAX && routes->driven.length <= JP_ROUTE_LENGTH_MAX,
            "length of a route");
    require(samples->parts < (1U << JP_SAMPLE_PARTS) && samples->newest < JP_SAMPLE_PACES &&
                samples->missed <= samples->hold_ticks && samples->catch_up <= samples->hold_ticks,
            "state of the samples");
    require(ecu->internal.plan.left <= 3U, "frames of a plan");
    require(ecu->internal.learned.left <= (jp_ecu_learned_state(ecu) != NULL ? 2U : 0U), "frames of what was learned");
}

/** Whatever came, it can be stored, and the robot can plan with it. */
static void check_learned(const struct controller *self)
{
    const struct jp_learned_state *state = jp_ecu_learned_state(&self->ecu);
    const char *field;

    require(state == NULL || jp_learned_state_check(state, &field) == JP_OK, "what was learned is out of range");
    require(jp_energy_model_check(jp_ecu_balancer_model(&self->balancer), &field) == JP_OK,
            "the model that is planned with is out of range");
}

static uint32_t counted(uint32_t before, bool one_more, uint32_t limit)
{
    return one_more && before < limit ? before + 1U : before;
}

/** What a frame counts as before anyone looks into it. */
static void check_accepted(const struct counters *before, const struct jp_ecu *ecu, const struct jp_can_frame *frame)
{
    const struct message *message = message_of(frame->id);
    const bool right = message != NULL && frame->length == message->length;
    const struct counters after = counters_of(ecu);

    require(after.unknown == counted(before->unknown, message == NULL, UINT16_MAX), "unknown frames");
    require(after.samples_malformed == counted(before->samples_malformed, message != NULL && !right, UINT8_MAX),
            "frames of a wrong length");
    require(after.conflicts == counted(before->conflicts, right && message->kind == FROM_ECU, UINT8_MAX), "conflicts");
    seen.full_queues += after.samples_rejected > before->samples_rejected ? 1U : 0U;
}

static void check_view(const struct ecu_view *view)
{
    require(view->status.state <= JP_ROBOT_FAULT && view->status.mode <= JP_MODE_NAVIGATE &&
                view->status.operator_state <= JP_OPERATOR_LOST && view->route.state <= JP_ROUTE_STOPPED &&
                view->route.reason <= JP_REASON_SWITCHED_OFF,
            "an EcuStatus or RouteStatus out of range");
    require(view->learner.evidence < JP_EVIDENCES && view->learner.stored <= JP_STORED_DAMAGED,
            "a LearnerStatus out of range");
}

static void run_tick(struct controller *self)
{
    struct jp_ecu *ecu = &self->ecu;
    const struct jp_robot *moved = &self->balancer.robot;
    const bool ran = jp_ecu_runs(ecu);
    const bool drove = jp_robot_state_now(moved) == JP_ROBOT_DRIVING;
    const bool resuming = moved->internal.resuming;
    const uint16_t ended = jp_robot_last_tick(moved)->segments_ended;

    self->sent = 0;
    jp_ecu_tick(ecu);
    seen.ticks++;
    require(self->sent <= 1U + JP_TELEMETRY_FRAMES_MAX, "frames in a tick");
    if (jp_ecu_runs(ecu)) {
        const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(moved);
        const jp_q16 most = moved->internal.monitor.good.bus_voltage;

        require(telemetry->voltages.left <= most && telemetry->voltages.left >= -most &&
                    telemetry->voltages.right <= most && telemetry->voltages.right >= -most,
                "a duty beyond 1");
        require(ran || resuming || self->oracle.stood, "motors on without a Stand");
        require(drove || telemetry->state != JP_ROBOT_DRIVING || self->oracle.mode == JP_MODE_DRIVE,
                "a robot that drives off without a Drive");
        seen.enabled += ran || resuming ? 0U : 1U;
        seen.resumed += resuming && !ran ? 1U : 0U;
        seen.segments += jp_robot_last_tick(moved)->segments_ended > ended ? 1U : 0U;
    }
    seen.stopped += ran && jp_robot_state_now(moved) >= JP_ROBOT_FALLEN ? 1U : 0U;
    check_view(&self->view);
}

static bool same_route(const struct jp_route_message *a, const struct jp_route_message *b)
{
    return a->id == b->id && a->length == b->length &&
           memcmp(a->points, b->points, a->length * sizeof a->points[0]) == 0;
}

/** The route that is driven is the last one that was offered whole, and commanded; or was so when it was begun. */
static void check_route(struct controller *self)
{
    const struct jp_pilot *pilot = &self->balancer.pilot;
    const struct jp_route_message *driven = &self->ecu.internal.routes.driven;

    require(pilot->phase == JP_PILOT_RESTING ||
                (pilot->internal.route.targets == driven->points && pilot->internal.route.count == driven->length),
            "the pilot's route is not that of the commands");
    if (self->ecu.internal.routes.state != JP_ROUTE_DRIVING || same_route(driven, &self->driven)) {
        return;
    }
    require(oracle_is_whole(&self->oracle) && same_route(driven, &self->oracle.offered), "a route that nobody offered");
    require(self->oracle.stood && self->oracle.mode == JP_MODE_DRIVE && self->oracle.route == driven->id,
            "a route that nobody commanded");
    self->driven = *driven;
    seen.routes++;
}

static void run_work(struct controller *self)
{
    struct jp_ecu *ecu = &self->ecu;
    const bool alive = ecu->internal.operator_link.state == JP_OPERATOR_ALIVE;

    for (uint8_t i = ecu->internal.queue_tail; i != ecu->internal.queue_head; i = (uint8_t)((i + 1U) % JP_ECU_QUEUE)) {
        require(message_of(ecu->internal.queue[i].id)->kind == OPERATORS,
                "a frame in the queue that is not the operator's");
        oracle_take(&self->oracle, &ecu->internal.queue[i]);
    }
    oracle_pass(&self->oracle, ecu->tick - ecu->internal.worked_tick, ecu->internal.operator_link.timeout);
    jp_ecu_work(ecu);
    require(ecu->internal.queue_tail == ecu->internal.queue_head, "frames left in the queue");
    require(ecu->internal.operator_link.mode == self->oracle.mode, "another mode is obeyed than was commanded");
    seen.lost_operators += alive && ecu->internal.operator_link.state == JP_OPERATOR_LOST ? 1U : 0U;
    check_route(self);
    if (self->balancer.pilot.legs_learned_from + self->balancer.pilot.legs_left_out > self->segments) {
        seen.learned++;
        check_learned(self);
    }
    self->segments = self->balancer.pilot.legs_learned_from + self->balancer.pilot.legs_left_out;
}

static void execute(struct controller *self)
{
    struct jp_ecu *ecu = &self->ecu;

    if (one_in(10000)) {
        draw_rates(&self->traffic);
    }

    const struct jp_can_frame frame = next_frame(&self->traffic, &self->balancer.robot);
    const struct counters before = counters_of(ecu);
    const bool complete = jp_ecu_accept(ecu, &frame);

    check_accepted(&before, ecu, &frame);
    if (complete || one_in(self->traffic.weights[SAMPLES] == 0U ? 8 : 200)) {
        run_tick(self);
        if (one_in(self->work_one_in)) {
            run_work(self);
        }
    }
    if (one_in(100)) {
        run_work(self);
    }
    check_counters(&before, ecu);
    check_ranges(ecu);
    executions++;
}

/** What a start may find: any bits that pass for a state, too. */
static void begin_to_learn(struct controller *self)
{
    static struct jp_learned_state state;
    const struct jp_ecu_learning learning = {
        .learning = robot->learning,
        .of_battery = one_in(2),
        .stored = (enum jp_stored)below(JP_STORED_DAMAGED + 1U),
        .state = &state,
    };
    const char *field;

    jp_learned_state_start(&state, robot->learning->identity - one_in(4));
    for (unsigned i = 0; i < JP_LEARNING_DIRECTIONS; i++) {
        state.x[i] = (jp_q24)below(2U * (uint32_t)JP_LEARNED_MAX + 1U) - JP_LEARNED_MAX;
    }
    require(jp_ecu_balancer_learn(&self->balancer, &learning, &field) == JP_OK, "tables");
    check_learned(self);
}

/** A reset: what RAM held is gone but for the record, from which the robot may go on. */
static void begin_episode(struct controller *self)
{
    static const uint32_t bad_buses[] = {NEVER, NEVER, 1000, 50, 2};
    static const uint32_t works[] = {1, 1, 2, 10, 100};
    const struct jp_can_port port = {.context = self, .send = take_sent, .state = bus_state};
    const char *field;

    if (one_in(4)) {
        self->retained = (struct jp_retained){.slots = {{.sequence = 0}}};
    }
    self->oracle = (struct command_oracle){.stood = false};
    self->driven = (struct jp_route_message){.id = 0};
    self->view = (struct ecu_view){.heard = false};
    self->bad_bus_one_in = bad_buses[below(sizeof bad_buses / sizeof bad_buses[0])];
    self->work_one_in = works[below(sizeof works / sizeof works[0])];
    traffic_begin(&self->traffic);
    require(ecu_start(&self->ecu, &self->balancer, robot->config, robot->energy, &port, &self->retained, &field) ==
                JP_OK,
            "init");
    if (!one_in(4)) {
        begin_to_learn(self);
    }
    self->segments = 0;
    self->oracle.mode = self->balancer.robot.internal.resuming ? JP_MODE_STAND : JP_MODE_OFF;
}

#endif
