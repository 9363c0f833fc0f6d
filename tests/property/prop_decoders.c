/*
 * Everything that decodes CAN frames, under frames of every kind: sound traffic, the same with flipped bits, wrong
 * lengths, gaps and repetitions, frames that are right in all but their content, foreign ones, and garbage. The
 * controller of courier24 drives routes meanwhile, so that the frames meet it in every state; what the operator's
 * frames may make it do is told by command_oracle.h.
 *
 * prop_decoders [--count N] [--seed S] [--json FILE]
 * --count is the number of frames and SLCAN lines in all; 100000000 for the full check.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/app/ecu.h"
#include "hal/app/operator.h"
#include "hal/app/telemetry.h"
#include "hal/can/slcan.h"
#include "sim/balancer/rig.h"
#include "sim/balancer/robot_file.h"
#include "sim/bus/ecu_view.h"
#include "sim/bus/plant_node.h"
#include "tests/support/command_oracle.h"
#include "tests/support/options.h"
#include "unity.h"

#define ROBOT      "courier24"
#define ROBOT_FILE "sim/robots/courier24.cfg"

#define EXECUTIONS_BAR 1e8

/** Frames from which on the short run has seen everything. */
#define COVERING_COUNT 2000000UL

#define EPISODE_SHORTEST 512U
#define EPISODE_DOUBLES  10U

static uint64_t seed = 1;
static uint64_t random_state;
static unsigned long count = 2000000;
static unsigned long executions;
static const struct robot_entry *robot;

/** For one_in(). */
#define NEVER 0U

static uint64_t random_bits(void)
{
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    return random_state * UINT64_C(0x2545F4914F6CDD1D);
}

static uint32_t below(uint32_t bound)
{
    return (uint32_t)(((random_bits() >> 32) * bound) >> 32);
}

static bool one_in(uint32_t times)
{
    return times != NEVER && below(times) == 0U;
}

static int32_t around(int32_t limit)
{
    return (int32_t)below(2U * (uint32_t)limit + 1U) - limit;
}

static void require(bool condition, const char *what)
{
    if (!condition) {
        printf("execution %lu of seed %llu\n", executions, (unsigned long long)seed);
        TEST_FAIL_MESSAGE(what);
    }
}

void setUp(void)
{
    random_state = seed;
    robot = rig_find_robot(ROBOT);
    TEST_ASSERT_NOT_NULL(robot);
}

void tearDown(void)
{
}

/* ---- Frames ---- */

/** The data frames of joulepath.dbc but for those of the lockstep. */
static const struct message {
    uint32_t id;
    uint8_t length;
    enum { TO_ECU, OPERATORS, FROM_ECU, OTHERS } kind;
    uint8_t data_id; /**< 0: not protected by itself */
} messages[] = {
    {0x010, 8, FROM_ECU, JP_DATA_ID_MOTOR_COMMAND},
    {0x020, 8, TO_ECU, 0},
    {0x021, 8, TO_ECU, 0},
    {0x022, 8, TO_ECU, 0},
    {0x100, 4, OPERATORS, JP_DATA_ID_OPERATOR_COMMAND},
    {0x101, 8, OPERATORS, JP_DATA_ID_ROUTE_OFFER},
    {0x102, 8, OPERATORS, JP_DATA_ID_WAYPOINT},
    {0x103, 8, OPERATORS, JP_DATA_ID_GOAL},
    {0x180, 8, FROM_ECU, 0},
    {0x181, 8, FROM_ECU, 0},
    {0x182, 8, FROM_ECU, 0},
    {0x183, 8, FROM_ECU, 0},
    {0x184, 8, FROM_ECU, 0},
    {0x185, 8, FROM_ECU, 0},
    {0x186, 8, FROM_ECU, 0},
    {0x187, 8, FROM_ECU, 0},
    {0x188, 8, FROM_ECU, 0},
    {0x189, 8, FROM_ECU, 0},
    {0x18A, 8, FROM_ECU, 0},
    {0x18B, 8, FROM_ECU, 0},
    {0x18C, 8, FROM_ECU, 0},
    {0x18D, 8, FROM_ECU, 0},
    {0x18E, 8, FROM_ECU, 0},
    {0x18F, 8, FROM_ECU, 0},
    {0x190, 8, OTHERS, 0},
    {0x191, 8, FROM_ECU, 0},
    {0x192, 8, FROM_ECU, 0},
    {0x193, 8, FROM_ECU, 0},
};
#define MESSAGES (sizeof messages / sizeof messages[0])

static const struct message *message_of(uint32_t id)
{
    for (size_t i = 0; i < MESSAGES; i++) {
        if (messages[i].id == id) {
            return &messages[i];
        }
    }
    return NULL;
}

static void randomise_data(struct jp_can_frame *frame)
{
    const uint64_t bits = random_bits();

    memcpy(frame->data, &bits, sizeof frame->data);
}

static uint8_t random_length(void)
{
    return (uint8_t)(one_in(4) ? below(256) : below(JP_CAN_LENGTH_MAX + 1U));
}

static struct jp_can_frame foreign_frame(void)
{
    struct jp_can_frame frame = {.id = messages[below(MESSAGES)].id, .length = JP_CAN_LENGTH_MAX};

