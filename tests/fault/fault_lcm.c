/* Wrong packets on LCM and wrong frames on CAN at the gateway between them: each is counted and named, none is acted
 * on; what is right arrives unchanged. On memq:// and a bus in memory. */
#include <jp_energy_t.h>
#include <jp_goal_t.h>
#include <jp_identification_t.h>
#include <jp_plan_t.h>
#include <jp_route_t.h>
#include <jp_state_t.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "sim/base/random.h"
#include "sim/bus/can_bus.h"
#include "sim/lcm/lcm_gateway.h"
#include "unity.h"

#define SEED        20180904u
#define JUNK        5000
#define PACKET_MAX  1024
#define ERRORS_MAX  4096
#define MS          1000u /* in µs */
#define COUNT_PLACE 16    /* of a jp_route_t, in bytes */
#define DATA_PLACE  20
#define HEADINGS    (2 * M_PI)

struct packet {
    uint8_t bytes[PACKET_MAX];
    size_t size;
};

static struct can_bus bus;
static struct jp_can_link robot;
static struct lcm_gateway gateway;
static lcm_t *lcm;
static uint64_t now_us;
static struct random noise;
static struct packet sound_route;
static struct packet sound_goal;

/* What came out. */
static unsigned states, plans, energies, identifications;
static jp_state_t state;
static jp_energy_t energy;
static jp_plan_t plan;
static jp_identification_t identification;

static void take_state(const lcm_recv_buf_t *packet, const char *channel, void *user)
{
    (void)channel;
    (void)user;
    free(state.task_reason);
    TEST_ASSERT_EQUAL_INT(packet->data_size, jp_state_t_decode(packet->data, 0, (int)packet->data_size, &state));
    states++;
}

static void take_energy(const lcm_recv_buf_t *packet, const char *channel, void *user)
{
    (void)channel;
    (void)user;
    TEST_ASSERT_EQUAL_INT(packet->data_size, jp_energy_t_decode(packet->data, 0, (int)packet->data_size, &energy));
    energies++;
}

static void take_plan(const lcm_recv_buf_t *packet, const char *channel, void *user)
{
    (void)channel;
    (void)user;
    free(plan.points);
    free(plan.segments);
    TEST_ASSERT_EQUAL_INT(packet->data_size, jp_plan_t_decode(packet->data, 0, (int)packet->data_size, &plan));
    plans++;
}

static void take_identification(const lcm_recv_buf_t *packet, const char *channel, void *user)
{
    (void)channel;
    (void)user;
    free(identification.residuals);
    TEST_ASSERT_EQUAL_INT(packet->data_size,
                          jp_identification_t_decode(packet->data, 0, (int)packet->data_size, &identification));
    identifications++;
}

static void forget_messages(void)
{
    free(state.task_reason);
    free(plan.points);
    free(plan.segments);
    free(identification.residuals);
    state = (jp_state_t){0};
    plan = (jp_plan_t){0};
    energy = (jp_energy_t){0};
    identification = (jp_identification_t){0};
    states = plans = energies = identifications = 0;
}

void setUp(void)
{
    struct jp_can_link link;

    can_bus_init(&bus);
    robot = can_bus_link(can_bus_attach(&bus));
    link = can_bus_link(can_bus_attach(&bus));
    lcm = lcm_create("memq://");
    TEST_ASSERT_NOT_NULL(lcm);
    TEST_ASSERT_TRUE(lcm_gateway_start(&gateway, &link, lcm));
    (void)lcm_subscribe(lcm, "JP_STATE", take_state, NULL);
    (void)lcm_subscribe(lcm, "JP_ENERGY", take_energy, NULL);
    (void)lcm_subscribe(lcm, "JP_PLAN", take_plan, NULL);
    (void)lcm_subscribe(lcm, "JP_IDENTIFICATION", take_identification, NULL);
    random_init(&noise, SEED);
    now_us = 5 * MS;
}

