/*
 * Everything that decodes CAN frames, under frames of every kind: sound traffic, the same with flipped bits, wrong
 * lengths, gaps and repetitions, frames that are right in all but their content, foreign ones, and garbage. The
 * controller of courier24 drives routes meanwhile, so that the frames meet it in every state; what the operator's
 * frames may make it do is told by command_oracle.h.
 *
 * prop_decoders [--count N] [--seed S] [--json FILE]
 * --count is the number of frames and SLCAN lines in all; 100000000 for the full check.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/app/operator.h"
#include "hal/can/slcan.h"
#include "sim/balancer/robot_file.h"
#include "sim/bus/plant_node.h"
#include "tests/support/ecu_under_traffic.h"
#include "tests/support/options.h"
#include "unity.h"

#define ROBOT      "courier24"
#define ROBOT_FILE "sim/robots/courier24.cfg"

#define EXECUTIONS_BAR 1e8

/** Frames from which on the short run has seen everything. */
#define COVERING_COUNT 2000000UL

#define EPISODE_SHORTEST 512U
#define EPISODE_DOUBLES  10U

static struct options options = {.count = 2000000, .seed = 1};

void setUp(void)
{
    random_state = options.seed;
    robot = rig_find_robot(ROBOT);
    TEST_ASSERT_NOT_NULL(robot);
}

void tearDown(void)
{
}

/* ---- The controller ---- */

static void print_seen(void)
{
    printf("controller: %lu ticks, %lu times enabled, %lu times resumed, %lu routes begun, %lu segments ended,\n"
           "            %lu falls and faults, %lu operators lost, %lu frames for a full queue, %lu segments judged\n",
           seen.ticks, seen.enabled, seen.resumed, seen.routes, seen.segments, seen.stopped, seen.lost_operators,
           seen.full_queues, seen.learned);
}

static void test_controller(void)
{
    const unsigned long end = executions + options.count / 10U * 5U;

    while (executions < end) {
        begin_episode(&controller);
        for (uint32_t left = EPISODE_SHORTEST << below(EPISODE_DOUBLES); left > 0U && executions < end; left--) {
            execute(&controller);
        }
    }
    print_seen();
    TEST_ASSERT_TRUE(options.count < COVERING_COUNT ||
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
    slot->snapshot.balancer.estimator.phase_per_rate = jp_phase_per_rate(rate);
    slot->snapshot.balancer.estimator.gyro_bias >>= 20;
    slot->snapshot.balancer.odometry.metres_per_turn = config->metres_per_turn;
    slot->snapshot.balancer.odometry.x >>= 16;
    slot->snapshot.balancer.odometry.y >>= 16;
    memcpy(&slot->snapshot.balancer.balancing, &balancing, sizeof balancing);
    slot->kind = JP_RETAINED_BALANCER;
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

    for (unsigned long i = 0; i < options.count / RECORD_SHARE; i++) {
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
        TEST_ASSERT_EQUAL_INT(
            JP_OK, ecu_start(ecu, &self->balancer, robot->config, robot->energy, &port, &self->retained, &field));
        TEST_ASSERT_EQUAL_UINT32(record->resets + 1U, ecu->resets);
        resumed += self->balancer.robot.internal.resuming ? 1U : 0U;
        self->oracle.mode = self->balancer.robot.internal.resuming ? JP_MODE_STAND : JP_MODE_OFF;
        for (unsigned tick = 0; tick < RECORD_TICKS; tick++) {
            for (unsigned part = 0; part < JP_SAMPLE_PARTS; part++) {
                const struct jp_can_frame frame = next_sample_part(&self->traffic, &self->balancer.robot);

                (void)jp_ecu_accept(ecu, &frame);
            }
            run_tick(self);
            run_work(self);
            check_ranges(ecu);
        }
    }
    printf("records: %lu of %lu taken up\n", resumed, options.count / RECORD_SHARE);
    TEST_ASSERT_TRUE(options.count < COVERING_COUNT || (resumed > 0U && resumed < options.count / RECORD_SHARE));
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
    const unsigned long end = executions + options.count / 10U * 2U;
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
    TEST_ASSERT_TRUE(options.count < COVERING_COUNT || (frames > 0U && malformed > 0U));
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
    const unsigned long end = executions + options.count / 10U;
    uint8_t counter = 0;
    unsigned long obeyed = 0;

    TEST_ASSERT_TRUE(robot_file_load(ROBOT_FILE, &file));
    plant_node_init(&plant, &file, options.seed);
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
    TEST_ASSERT_TRUE(options.count < COVERING_COUNT || (obeyed > 0U && plant.sequence_errors > 0U));
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
    require(frame->id != 0x100 || oracle_bits(frame, 12, 3) != JP_MODE_DRIVE ||
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
                frame.data[0] = JP_CAN_ECU_STATUS_STATE_STANDING_CHOICE | JP_MODE_STAND << 3 | JP_OPERATOR_ALIVE << 5;
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
    const unsigned long end = executions + options.count / 10U;
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
        TEST_ASSERT_TRUE(options.count < COVERING_COUNT || in_state[i] > 0U);
    }
}

/* ---- The view ---- */

static bool is_viewed(uint32_t id)
{
    return (id >= 0x180U && id <= 0x18DU) || id >= 0x192U;
}

static void test_view(void)
{
    const unsigned long end = executions + options.count / 10U;
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
    TEST_ASSERT_TRUE(options.count < COVERING_COUNT || taken > 0U);
}

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", (double)executions, "", at_least(EXECUTIONS_BAR),
                "CAN decoders: executions fuzzed without a finding");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