    switch (below(4)) {
    case 0:
        frame.id = below(0x800);
        break;
    case 1:
        frame.id = (uint32_t)random_bits();
        break;
    case 2:
        frame.id |= below(4) << 30;
        break;
    default:
        break;
    }
    if (one_in(2)) {
        frame.length = random_length();
    }
    randomise_data(&frame);
    return frame;
}

static void flip_bits(struct jp_can_frame *frame)
{
    for (uint32_t left = 1U + below(4); left > 0U; left--) {
        const uint32_t bit = below(8U * JP_CAN_LENGTH_MAX);

        frame->data[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
    }
}

/** Another content under the right CRC, and mostly the right counter. */
static void forge(struct jp_can_frame *frame)
{
    const struct message *message = message_of(frame->id);
    uint8_t counter = (uint8_t)(frame->data[1] - 1U);

    if (message == NULL || message->data_id == 0U) {
        return;
    }
    if (one_in(2)) {
        frame->data[1U + below(7)] = (uint8_t)below(256);
    } else {
        randomise_data(frame);
    }
    counter = one_in(8) ? (uint8_t)below(16) : counter;
    jp_e2e_protect(&counter, message->data_id, frame->data, message->length);
}

static void spoil(struct jp_can_frame *frame)
{
    switch (below(5)) {
    case 0:
        forge(frame);
        break;
    case 1:
        frame->length = random_length();
        break;
    case 2:
        frame->id ^= one_in(2) ? 1U << below(11) : 1U << below(32);
        break;
    default:
        flip_bits(frame);
        break;
    }
}

/* ---- Sound traffic for the controller: a robot that does as it should, and an operator ---- */

enum source { SAMPLES, COMMANDS, ROUTES, GOALS, FOREIGN, SOURCES };

struct traffic {
    uint32_t weights[SOURCES];
    uint32_t spoilt_one_in;
    uint32_t repeated_one_in;
    uint32_t lost_one_in;
    struct jp_can_frame last;

    uint8_t sample_counter;
    unsigned part;
    struct jp_can_frame sample[JP_SAMPLE_PARTS];
    double left;  /**< counts */
    double right; /**< counts */
    uint32_t first_count;

    uint8_t command_counter;
    enum jp_operator_mode mode;
    uint8_t route_id;

    uint8_t offer_counter;
    uint8_t waypoint_counter;
    struct jp_route_message route;
    unsigned sent; /**< frames of the route */

    uint8_t goal_counter;
};

/** What is changed now and then in an episode. */
static uint32_t drawn_rarity(void)
{
    static const uint32_t rarities[] = {NEVER, NEVER, 10000, 1000, 1000, 100, 4};

    return rarities[below(sizeof rarities / sizeof rarities[0])];
}

/** How much of what is on the bus, and how it is spoilt. */
static void draw_rates(struct traffic *traffic)
{
    static const uint32_t usual[SOURCES] = {[SAMPLES] = 8, [COMMANDS] = 2, [ROUTES] = 2};

    for (unsigned i = 0; i < SOURCES; i++) {
        traffic->weights[i] = one_in(8) ? 4U * below(4) : usual[i];
    }
    traffic->weights[FOREIGN] += one_in(4) || traffic->weights[SAMPLES] == 0U ? 1U : 0U;
    traffic->spoilt_one_in = drawn_rarity();
    traffic->repeated_one_in = drawn_rarity();
    traffic->lost_one_in = drawn_rarity();
}

static void traffic_begin(struct traffic *traffic)
{
    *traffic = (struct traffic){.first_count = (uint32_t)random_bits(), .mode = JP_MODE_STAND};
    draw_rates(traffic);
}

/** A way in turns a second, on the reference and back to it. */
static double wanted_rate(jp_q24 rate, jp_phase wanted, jp_phase measured)
{
    return fmin(fmax(rate * 0x1p-24 + 5 * (jp_phase_difference(wanted, measured) * 0x1p-24), -3), 3);
}

static jp_q16 motor_current(const struct jp_monitor_config *motor, jp_q16 voltage, double rate)
{
    const double amperes = (voltage * 0x1p-16 - rate * motor->back_emf * 0x1p-16) / (motor->motor_resistance * 0x1p-16);

    return (jp_q16)(fmin(fmax(amperes, -7), 7) * 0x1p16);
}

static void move_and_measure(struct traffic *traffic, const struct jp_ecu *ecu, struct jp_sensors *sensors)
{
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&ecu->robot);
    const struct jp_reference *reference = jp_robot_reference(&ecu->robot);
    const struct jp_robot_config *config = jp_robot_configuration(&ecu->robot);
    const double second = 1.0 / config->estimator.tick_rate;
    double wheel = 0;
    double yaw = 0;

    if (telemetry->state == JP_ROBOT_BALANCING || telemetry->state == JP_ROBOT_DRIVING) {
        wheel = wanted_rate(reference->wheel.rate, reference->wheel.angle, telemetry->motion.wheel);
        yaw = wanted_rate(reference->yaw.rate, reference->yaw.angle, telemetry->motion.yaw);
    }

    const double sum = wheel * second * 0x1p56 / (double)config->estimator.wheel_per_count;
    const double difference = yaw * second * 0x1p56 / (double)config->estimator.yaw_per_count;
    const double turning = yaw * config->monitor.half_track * 0x1p-16;

    traffic->left += (sum - difference) / 2;
    traffic->right += (sum + difference) / 2;
    *sensors = (struct jp_sensors){
        .encoder_left = traffic->first_count + (uint32_t)(int64_t)traffic->left,
        .encoder_right = traffic->first_count + (uint32_t)(int64_t)traffic->right,
        .pitch_rate = around(JP_Q24(0.002)),
        .yaw_rate = around(JP_Q24(0.002)),
        .accel_x = around(JP_Q24(0.01)),
        .accel_z = JP_Q24_ONE + around(JP_Q24(0.01)),
        .current_left = motor_current(&config->monitor, telemetry->voltages.left, wheel - turning),
        .current_right = motor_current(&config->monitor, telemetry->voltages.right, wheel + turning),
        .bus_voltage = JP_Q16(24),
    };
}