void tearDown(void)
{
    forget_messages();
    lcm_destroy(lcm);
}

/* Packets. */

static void make_packets(void)
{
    jp_point_t points[3] = {{10, 20}, {-511.5, 0.25}, {511.5, -0.0625}};
    const jp_route_t route = {.utime = 77, .count = 3, .points = points};
    const jp_goal_t goal = {.utime = 78, .point = {-3.5, 4.75}};

    sound_route.size = (size_t)jp_route_t_encode(sound_route.bytes, 0, PACKET_MAX, &route);
    sound_goal.size = (size_t)jp_goal_t_encode(sound_goal.bytes, 0, PACKET_MAX, &goal);
}

static struct packet route_of(int32_t count, double x, double y)
{
    static jp_point_t points[64];
    const jp_route_t route = {.count = count, .points = points};
    struct packet packet;

    for (int32_t i = 0; i < count; i++) {
        points[i] = (jp_point_t){x, y};
    }
    packet.size = (size_t)jp_route_t_encode(packet.bytes, 0, PACKET_MAX, &route);
    return packet;
}

static struct packet with_count(struct packet packet, uint32_t count)
{
    for (unsigned i = 0; i < 4; i++) {
        packet.bytes[COUNT_PLACE + i] = (uint8_t)(count >> (24 - 8 * i));
    }
    return packet;
}

/** Publishes it and lets the gateway take it. Whether the gateway set to work on a task. */
static bool is_taken(const char *channel, const struct packet *packet)
{
    const uint8_t *sent_already = &gateway.commander.command_counter;
    const uint8_t before = *sent_already;

    gateway.commander.phase = JP_OPERATOR_IDLE;
    gateway.commander.commanding = false;
    TEST_ASSERT_EQUAL_INT(0, lcm_publish(lcm, channel, packet->bytes, (unsigned)packet->size));
    now_us += MS;
    lcm_gateway_pass(&gateway, now_us);

    const bool taken = gateway.commander.phase != JP_OPERATOR_IDLE;

    /* A task makes itself heard on the bus at once, and nothing else does. */
    TEST_ASSERT_EQUAL_INT(taken, *sent_already != before);
    return taken;
}

/** Frames that nobody reads shall not fill the robot's queue. */
static void drain(void)
{
    struct jp_can_frame frame;

    while (robot.receive(robot.port.context, &frame)) {
    }
}

static void check_dropped(const char *channel, const struct packet *packet, enum lcm_task_result why)
{
    const uint64_t before = gateway.dropped[why];

    TEST_ASSERT_FALSE_MESSAGE(is_taken(channel, packet), lcm_task_text(why));
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(before + 1, gateway.dropped[why], lcm_task_text(why));
    drain();
}

static uint64_t all_dropped(void)
{
    uint64_t all = 0;

    for (int i = 0; i < LCM_TASK_RESULTS; i++) {
        all += gateway.dropped[i];
    }
    return all;
}

static void test_sound_packets_become_the_operators_task(void)
{
    TEST_ASSERT_TRUE(is_taken("JP_ROUTE", &sound_route));
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, gateway.commander.phase);
    TEST_ASSERT_EQUAL_UINT(3, gateway.commander.task.length);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(10), gateway.commander.task.points[0].x);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(-511.5), gateway.commander.task.points[1].x);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(-0.0625), gateway.commander.task.points[2].y);
    TEST_ASSERT_TRUE(is_taken("JP_GOAL", &sound_goal));
    TEST_ASSERT_EQUAL_UINT(1, gateway.commander.task.length);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(-3.5), gateway.commander.task.points[0].x);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(4.75), gateway.commander.task.points[0].y);
    TEST_ASSERT_EQUAL_UINT64(0, all_dropped());
}

static void check_truncations(const char *channel, const struct packet *sound)
{
    struct packet packet = *sound;

    for (packet.size = 0; packet.size < sound->size; packet.size++) {
        check_dropped(channel, &packet, packet.size < 8 ? LCM_TASK_TYPE : LCM_TASK_LENGTH);
    }
    for (packet.size = sound->size + 1; packet.size <= sound->size + 40; packet.size++) {
        check_dropped(channel, &packet, LCM_TASK_LENGTH);
    }
}

static void test_every_truncation_and_extension_is_dropped(void)
{
    check_truncations("JP_ROUTE", &sound_route);
    check_truncations("JP_GOAL", &sound_goal);
}

static double double_at(const uint8_t *bytes)
{
    uint64_t bits = 0;
    double value;

    for (int i = 0; i < 8; i++) {
        bits = bits << 8 | bytes[i];
    }
    memcpy(&value, &bits, sizeof value);
    return value;
}

static bool is_place(double metres)
{
    return isfinite(metres) && metres >= -512 - 0.49 / 65536 && metres < 512 - 0.5 / 65536;
}

/** LCM has no checksum: a coordinate that flips into another sound one cannot be told from it. */
static bool is_sound(const struct packet *packet, size_t data_place)
{
    for (size_t i = data_place; i < packet->size; i += 8) {
        if (!is_place(double_at(packet->bytes + i))) {
            return false;
        }
    }
    return true;
}

static void check_flips(const char *channel, const struct packet *sound, size_t data_place)
{
    for (size_t bit = 0; bit < 8 * sound->size; bit++) {
        struct packet packet = *sound;
        const size_t place = bit / 8;
        const bool in_time = place >= 8 && place < COUNT_PLACE;

        packet.bytes[place] ^= (uint8_t)(1u << bit % 8);

        const bool expected = in_time || (place >= data_place && is_sound(&packet, data_place));
        const uint64_t before = all_dropped();

        TEST_ASSERT_EQUAL_INT(expected, is_taken(channel, &packet));
        TEST_ASSERT_EQUAL_UINT64(before + !expected, all_dropped());
        drain();
    }
}

static void test_every_flipped_bit_is_dropped_or_leaves_a_sound_packet(void)
{
    check_flips("JP_ROUTE", &sound_route, DATA_PLACE);
    check_flips("JP_GOAL", &sound_goal, COUNT_PLACE);
}

static void test_counts_that_are_not_those_of_a_route(void)
{
    static const uint32_t wrong[] = {0,          33,         34,         255,        256,        0x7fffffff,
                                     0x80000000, 0xffffffff, 0xfffffffd, 0x10000003, 0x08000000, 0x40000000};
    const struct packet none = route_of(0, 0, 0);
    const struct packet many = route_of(33, 1, 1);
    const struct packet most = route_of(32, 1, 1);
    struct packet packet;

    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        packet = with_count(sound_route, wrong[i]);
        check_dropped("JP_ROUTE", &packet, LCM_TASK_COUNT);
    }
    for (uint32_t count = 1; count <= 32; count++) {
        packet = with_count(sound_route, count);
        if (count != 3) {
            check_dropped("JP_ROUTE", &packet, LCM_TASK_LENGTH);
        }
    }
    check_dropped("JP_ROUTE", &none, LCM_TASK_COUNT);
    check_dropped("JP_ROUTE", &many, LCM_TASK_COUNT);
    TEST_ASSERT_TRUE(is_taken("JP_ROUTE", &most));
    TEST_ASSERT_EQUAL_UINT(32, gateway.commander.task.length);
}