/** One of the numbers becomes any number. */
static void spoil_sensors(struct jp_sensors *sensors)
{
    uint8_t *bytes = (uint8_t *)sensors;
    const uint32_t any = (uint32_t)random_bits();

    memcpy(bytes + sizeof any * below(sizeof *sensors / sizeof any), &any, sizeof any);
}

static struct jp_can_frame next_sample_part(struct traffic *traffic, const struct jp_ecu *ecu)
{
    struct jp_sensors sensors;

    if (traffic->part == 0U) {
        move_and_measure(traffic, ecu, &sensors);
        if (one_in(traffic->spoilt_one_in)) {
            spoil_sensors(&sensors);
        }
        jp_message_from_sensors(traffic->sample, &traffic->sample_counter, &sensors);
    }

    const struct jp_can_frame frame = traffic->sample[traffic->part];

    traffic->part = (traffic->part + 1U) % JP_SAMPLE_PARTS;
    return frame;
}

static struct jp_can_frame next_command(struct traffic *traffic, const struct jp_ecu *ecu)
{
    struct jp_can_frame frame = {.id = 0x100, .length = 4};

    if (one_in(jp_robot_state_now(&ecu->robot) == JP_ROBOT_DRIVING ? 5000 : 20)) {
        traffic->mode = one_in(2) ? JP_MODE_DRIVE : (enum jp_operator_mode)below(4);
    }
    if (one_in(1000)) {
        traffic->route_id = one_in(4) ? (uint8_t)below(256) : one_in(4) ? JP_ROUTE_GOAL : traffic->route.id;
    }
    frame.data[1] = (uint8_t)((unsigned)traffic->mode << 4);
    frame.data[2] = traffic->route_id;
    jp_e2e_protect(&traffic->command_counter, JP_DATA_ID_OPERATOR_COMMAND, frame.data, frame.length);
    return frame;
}

static void put_point(struct jp_can_frame *frame, const struct jp_point *point)
{
    const uint64_t x = (uint32_t)point->x & 0x3FFFFFFU;
    const uint64_t y = (uint32_t)point->y & 0x3FFFFFFU;
    const uint64_t bits = x << 12 | y << 38;

    memcpy(frame->data, &bits, sizeof frame->data);
}

static struct jp_point random_point(const struct jp_ecu *ecu)
{
    const struct jp_point here = jp_robot_position(&ecu->robot);
    const int32_t near = one_in(8) ? JP_Q16(500) : JP_Q16(0.2);

    return (struct jp_point){jp_clamp32(here.x + around(near), -JP_Q16(512), JP_Q16(511)),
                             jp_clamp32(here.y + around(near), -JP_Q16(512), JP_Q16(511))};
}

static void draw_route(struct traffic *traffic, const struct jp_ecu *ecu)
{
    static const uint8_t lengths[] = {0, 1, 2, 3, 4, JP_ROUTE_LENGTH_MAX, JP_ROUTE_LENGTH_MAX + 1, UINT8_MAX};

    traffic->route.id = (uint8_t)below(256);
    traffic->route.length = one_in(4) ? lengths[below(sizeof lengths)] : (uint8_t)(1U + below(8));
    for (unsigned i = 0; i < JP_ROUTE_LENGTH_MAX; i++) {
        traffic->route.points[i] = random_point(ecu);
    }
}

static struct jp_can_frame next_offer(struct traffic *traffic, const struct jp_ecu *ecu)
{
    struct jp_can_frame frame = {.id = 0x101, .length = 8};
    uint32_t crc;

    draw_route(traffic, ecu);
    crc = traffic->route.length > JP_ROUTE_LENGTH_MAX || one_in(16) ? (uint32_t)random_bits()
                                                                    : oracle_crc32(&traffic->route);
    frame.data[2] = traffic->route.id;
    frame.data[3] = traffic->route.length;
    memcpy(&frame.data[4], &crc, sizeof crc);
    jp_e2e_protect(&traffic->offer_counter, JP_DATA_ID_ROUTE_OFFER, frame.data, frame.length);
    return frame;
}

static struct jp_can_frame next_route_frame(struct traffic *traffic, const struct jp_ecu *ecu)
{
    struct jp_can_frame frame = {.id = 0x102, .length = 8};