static void test_coordinates_at_and_beyond_their_limits(void)
{
    static const double sound[] = {0, -0.0, 5e-324, -512, 511.9999, 512 - 1 / 65536.0};
    static const double far[] = {512, -512.0001, 512 - 0.4 / 65536, 1e6, -1e300, 32768, 65536, 1.7e308};
    static const double odd[] = {NAN, -NAN, INFINITY, -INFINITY};
    struct packet packet;

    for (size_t i = 0; i < sizeof sound / sizeof sound[0]; i++) {
        packet = route_of(2, 1, sound[i]);
        TEST_ASSERT_TRUE(is_taken("JP_ROUTE", &packet));
        TEST_ASSERT_EQUAL_INT32((int32_t)rint(sound[i] * 65536), gateway.commander.task.points[1].y);
        drain();
    }
    for (size_t i = 0; i < sizeof far / sizeof far[0]; i++) {
        packet = route_of(2, far[i], 1);
        check_dropped("JP_ROUTE", &packet, LCM_TASK_FAR);
        packet = route_of(32, 1, far[i]);
        check_dropped("JP_ROUTE", &packet, LCM_TASK_FAR);
    }
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++) {
        packet = route_of(1, odd[i], 1);
        check_dropped("JP_ROUTE", &packet, LCM_TASK_NUMBER);
        packet = route_of(9, 1, odd[i]);
        check_dropped("JP_ROUTE", &packet, LCM_TASK_NUMBER);
    }
}

static void test_packets_of_other_types(void)
{
    struct packet packet;
    char nothing[] = "";
    const jp_state_t other = {.task_reason = nothing};

    check_dropped("JP_ROUTE", &sound_goal, LCM_TASK_TYPE);
    check_dropped("JP_GOAL", &sound_route, LCM_TASK_TYPE);
    packet.size = (size_t)jp_state_t_encode(packet.bytes, 0, PACKET_MAX, &other);
    check_dropped("JP_ROUTE", &packet, LCM_TASK_TYPE);
    check_dropped("JP_GOAL", &packet, LCM_TASK_TYPE);
}

static void test_junk_is_dropped(void)
{
    for (int i = 0; i < JUNK; i++) {
        struct packet packet = i % 2 == 0 ? sound_route : sound_goal;
        /* Half of it with the right fingerprint. */
        const size_t from = i % 4 < 2 ? 8 : 0;

        packet.size = (size_t)random_uniform(&noise, 0, 200);
        for (size_t at = from; at < packet.size; at++) {
            packet.bytes[at] = (uint8_t)random_uniform(&noise, 0, 256);
        }

        const uint64_t before = all_dropped();
        const bool taken = is_taken(i % 2 == 0 ? "JP_ROUTE" : "JP_GOAL", &packet);

        TEST_ASSERT_TRUE_MESSAGE(!taken || i % 4 == 1, "only a goal's fingerprint before 24 bytes may be sound");
        TEST_ASSERT_EQUAL_UINT64(before + !taken, all_dropped());
        drain();
    }
}

static void test_a_bad_packet_leaves_the_task_alone(void)
{
    struct packet bad = sound_route;

    TEST_ASSERT_TRUE(is_taken("JP_ROUTE", &sound_route));
    bad.size--;
    TEST_ASSERT_EQUAL_INT(0, lcm_publish(lcm, "JP_ROUTE", bad.bytes, (unsigned)bad.size));
    bad = route_of(2, 600, 0);
    TEST_ASSERT_EQUAL_INT(0, lcm_publish(lcm, "JP_ROUTE", bad.bytes, (unsigned)bad.size));
    lcm_gateway_pass(&gateway, now_us + MS);
    TEST_ASSERT_EQUAL_UINT64(2, all_dropped());
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, gateway.commander.phase);
    TEST_ASSERT_EQUAL_UINT(3, gateway.commander.task.length);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(10), gateway.commander.task.points[0].x);
}

/** What the gateway says while `count` bad packets come within a millisecond each. */
static void say(char errors[ERRORS_MAX], const struct packet *packet, int count)
{
    FILE *capture = tmpfile();
    const int saved = dup(STDERR_FILENO);
    size_t length;

    TEST_ASSERT_NOT_NULL(capture);
    (void)fflush(stderr);
    (void)dup2(fileno(capture), STDERR_FILENO);
    for (int i = 0; i < count; i++) {
        (void)is_taken("JP_ROUTE", packet);
    }
    (void)fflush(stderr);
    (void)dup2(saved, STDERR_FILENO);
    (void)close(saved);
    rewind(capture);
    length = fread(errors, 1, ERRORS_MAX - 1, capture);
    errors[length] = '\0';
    (void)fclose(capture);
}