    if (traffic->sent == 0U) {
        traffic->sent = 1;
        return next_offer(traffic, ecu);
    }
    if (traffic->sent > JP_ROUTE_LENGTH_MAX || traffic->sent > traffic->route.length) {
        traffic->sent = one_in(2000) ? 0 : traffic->sent;
        return next_sample_part(traffic, ecu);
    }
    put_point(&frame, &traffic->route.points[traffic->sent - 1U]);
    jp_e2e_protect(&traffic->waypoint_counter, JP_DATA_ID_WAYPOINT, frame.data, frame.length);
    traffic->sent++;
    if (traffic->sent > traffic->route.length) {
        traffic->route_id = traffic->route.id;
    }
    return frame;
}

static struct jp_can_frame next_goal(struct traffic *traffic, const struct jp_ecu *ecu)
{
    struct jp_can_frame frame = {.id = 0x103, .length = 8};
    const struct jp_point goal = random_point(ecu);

    put_point(&frame, &goal);
    jp_e2e_protect(&traffic->goal_counter, JP_DATA_ID_GOAL, frame.data, frame.length);
    return frame;
}

static enum source draw_source(const struct traffic *traffic)
{
    uint32_t sum = 0;
    uint32_t place;
    unsigned source = 0;

    for (unsigned i = 0; i < SOURCES; i++) {
        sum += traffic->weights[i];
    }
    place = below(sum);
    while (place >= traffic->weights[source]) {
        place -= traffic->weights[source];
        source++;
    }
    return (enum source)source;
}

static struct jp_can_frame draw_frame(struct traffic *traffic, const struct jp_ecu *ecu)
{
    switch (draw_source(traffic)) {
    case SAMPLES:
        return next_sample_part(traffic, ecu);
    case COMMANDS:
        return next_command(traffic, ecu);
    case ROUTES:
        return next_route_frame(traffic, ecu);
    case GOALS:
        return next_goal(traffic, ecu);
    case FOREIGN:
    case SOURCES:
    default:
        return foreign_frame();
    }
}

static struct jp_can_frame next_frame(struct traffic *traffic, const struct jp_ecu *ecu)
{
    struct jp_can_frame frame;

    if (one_in(traffic->repeated_one_in)) {
        return traffic->last;
    }
    do {
        frame = draw_frame(traffic, ecu);
    } while (one_in(traffic->lost_one_in));
    if (one_in(traffic->spoilt_one_in)) {
        spoil(&frame);
    }
    traffic->last = frame;
    return frame;
}

/* ---- The controller ---- */

struct controller {
    struct jp_ecu ecu;
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

static bool is_running(const struct jp_ecu *ecu)
{
    return jp_robot_state_now(&ecu->robot) == JP_ROBOT_BALANCING || jp_robot_state_now(&ecu->robot) == JP_ROBOT_DRIVING;
}

static void check_motor_command(const struct controller *self, const struct jp_can_frame *frame)
{
    const uint64_t duties = oracle_bits(frame, 14, 50);
    const bool enabled = oracle_bits(frame, 12, 1) != 0U;

    require(frame->data[0] == oracle_crc8(frame->data, 8, JP_DATA_ID_MOTOR_COMMAND), "CRC of MotorCommand");
    require(enabled == is_running(&self->ecu), "the motors run in balancing and driving, and in no other state");
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
    require(jp_robot_state_now(&ecu->robot) <= JP_ROBOT_FAULT, "state of the robot");
    require(operator_link->state <= JP_OPERATOR_LOST && operator_link->mode <= JP_MODE_DRIVE &&
                operator_link->heard <= JP_MODE_DRIVE && operator_link->confirmations <= JP_OPERATOR_CONFIRMATIONS,
            "state of the operator");
    require(routes->state <= JP_ROUTE_STOPPED && routes->reason <= JP_REASON_SWITCHED_OFF, "state of the route");
    require(routes->received <= JP_ROUTE_LENGTH_MAX && routes->driven.length <= JP_ROUTE_LENGTH_MAX,
            "length of a route");
    require(samples->parts < (1U << JP_SAMPLE_PARTS) && samples->newest < JP_SAMPLE_PACES &&
                samples->missed <= JP_SAMPLE_HOLD_TICKS && samples->catch_up <= JP_SAMPLE_HOLD_TICKS,
            "state of the samples");
    require(ecu->internal.plan.frames_left <= 3U, "frames of a plan");
    require(ecu->internal.learned.frames_left <= (ecu->learns ? 2U : 0U), "frames of what was learned");
}

/** Whatever came, it can be stored, and the robot can plan with it. */
static void check_learned(const struct jp_ecu *ecu)
{
    const struct jp_learned_state *state = jp_ecu_learned_state(ecu);
    const char *field;

    require(state == NULL || jp_learned_state_check(state, &field) == JP_OK, "what was learned is out of range");
    require(jp_energy_model_check(jp_robot_model(&ecu->robot), &field) == JP_OK,
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
    require(view->status.state <= JP_ROBOT_FAULT && view->status.mode <= JP_MODE_DRIVE &&
                view->status.operator_state <= JP_OPERATOR_LOST && view->route.state <= JP_ROUTE_STOPPED &&
                view->route.reason <= JP_REASON_SWITCHED_OFF,
            "an EcuStatus or RouteStatus out of range");
    require(view->learner.evidence < JP_EVIDENCES && view->learner.stored <= JP_STORED_DAMAGED,
            "a LearnerStatus out of range");
}

static void run_tick(struct controller *self)
{
    struct jp_ecu *ecu = &self->ecu;
    const bool ran = is_running(ecu);
    const bool drove = jp_robot_state_now(&ecu->robot) == JP_ROBOT_DRIVING;
    const bool resuming = ecu->robot.internal.resuming;
    const uint16_t ended = jp_robot_last_tick(&ecu->robot)->segments_ended;

    self->sent = 0;
    jp_ecu_tick(ecu);
    seen.ticks++;
    require(self->sent <= 1U + JP_TELEMETRY_FRAMES_MAX, "frames in a tick");
    if (is_running(ecu)) {
        const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&ecu->robot);
        const jp_q16 most = ecu->robot.internal.monitor.good.bus_voltage;

        require(telemetry->voltages.left <= most && telemetry->voltages.left >= -most &&
                    telemetry->voltages.right <= most && telemetry->voltages.right >= -most,
                "a duty beyond 1");
        require(ran || resuming || self->oracle.stood, "motors on without a Stand");
        require(drove || telemetry->state != JP_ROBOT_DRIVING || self->oracle.mode == JP_MODE_DRIVE,
                "a robot that drives off without a Drive");
        seen.enabled += ran || resuming ? 0U : 1U;
        seen.resumed += resuming && !ran ? 1U : 0U;
        seen.segments += jp_robot_last_tick(&ecu->robot)->segments_ended > ended ? 1U : 0U;
    }
    seen.stopped += ran && jp_robot_state_now(&ecu->robot) >= JP_ROBOT_FALLEN ? 1U : 0U;
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
    const struct jp_robot *driver = &self->ecu.robot;
    const struct jp_route_message *driven = &self->ecu.internal.routes.driven;

    require(driver->internal.route_planned >= driver->internal.route_length ||
                (driver->internal.route == driven->points && driver->internal.route_length == driven->length),
            "the robot's route is not that of the commands");
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
    if (ecu->watch.learned_from + ecu->watch.left_out > self->segments) {
        seen.learned++;
        check_learned(ecu);
    }
    self->segments = ecu->watch.learned_from + ecu->watch.left_out;
}

static void execute(struct controller *self)
{
    struct jp_ecu *ecu = &self->ecu;

    if (one_in(10000)) {
        draw_rates(&self->traffic);
    }

    const struct jp_can_frame frame = next_frame(&self->traffic, ecu);
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
        .horizon = one_in(4) ? NULL : robot->horizon,
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
    require(jp_ecu_learn(&self->ecu, &learning, &field) == JP_OK, "tables");
    check_learned(&self->ecu);
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
    require(jp_ecu_init(&self->ecu, robot->config, robot->energy, &port, &self->retained, &field) == JP_OK, "init");
    if (!one_in(4)) {
        begin_to_learn(self);
    }
    self->segments = 0;
    self->oracle.mode = self->ecu.robot.internal.resuming ? JP_MODE_STAND : JP_MODE_OFF;
}

static void print_seen(void)
{
    printf("controller: %lu ticks, %lu times enabled, %lu times resumed, %lu routes begun, %lu segments ended,\n"
           "            %lu falls and faults, %lu operators lost, %lu frames for a full queue, %lu segments judged\n",
           seen.ticks, seen.enabled, seen.resumed, seen.routes, seen.segments, seen.stopped, seen.lost_operators,
           seen.full_queues, seen.learned);
}

static void test_controller(void)
{
    const unsigned long end = executions + count / 10U * 5U;

    while (executions < end) {
        begin_episode(&controller);
        for (uint32_t left = EPISODE_SHORTEST << below(EPISODE_DOUBLES); left > 0U && executions < end; left--) {
            execute(&controller);
        }
    }
    print_seen();
    TEST_ASSERT_TRUE(count < COVERING_COUNT ||
                     (seen.enabled > 0U && seen.resumed > 0U && seen.routes > 0U && seen.segments > 0U &&
                      seen.stopped > 0U && seen.lost_operators > 0U && seen.full_queues > 0U && seen.learned > 0U));
}

/* ---- The retained record ---- */

#define RECORD_TICKS 50U
#define RECORD_SHARE 250U /* executions a record */

/** As retained.c does it. */
static uint32_t record_check(const struct jp_retained_slot *slot)
{
    uint32_t check = 0x4A503134U;

    for (size_t offset = 0; offset < offsetof(struct jp_retained_slot, check); offset += sizeof check) {
        uint32_t word;

        memcpy(&word, (const uint8_t *)slot + offset, sizeof word);
        check = (check << 1 | check >> 31) + word;
    }
    return check;
}

static void randomise(void *memory, size_t size)
{
    uint8_t *bytes = memory;

    for (size_t i = 0; i < size; i++) {
        bytes[i] = (uint8_t)below(256);
    }
}

/** A record of this robot in any state. */
static void draw_sound_record(struct jp_retained_slot *slot)
{
    const struct jp_robot_config *config = robot->config;
    const uint32_t rate = config->estimator.tick_rate;
    const uint8_t balancing = (uint8_t)below(2);

    randomise(slot, sizeof *slot);
    slot->snapshot.estimator.phase_per_rate = jp_phase_per_rate(rate);
    slot->snapshot.estimator.gyro_bias >>= 20;
    slot->snapshot.odometry.metres_per_turn = config->metres_per_turn;
    slot->snapshot.odometry.x >>= 16;
    slot->snapshot.odometry.y >>= 16;
    memcpy(&slot->snapshot.balancing, &balancing, sizeof balancing);
}

/** Memory whose check is right: of this robot, or but for eight bytes, or just any. */
static void draw_record(struct jp_retained_slot *slot)
{
    const int64_t values[] = {INT64_MAX, INT64_MIN, (int64_t)random_bits()};
    uint8_t *bytes = (uint8_t *)slot;

    draw_sound_record(slot);
    if (one_in(4)) {
        randomise(slot, sizeof *slot);
    } else if (one_in(2)) {
        memcpy(bytes + sizeof values[0] * below(sizeof slot->snapshot / sizeof values[0]), &values[below(3)],
               sizeof values[0]);
    }
    slot->check = record_check(slot);
}

static void test_retained_record(void)
{
    struct controller *self = &controller;
    const struct jp_can_port port = {.context = self, .send = take_sent, .state = bus_state};
    unsigned long resumed = 0;

    for (unsigned long i = 0; i < count / RECORD_SHARE; i++) {
        struct jp_ecu *ecu = &self->ecu;
        const char *field;

        begin_episode(self);
        draw_record(&self->retained.slots[0]);
        draw_record(&self->retained.slots[1]);
        if (one_in(2)) {
            randomise(&self->retained.slots[below(2)].check, sizeof(uint32_t));
        }

        const struct jp_retained_slot *record = jp_retained_newest(&self->retained);

        TEST_ASSERT_TRUE(record == &self->retained.slots[0] || record == &self->retained.slots[1]);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_ecu_init(ecu, robot->config, robot->energy, &port, &self->retained, &field));
        TEST_ASSERT_EQUAL_UINT32(record->resets + 1U, ecu->resets);
        resumed += ecu->robot.internal.resuming ? 1U : 0U;
        self->oracle.mode = ecu->robot.internal.resuming ? JP_MODE_STAND : JP_MODE_OFF;
        for (unsigned tick = 0; tick < RECORD_TICKS; tick++) {
            for (unsigned part = 0; part < JP_SAMPLE_PARTS; part++) {
                const struct jp_can_frame frame = next_sample_part(&self->traffic, ecu);

                (void)jp_ecu_accept(ecu, &frame);
            }
            run_tick(self);
            run_work(self);
            check_ranges(ecu);
        }
    }
    printf("records: %lu of %lu taken up\n", resumed, count / RECORD_SHARE);
    TEST_ASSERT_TRUE(count < COVERING_COUNT || (resumed > 0U && resumed < count / RECORD_SHARE));
}