static unsigned count_lines(const char *text)
{
    unsigned lines = 0;

    for (; *text != '\0'; text++) {
        lines += *text == '\n';
    }
    return lines;
}

static void test_each_kind_is_named_at_most_once_a_second(void)
{
    const struct packet far = route_of(2, 600, 0);
    struct packet cut = sound_route;
    char errors[ERRORS_MAX];

    cut.size -= 3;
    say(errors, &far, 1);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(1, count_lines(errors), errors);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(errors, "JP_ROUTE: a point is not within 512 m"), errors);
    say(errors, &far, 900);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(0, count_lines(errors), errors);
    say(errors, &cut, 1);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(1, count_lines(errors), errors);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(errors, "cut off"), errors);
    say(errors, &far, 2000);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(2, count_lines(errors), errors);
    TEST_ASSERT_EQUAL_UINT64(2901, gateway.dropped[LCM_TASK_FAR]);
}

/* Frames. */

static void put(uint32_t id, const void *data, uint8_t length)
{
    struct jp_can_frame frame = {.id = id, .length = length};

    memcpy(frame.data, data, length);
    TEST_ASSERT_EQUAL_INT(JP_OK, robot.port.send(robot.port.context, &frame));
}

/** Long enough for all messages to be taken. */
static void pass(void)
{
    for (int i = 0; i < 4; i++) {
        now_us += MS;
        lcm_gateway_pass(&gateway, now_us);
    }
}

#define PUT(NAME, name, ...)                                                                                           \
    do {                                                                                                               \
        const struct jp_can_##name##_t signals = {__VA_ARGS__};                                                        \
        uint8_t data[JP_CAN_LENGTH_MAX] = {0};                                                                         \
        (void)jp_can_##name##_pack(data, &signals, sizeof data);                                                       \
        put(JP_CAN_##NAME##_FRAME_ID, data, JP_CAN_##NAME##_LENGTH);                                                   \
    } while (0)

static void test_telemetry_arrives_in_the_units_of_the_types(void)
{
    PUT(POSE, pose, .x = JP_Q16(-12.5), .y = JP_Q16(3.25), .heading = -1024);
    PUT(MOTION, motion, .speed = 4096, .yaw_rate = -2048, .pitch = 655, .pitch_rate = 8192);
    PUT(REFERENCE, reference, .speed = 2048, .yaw_rate = 1024, .heading = 16384, .segment_time_left = 96);
    PUT(ECU_STATUS, ecu_status, .state = 2, .mode = 2, .operator_state = 1, .resets = 3);
    PUT(ECU_ERRORS, ecu_errors, .faults = 0x204);
    PUT(ROUTE_STATUS, route_status, .route_id = 9, .state = 3, .length = 7, .segment = 4, .segments_ended = 3,
        .plan_status = -4);
    PUT(CURRENT_SENSORS, current_sensors, .current_left = 512, .current_right = -128);
    PUT(MOTORS, motors, .voltage_left = 640, .voltage_right = -64, .saturated_ticks = 4000000000u);
    pass();
    TEST_ASSERT_EQUAL_UINT(1, states);
    TEST_ASSERT_EQUAL_INT64(6 * MS, state.utime);
    TEST_ASSERT_EQUAL_DOUBLE(-12.5, state.x);
    TEST_ASSERT_EQUAL_DOUBLE(3.25, state.y);
    TEST_ASSERT_EQUAL_DOUBLE(-0.25 * HEADINGS, state.heading);
    TEST_ASSERT_EQUAL_DOUBLE(1, state.speed);
    TEST_ASSERT_EQUAL_DOUBLE(-0.5 * HEADINGS, state.turn_rate);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 655 / 65536.0 * HEADINGS, state.pitch);
    TEST_ASSERT_EQUAL_DOUBLE(2 * HEADINGS, state.pitch_rate);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, state.reference_speed);
    TEST_ASSERT_EQUAL_DOUBLE(0.25 * HEADINGS, state.reference_turn_rate);
    TEST_ASSERT_EQUAL_DOUBLE(0.25 * HEADINGS, state.reference_heading);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, state.segment_time_left);
    TEST_ASSERT_EQUAL_DOUBLE(5, state.voltage_left);
    TEST_ASSERT_EQUAL_DOUBLE(-0.5, state.voltage_right);
    TEST_ASSERT_EQUAL_DOUBLE(2, state.current_left);
    TEST_ASSERT_EQUAL_DOUBLE(-0.5, state.current_right);
    TEST_ASSERT_EQUAL_INT64(4000000000, state.saturated_ticks);
    TEST_ASSERT_EQUAL_INT(2, state.robot_state);
    TEST_ASSERT_EQUAL_INT(1, state.operator_state);
    TEST_ASSERT_EQUAL_INT(3, state.resets);
    TEST_ASSERT_EQUAL_INT(0x204, state.faults);
    TEST_ASSERT_EQUAL_INT(9, state.route_id);
    TEST_ASSERT_EQUAL_INT(3, state.route_state);
    TEST_ASSERT_EQUAL_INT(7, state.route_length);
    TEST_ASSERT_EQUAL_INT(3, state.segments_ended);
    TEST_ASSERT_EQUAL_INT(-4, state.plan_status);
    TEST_ASSERT_EQUAL_STRING("", state.task_reason);
}