/* ---- SLCAN ---- */

#define SLCAN_ROOM 48U

static struct jp_slcan_adapter adapter;

/** A line of a frame, or a command, or garbage; mostly with a few bytes changed. Returns its length with the CR. */
static size_t draw_line(char line[SLCAN_ROOM])
{
    static const char likely[] = "0123456789ABCDEFabcdeftTrROCSVNzZ8\a\r\n";
    static const char *const commands[] = {"O\r", "C\r", "S8\r", "S6\r", "V\r", "N\r", "z\r", "Z\r", "\r", "\a"};
    const struct jp_can_frame frame = foreign_frame();
    size_t length = jp_slcan_encode(line, &frame);

    if (length == 0U && one_in(2)) {
        const char *command = commands[below(sizeof commands / sizeof commands[0])];

        length = strlen(command);
        memcpy(line, command, length);
    } else if (length == 0U) {
        length = 1U + below(SLCAN_ROOM - 1U);
        randomise(line, length - 1U);
        line[length - 1U] = '\r';
    }
    for (uint32_t left = one_in(2) ? below(4) : 0; left > 0U; left--) {
        line[below((uint32_t)length)] = one_in(4) ? (char)below(256) : likely[below(sizeof likely - 1U)];
    }
    return length;
}

/** What has been decoded can be encoded, to a line that says the same. */
static void check_slcan_frame(const struct jp_can_frame *frame)
{
    struct jp_slcan_decoder again = {.length = 0};
    char line[JP_SLCAN_LINE_MAX];
    const unsigned length = jp_slcan_encode(line, frame);
    enum jp_slcan_item item = JP_SLCAN_NONE;

    require(length > 0U, "a decoded frame that is none");
    for (unsigned i = 0; i < length; i++) {
        item = jp_slcan_decode(&again, (uint8_t)line[i]);
    }
    require(item == JP_SLCAN_FRAME && again.frame.id == frame->id && again.frame.length == frame->length &&
                memcmp(again.frame.data, frame->data, sizeof frame->data) == 0,
            "a decoded frame that encodes to another");
}

static bool is_answer(const char *answer)
{
    const size_t length = strlen(answer);

    return length == 0U || (length <= JP_SLCAN_ANSWER_MAX && strchr("\r\a", answer[length - 1U]) != NULL);
}

static void test_slcan(void)
{
    const unsigned long end = executions + count / 10U * 2U;
    unsigned long frames = 0;
    unsigned long malformed = 0;

    adapter = (struct jp_slcan_adapter){.open = false};
    for (; executions < end; executions++) {
        char line[SLCAN_ROOM];
        const size_t length = draw_line(line);

        for (size_t i = 0; i < length; i++) {
            const struct jp_slcan_decoder *decoder = &adapter.decoder;
            const uint16_t malformed_before = decoder->malformed;
            const uint16_t overlong_before = decoder->overlong;
            const char *answer;
            const bool frame = jp_slcan_adapter_take(&adapter, (uint8_t)line[i], &answer);

            require(decoder->length <= JP_SLCAN_LINE_MAX, "length of the line");
            require(decoder->malformed >= malformed_before && decoder->overlong >= overlong_before &&
                        decoder->overlong <= decoder->malformed,
                    "a counter went back");
            require(is_answer(answer), "an answer that is none");
            if (frame) {
                require(adapter.open && decoder->length == 0U, "a frame through a closed channel");
                check_slcan_frame(&decoder->frame);
            }
            frames += frame ? 1U : 0U;
            malformed += decoder->malformed > malformed_before ? 1U : 0U;
        }
        if (one_in(10000)) {
            adapter = (struct jp_slcan_adapter){.open = one_in(2)};
        }
    }
    printf("SLCAN: %lu frames, %lu malformed lines\n", frames, malformed);
    TEST_ASSERT_TRUE(count < COVERING_COUNT || (frames > 0U && malformed > 0U));
}

/* ---- The plant ---- */

static struct plant_node plant;

static struct jp_can_frame draw_motor_command(uint8_t *counter)
{
    struct jp_can_frame frame;
    const struct jp_actuation actuation = {
        .duty_left = (jp_q31)random_bits(), .duty_right = (jp_q31)random_bits(), .enabled = (uint8_t)below(2)};

    if (one_in(8)) {
        return foreign_frame();
    }
    if (one_in(16)) {
        *counter = (uint8_t)(*counter + below(16));
    }
    jp_message_from_actuation(&frame, counter, &actuation);
    if (one_in(4)) {
        spoil(&frame);
    }
    return frame;
}

static bool is_duty(jp_q31 duty, const struct jp_can_frame *frame, unsigned first)
{
    const uint32_t raw = (uint32_t)oracle_bits(frame, first, 25);

    return duty == (int32_t)(raw << 7);
}

static void check_actuation(const struct jp_actuation *actuation, const struct jp_can_frame *frame)
{
    require(frame->id == 0x10 && frame->length == 8 && frame->data[0] == oracle_crc8(frame->data, 8, 0x4D),
            "a MotorCommand that is none");
    require(actuation->enabled == oracle_bits(frame, 12, 1), "bridges switched otherwise");
    require(actuation->enabled == 0U
                ? actuation->duty_left == 0 && actuation->duty_right == 0
                : is_duty(actuation->duty_left, frame, 14) && is_duty(actuation->duty_right, frame, 39),
            "other duties than commanded");
}

static void test_plant(void)
{
    static struct robot_file file;
    const unsigned long end = executions + count / 10U;
    uint8_t counter = 0;
    unsigned long obeyed = 0;

    TEST_ASSERT_TRUE(robot_file_load(ROBOT_FILE, &file));
    plant_node_init(&plant, &file, seed);
    for (; executions < end; executions++) {
        const struct jp_can_frame frame = draw_motor_command(&counter);
        const struct jp_actuation before = plant.actuation;
        const uint64_t errors = plant.crc_errors + plant.sequence_errors + plant.malformed;
        const bool valid = plant_node_accept(&plant, &frame);
        const uint64_t new_errors = plant.crc_errors + plant.sequence_errors + plant.malformed - errors;

        require(new_errors <= 1U && (!valid || new_errors == 0U), "errors of a frame");
        if (valid) {
            check_actuation(&plant.actuation, &frame);
            obeyed++;
        } else {
            require(memcmp(&plant.actuation, &before, sizeof before) == 0, "a refused command that was obeyed");
        }
    }
    printf("plant: %lu commands obeyed, %llu with a wrong CRC, %llu out of sequence, %llu malformed\n", obeyed,
           (unsigned long long)plant.crc_errors, (unsigned long long)plant.sequence_errors,
           (unsigned long long)plant.malformed);
    TEST_ASSERT_TRUE(count < COVERING_COUNT || (obeyed > 0U && plant.sequence_errors > 0U));
}

/* ---- The operator ---- */

static struct jp_operator commander;

static enum jp_status count_command(void *context, const struct jp_can_frame *frame)
{
    const struct message *message = message_of(frame->id);

    (void)context;
    require(message != NULL && message->kind == OPERATORS && frame->length == message->length &&
                frame->data[0] == oracle_crc8(frame->data, frame->length, message->data_id),
            "a command that is none");
    require(frame->id != 0x100 || oracle_bits(frame, 12, 2) != JP_MODE_DRIVE ||
                commander.phase == JP_OPERATOR_DRIVING || commander.phase == JP_OPERATOR_UPLOADING,
            "a Drive of an operator that has nothing to drive");
    return one_in(50) ? JP_ERR_BUSY : JP_OK;
}

/** Statuses that say something about the task as often as not; each comes twice or more, as only then it counts. */
static struct jp_can_frame draw_status(void)
{
    static struct jp_can_frame frame;