static void put_plan(uint8_t segment, int32_t energy_raw)
{
    PUT(SEGMENT_MOTION, segment_motion, .segment = segment, .speed = JP_Q24(0.5), .turn_rate = -JP_Q24(0.25));
    PUT(SEGMENT_SHAPE, segment_shape, .segment = segment, .turn = JP_Q24(1.5), .duration = JP_Q16(20));
    PUT(SEGMENT_FORECAST, segment_forecast, .segment = segment, .energy = energy_raw);
}

static void test_plans_results_and_residuals(void)
{
    put_plan(1, JP_Q16(100));
    pass();
    TEST_ASSERT_EQUAL_UINT(1, plans);
    TEST_ASSERT_EQUAL_INT(0, plan.point_count);
    TEST_ASSERT_EQUAL_INT(1, plan.segment_count);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, plan.segments[0].speed);
    TEST_ASSERT_EQUAL_DOUBLE(-0.25, plan.segments[0].turn_rate);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, plan.segments[0].turn);
    TEST_ASSERT_EQUAL_DOUBLE(20, plan.segments[0].duration);
    TEST_ASSERT_EQUAL_DOUBLE(100, plan.segments[0].energy);
    for (uint8_t i = 0; i < 20; i++) {
        PUT(ENERGY_PARAMETER, energy_parameter, .index = i, .count = 20, .value = i * 65536 + 32768);
    }
    pass();
    TEST_ASSERT_EQUAL_UINT(1, identifications);
    TEST_ASSERT_EQUAL_DOUBLE(12.5, identification.a[12]);
    TEST_ASSERT_EQUAL_DOUBLE(13.5, identification.b[0]);
    TEST_ASSERT_EQUAL_DOUBLE(15.5, identification.electronics_power);
    TEST_ASSERT_EQUAL_DOUBLE(19.5, identification.motor_resistance);
    TEST_ASSERT_EQUAL_INT(0, identification.segment_count);
    put_plan(2, JP_Q16(50));
    PUT(SEGMENT_RESULT, segment_result, .segment = 1, .spent = (uint32_t)JP_Q16(101.5), .drawn = -JP_Q16(2));
    pass();
    TEST_ASSERT_EQUAL_UINT(2, identifications);
    TEST_ASSERT_EQUAL_INT(1, identification.segment_count);
    TEST_ASSERT_EQUAL_DOUBLE(100, identification.residuals[0].forecast);
    TEST_ASSERT_EQUAL_DOUBLE(-1.5, identification.residuals[0].residual);
    TEST_ASSERT_EQUAL_UINT(1, energies);
    TEST_ASSERT_EQUAL_INT(1, energy.segment);
    TEST_ASSERT_EQUAL_DOUBLE(101.5, energy.segment_spent);
    TEST_ASSERT_EQUAL_DOUBLE(-2, energy.segment_drawn);
    put_plan(1, JP_Q16(7));
    now_us += 1000 * MS;
    PUT(ENERGY_SPENT, energy_spent, .energy = (int64_t)3 << 31);
    pass();
    TEST_ASSERT_EQUAL_INT(1, plan.segment_count);
    TEST_ASSERT_EQUAL_INT(0, energy.segment);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, energy.spent);
}