    if (one_in(3)) {
        frame = foreign_frame();
        if (!one_in(8)) {
            const bool is_route = one_in(2);

            frame.id = is_route ? JP_CAN_ROUTE_STATUS_FRAME_ID : JP_CAN_ECU_STATUS_FRAME_ID;
            frame.length = one_in(16) ? random_length() : 8;
            if (is_route && one_in(2)) {
                frame.data[0] = commander.task.id;
                frame.data[1] = (uint8_t)(JP_ROUTE_READY + below(3));
            }
            if (!is_route && !one_in(8)) {
                frame.data[0] = JP_CAN_ECU_STATUS_STATE_BALANCING_CHOICE | JP_MODE_STAND << 3 | JP_OPERATOR_ALIVE << 5;
            }
        }
    }
    return frame;
}

static void check_operator(void)
{
    require(commander.phase <= JP_OPERATOR_FAILED, "state of the operator");
    require((jp_operator_failure_text(commander.failure) != NULL) == (commander.phase == JP_OPERATOR_FAILED),
            "a failure has a reason");
    require(commander.attempts <= 5U, "attempts");
    require(commander.task.length <= JP_ROUTE_LENGTH_MAX &&
                (commander.phase != JP_OPERATOR_UPLOADING || commander.sent <= commander.task.length + 1U),
            "frames sent");
    require(commander.task.id != JP_ROUTE_GOAL || commander.phase != JP_OPERATOR_UPLOADING, "a route without a number");
}

static void test_operator(void)
{
    const unsigned long end = executions + count / 10U;
    const struct jp_can_port port = {.send = count_command};
    const unsigned states = JP_OPERATOR_FAILED + 1U;
    unsigned long in_state[JP_OPERATOR_FAILED + 1] = {0};
    uint32_t time_ms = (uint32_t)random_bits();

    commander = (struct jp_operator){.phase = JP_OPERATOR_IDLE};
    for (; executions < end; executions++) {
        const struct jp_can_frame frame = draw_status();

        jp_operator_accept(&commander, &frame);
        check_operator();
        if (one_in(500)) {
            struct jp_point points[JP_ROUTE_LENGTH_MAX];
            const size_t length = below(JP_ROUTE_LENGTH_MAX + 2U);

            randomise(points, sizeof points);
            for (size_t i = 0; i < JP_ROUTE_LENGTH_MAX && !one_in(100); i++) {
                points[i].x >>= 6;
                points[i].y >>= 6;
            }
            (void)jp_operator_route(&commander, points, length);
        } else if (one_in(5000)) {
            jp_operator_stop(&commander);
        }
        time_ms += below(12);
        jp_operator_tick(&commander, time_ms, &port);
        check_operator();
        in_state[commander.phase]++;
    }
    printf("operator: %lu idle, %lu standing up, %lu uploading, %lu driving, %lu done, %lu failed\n", in_state[0],
           in_state[1], in_state[2], in_state[3], in_state[4], in_state[5]);
    for (unsigned i = 0; i < states; i++) {
        TEST_ASSERT_TRUE(count < COVERING_COUNT || in_state[i] > 0U);
    }
}

/* ---- The view ---- */

static bool is_viewed(uint32_t id)
{
    return (id >= 0x180U && id <= 0x18DU) || id >= 0x192U;
}

static void test_view(void)
{
    const unsigned long end = executions + count / 10U;
    static struct ecu_view view;
    unsigned long taken = 0;

    for (; executions < end; executions++) {
        const struct jp_can_frame frame = foreign_frame();
        const struct message *message = message_of(frame.id);
        const bool telemetry = message != NULL && message->kind == FROM_ECU && is_viewed(message->id);
        const struct ecu_view before = view;

        ecu_view_accept(&view, &frame);
        if (!telemetry || frame.length != message->length) {
            require(memcmp(&view, &before, sizeof view) == 0, "a frame that is not for the view");
        }
        taken += telemetry && frame.length == message->length ? 1U : 0U;
        require(view.status.state <= 7U && view.status.mode <= 3U && view.pose.heading >= -2048 &&
                    view.pose.heading <= 2047,
                "a signal wider than it is");
    }
    printf("view: %lu frames taken\n", taken);
    TEST_ASSERT_TRUE(count < COVERING_COUNT || taken > 0U);
}

/* For tools/measure/figures.py. */
static void write_json(const char *path, unsigned long sound)
{
    FILE *file = fopen(path, "w");

    if (file == NULL) {
        perror(path);
        exit(1);
    }
    fprintf(file,
            "[\n{\"name\": \"CAN decoders: executions fuzzed without a finding\", \"value\": %lu, \"unit\": \"\", "
            "\"bound\": {\"op\": \">=\", \"value\": %.0f}, \"command\": \"make figures\"}\n]\n",
            sound, EXECUTIONS_BAR);
    if (fclose(file) != 0) {
        perror(path);
        exit(1);
    }
}

int main(int argc, char **argv)
{
    const struct options options = parse_options(argc, argv, (struct options){.count = count, .seed = 1});
    const char *json = options.json;

    count = options.count;
    seed = options.seed;
    printf("seed %llu\n", (unsigned long long)seed);
    UNITY_BEGIN();
    run_tests();
    int failures = UNITY_END();
    if (json != NULL) {
        write_json(json, failures == 0 ? executions : 0);
    }
    return failures;
}