static void test_lost_frames_of_a_plan_show_as_unknown(void)
{
    put_plan(1, JP_Q16(100));
    PUT(SEGMENT_SHAPE, segment_shape, .segment = 2, .turn = JP_Q24(1), .duration = JP_Q16(20));
    PUT(SEGMENT_FORECAST, segment_forecast, .segment = 4, .energy = JP_Q16(30));
    pass();
    TEST_ASSERT_EQUAL_UINT(2, plans);
    TEST_ASSERT_EQUAL_INT(4, plan.segment_count);
    TEST_ASSERT_EQUAL_DOUBLE(100, plan.segments[0].energy);
    TEST_ASSERT_EQUAL_DOUBLE(1, plan.segments[1].turn);
    TEST_ASSERT_DOUBLE_IS_NAN(plan.segments[1].speed);
    TEST_ASSERT_DOUBLE_IS_NAN(plan.segments[1].energy);
    TEST_ASSERT_EQUAL_INT(3, plan.segments[2].index);
    TEST_ASSERT_DOUBLE_IS_NAN(plan.segments[2].turn);
    TEST_ASSERT_DOUBLE_IS_NAN(plan.segments[3].speed);
    TEST_ASSERT_EQUAL_DOUBLE(30, plan.segments[3].energy);
    PUT(SEGMENT_RESULT, segment_result, .segment = 9, .spent = 65536);
    pass();
    TEST_ASSERT_EQUAL_INT(9, energy.segment);
    TEST_ASSERT_DOUBLE_IS_NAN(energy.segment_forecast);
}

static void test_segment_numbers_and_parameters_out_of_range(void)
{
    put_plan(0, JP_Q16(1));
    put_plan(255, JP_Q16(1));
    for (int i = 0; i < 300; i++) {
        PUT(SEGMENT_RESULT, segment_result, .segment = 255, .spent = 65536);
        PUT(SEGMENT_RESULT, segment_result, .segment = 0, .spent = 65536);
        pass();
    }
    for (unsigned i = 0; i < 256; i++) {
        PUT(ENERGY_PARAMETER, energy_parameter, .index = (uint8_t)i, .count = 21, .value = 65536);
        PUT(ENERGY_PARAMETER, energy_parameter, .index = (uint8_t)(i | 0x20u), .count = 20, .value = 65536);
        pass();
    }
    TEST_ASSERT_EQUAL_UINT(1, plans);
    TEST_ASSERT_EQUAL_INT(255, plan.segment_count);
    TEST_ASSERT_EQUAL_UINT(0, identifications);
}

static void test_a_flood_is_published_at_most_50_times_a_second(void)
{
    for (int i = 0; i < 3000; i++) {
        PUT(MOTORS, motors, .voltage_left = 1);
        PUT(ENERGY_SPENT, energy_spent, .energy = i);
        now_us += MS;
        lcm_gateway_pass(&gateway, now_us);
    }
    pass();
    TEST_ASSERT_UINT_WITHIN(2, 150, states);
    TEST_ASSERT_UINT_WITHIN(2, 150, energies);
}

static void test_jittering_frames_all_count(void)
{
    const uint64_t start_us = now_us;

    for (unsigned i = 1; i <= 500; i++) {
        now_us = start_us + i * 20 * MS + (uint64_t)random_uniform(&noise, 0, 15 * MS);
        PUT(MOTORS, motors, .voltage_left = 1);
        lcm_gateway_pass(&gateway, now_us);
    }
    pass();
    TEST_ASSERT_EQUAL_UINT(500, states);
}

static void test_any_frame_is_borne(void)
{
    static const uint32_t ids[] = {0x10,  0x20,  0x21,  0x22,  0x100, 0x101, 0x102, 0x103, 0x180,
                                   0x181, 0x182, 0x183, 0x184, 0x185, 0x186, 0x187, 0x188, 0x189,
                                   0x18a, 0x18b, 0x18c, 0x18d, 0x18e, 0x190, 0x7f1, 0x7ff, 0x40000183};

    for (int i = 0; i < 10 * JUNK; i++) {
        const uint32_t id = ids[(size_t)random_uniform(&noise, 0, sizeof ids / sizeof ids[0])];
        uint8_t data[8];

        for (size_t at = 0; at < sizeof data; at++) {
            data[at] = (uint8_t)random_uniform(&noise, 0, 256);
        }
        put(id, data, (uint8_t)random_uniform(&noise, 0, 9));
        now_us += MS;
        lcm_gateway_pass(&gateway, now_us);
        drain();
    }
    TEST_ASSERT_GREATER_THAN_UINT(100, states);
    TEST_ASSERT_GREATER_THAN_UINT(10, plans);
    TEST_ASSERT_EQUAL_UINT64(0, gateway.telemetry.unsent);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_IDLE, gateway.commander.phase);
}

static void simulate(uint32_t from, uint32_t until)
{
    for (uint32_t tick = from; tick < until; tick++) {
        PUT(SIM_TIME, sim_time, .tick = tick, .power = 1);
        if (tick % 20 == 0) {
            PUT(MOTORS, motors, .voltage_left = 1);
        }
        lcm_gateway_pass(&gateway, now_us);
        drain();
    }
}

static void test_in_lockstep_time_is_that_of_the_simulation(void)
{
    simulate(1000000, 1001000); /* the wall stands still */
    pass();
    TEST_ASSERT_EQUAL_UINT(50, states);
    TEST_ASSERT_EQUAL_INT64(1000980000, state.utime);
}

static void test_another_simulation_begins_at_0_again_and_the_task_outlasts_it(void)
{
    simulate(50000, 50100);
    put_plan(1, JP_Q16(1));
    pass();
    TEST_ASSERT_EQUAL_INT(0, lcm_publish(lcm, "JP_ROUTE", sound_route.bytes, (unsigned)sound_route.size));
    pass();
    PUT(SIM_TIME, sim_time, .tick = UINT32_MAX, .power = 0);
    simulate(0, 1000);
    pass();
    TEST_ASSERT_EQUAL_UINT(5 + 50, states);
    TEST_ASSERT_EQUAL_INT64(980000, state.utime);
    TEST_ASSERT_EQUAL_INT(0, gateway.telemetry.planned);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, gateway.commander.phase);
}

static void test_a_failed_task_is_told_with_its_reason(void)
{
    TEST_ASSERT_TRUE(is_taken("JP_ROUTE", &sound_route));
    PUT(ECU_STATUS, ecu_status, .state = 3);
    PUT(ECU_STATUS, ecu_status, .state = 3);
    PUT(MOTORS, motors, .voltage_left = 1);
    pass();
    TEST_ASSERT_EQUAL_INT(JP_STATE_T_TASK_FAILED, state.task);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(state.task_reason, "fallen"), state.task_reason);
}

int main(void)
{
    printf("seed %u\n", SEED);
    make_packets();
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
