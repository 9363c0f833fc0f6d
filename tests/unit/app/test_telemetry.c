/* What is told the operator: each frame as cantools packs it, saturation, cycle times at every tick rate. */
#include <joulepath/tables.h>
#include <string.h>

#include "hal/app/telemetry.h"
#include "tests/support/ecu_start.h"

#include "hal/can/jp_can.h"

#include "unity.h"

static struct jp_robot_config config;
static struct jp_ecu ecu;
static struct jp_ecu_balancer balancer;
static struct jp_can_frame frames[JP_TELEMETRY_FRAMES_MAX];
static struct jp_tick_telemetry *const telemetry = &balancer.robot.internal.telemetry;

static enum jp_status swallow(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    (void)frame;
    return JP_OK;
}

static enum jp_can_state always_on(void *context)
{
    (void)context;
    return JP_CAN_ON;
}

static const struct jp_reset_report reset_report = {
    .cause = JP_RESET_STACK,
    .crashes = 2,
    .crash =
        {.cause = JP_RESET_STACK, .exception = 0x104, .pc = 0x0800C123U, .status = 0x00020010U, .tick = 0x01020304U},
};

static void start(uint32_t tick_rate)
{
    static const struct jp_can_port port = {NULL, swallow, always_on};
    const char *field = "";

    config = jp_robot_courier24;
    config.metres_per_turn = JP_Q24_ONE;
    config.estimator.tick_rate = tick_rate;
    config.reference.tick_rate = tick_rate;
    config.lqr.tick_rate = tick_rate;
    config.meter.tick_rate = tick_rate;
    config.trajectory.tick_rate = tick_rate;
    TEST_ASSERT_EQUAL_INT(JP_OK, ecu_start(&ecu, &balancer, &config, &jp_energy_model_courier24, &port, NULL, &field));
}

void setUp(void)
{
    start(1000);
}

void tearDown(void)
{
}

/* The next frame with this id, within one round of the schedule. */
static const uint8_t *next(uint32_t id)
{
    for (unsigned tick = 0; tick < 100; tick++) {
        const unsigned count = jp_telemetry_due(&ecu, frames);

        for (unsigned i = 0; i < count; i++) {
            if (frames[i].id == id) {
                TEST_ASSERT_EQUAL_UINT8(8, frames[i].length);
                return frames[i].data;
            }
        }
    }
    TEST_FAIL_MESSAGE("not sent");
    return NULL;
}

#define EXPECT_FRAME(id, ...)                                                                                          \
    do {                                                                                                               \
        static const uint8_t expected[8] = {__VA_ARGS__};                                                              \
        TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, next(id), 8);                                                           \
    } while (0)

/* Contents */

static void test_status(void)
{
    telemetry->state = JP_ROBOT_DRIVING;
    ecu.internal.operator_link.mode = JP_MODE_DRIVE;
    ecu.internal.operator_link.state = JP_OPERATOR_ALIVE;
    ecu.resets = 3;
    ecu.tick = 70000999;
    EXPECT_FRAME(0x180, 0x32, 0x03, JP_VERSION_MAJOR, JP_VERSION_MINOR, JP_VERSION_PATCH, 0x70, 0x11, 0x01);
    telemetry->state = JP_ROBOT_FAULT;
    ecu.internal.operator_link.mode = JP_MODE_OFF;
    ecu.internal.operator_link.state = JP_OPERATOR_LOST;
    ecu.resets = 256;
    ecu.tick = UINT32_MAX;
    EXPECT_FRAME(0x180, 0x44, 0xFF, JP_VERSION_MAJOR, JP_VERSION_MINOR, JP_VERSION_PATCH, 0x37, 0x89, 0x41);
}

static void test_errors_of_the_tick_and_the_background_add_up(void)
{
    telemetry->faults = JP_FAULT_OVERSPEED | JP_FAULT_IMU_RANGE;
    ecu.sample_counts = (struct jp_ecu_counts){.crc_errors = 1, .sequence_errors = 1, .malformed = 4};
    ecu.operator_counts = (struct jp_ecu_counts){.sequence_errors = 1, .malformed = 2};
    ecu.operator_timeouts = 3;
    ecu.bus_offs = 4;
    ecu.conflicts = 5;
    EXPECT_FRAME(0x181, 0x01, 0x02, 0x01, 0x02, 0x03, 0x04, 0x05, 0x06);
    ecu.sample_counts = (struct jp_ecu_counts){.crc_errors = 255, .sequence_errors = 200, .malformed = 1};
    ecu.operator_counts = (struct jp_ecu_counts){.crc_errors = 1, .sequence_errors = 56, .malformed = 254};
    EXPECT_FRAME(0x181, 0x01, 0x02, 0xFF, 0xFF, 0x03, 0x04, 0x05, 0xFF);
}

static void test_losses(void)
{
    ecu.internal.samples.lost = 0x1234;
    ecu.unknown_frames = 0x5678;
    ecu.sample_counts.rejected = 4;
    ecu.operator_counts.rejected = 5;
    ecu.send_errors = 0xABCD;
    EXPECT_FRAME(0x182, 0x34, 0x12, 0x78, 0x56, 0x09, 0xCD, 0xAB, 0x00);
    ecu.sample_counts.rejected = 255;
    EXPECT_FRAME(0x182, 0x34, 0x12, 0x78, 0x56, 0xFF, 0xCD, 0xAB, 0x00);
}

static void test_route_status_shows_the_driven_route(void)
{
    ecu.internal.routes.driven.id = 7;
    ecu.internal.routes.driven.length = 3;
    ecu.internal.routes.offered.id = 99;
    ecu.internal.routes.offered.length = 9;
    ecu.internal.routes.received = 2;
    ecu.internal.routes.state = JP_ROUTE_STOPPED;
    ecu.internal.routes.reason = JP_REASON_PLAN;
    balancer.pilot.status = JP_ERR_ZERO_LENGTH;
    telemetry->segment = 1;
    telemetry->segments_ended = 1;
    EXPECT_FRAME(0x183, 0x07, 0x46, 0x02, 0x03, 0x01, 0x01, 0xFC, 0x00);
    telemetry->segment = 256;
    telemetry->segments_ended = UINT16_MAX;
    EXPECT_FRAME(0x183, 0x07, 0x46, 0x02, 0x03, 0xFF, 0xFF, 0xFC, 0x00);
}

static void test_route_status_shows_the_offered_route_until_it_is_driven(void)
{
    static const enum jp_route_state offered[] = {JP_ROUTE_RECEIVING, JP_ROUTE_READY, JP_ROUTE_REJECTED};
    static const enum jp_route_state driven[] = {JP_ROUTE_DRIVING, JP_ROUTE_DONE, JP_ROUTE_STOPPED};

    ecu.internal.routes.driven.id = 7;
    ecu.internal.routes.driven.length = 3;
    ecu.internal.routes.offered.id = 99;
    ecu.internal.routes.offered.length = 9;
    for (unsigned i = 0; i < 3; i++) {
        const uint8_t *data;

        ecu.internal.routes.state = offered[i];
        data = next(0x183);
        TEST_ASSERT_EQUAL_UINT8(99, data[0]);
        TEST_ASSERT_EQUAL_UINT8(9, data[3]);
        ecu.internal.routes.state = driven[i];
        data = next(0x183);
        TEST_ASSERT_EQUAL_UINT8(7, data[0]);
        TEST_ASSERT_EQUAL_UINT8(3, data[3]);
    }
}

static void test_pose(void)
{
    balancer.robot.internal.odometry.x = -70000 * ((int64_t)1 << 16);
    balancer.robot.internal.odometry.y = INT64_MAX;
    telemetry->motion.yaw = 7 * JP_PHASE_TURN - JP_PHASE_TURN / 4;
    EXPECT_FRAME(0x184, 0x90, 0xEE, 0xFE, 0xFF, 0xFF, 0xFF, 0x07, 0xC0);
    balancer.robot.internal.odometry.x = INT64_MIN;
    balancer.robot.internal.odometry.y = 0;
    telemetry->motion.yaw = 0;
    EXPECT_FRAME(0x184, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x00);
}

static void test_motion(void)
{
    telemetry->motion.wheel_rate = -JP_Q24_ONE;
    telemetry->motion.yaw_rate = INT32_MAX;
    telemetry->motion.pitch = -JP_Q24_ONE / 4;
    telemetry->motion.pitch_rate = 100 * 4096 + 2047;
    EXPECT_FRAME(0x185, 0x00, 0xF0, 0xFF, 0x7F, 0x00, 0xC0, 0x64, 0x00);
}

static void test_reference(void)
{
    balancer.robot.internal.reference.wheel.rate = JP_Q24(0.5);
    balancer.robot.internal.reference.yaw.rate = INT32_MIN;
    balancer.robot.internal.reference.yaw.angle = JP_PHASE_TURN / 4;
    telemetry->segment_ticks_left = 1500;
    EXPECT_FRAME(0x186, 0x00, 0x08, 0x00, 0x80, 0x00, 0x40, 0x60, 0x00);
    telemetry->segment_ticks_left = UINT32_MAX;
    EXPECT_FRAME(0x186, 0x00, 0x08, 0x00, 0x80, 0x00, 0x40, 0xFF, 0xFF);
}

static void test_motors(void)
{
    telemetry->voltages.left = JP_Q16(12);
    telemetry->voltages.right = INT32_MIN;
    telemetry->saturated_ticks = 0xDEADBEEF;
    EXPECT_FRAME(0x187, 0x00, 0x06, 0x00, 0x80, 0xEF, 0xBE, 0xAD, 0xDE);
}

static void test_energies(void)
{
    balancer.robot.internal.meter.model = 0x0123456789ABCDEF;
    balancer.robot.internal.meter.battery = -2;
    EXPECT_FRAME(0x188, 0xEF, 0xCD, 0xAB, 0x89, 0x67, 0x45, 0x23, 0x01);
    EXPECT_FRAME(0x189, 0xFE, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF);
}

static void test_the_energy_model_is_sent_one_parameter_after_the_other(void)
{
    const struct jp_energy_model *model = &jp_energy_model_courier24;
    const jp_q16 rest[7] = {model->b[0],
                            model->b[1],
                            model->electronics_power,
                            model->settling_time,
                            model->voltage_per_speed,
                            model->voltage_per_turn_rate,
                            model->motor_resistance};

    for (uint8_t round = 0; round < 2; round++) {
        for (uint8_t i = 0; i < 20; i++) {
            const uint8_t *data = next(0x18E);
            int32_t value;

            memcpy(&value, data + 4, sizeof value); /* every host and target is little-endian */
            TEST_ASSERT_EQUAL_UINT8(i, data[0]);
            TEST_ASSERT_EQUAL_UINT8(20, data[1]);
            TEST_ASSERT_EQUAL_HEX8(0, data[2] | data[3]);
            TEST_ASSERT_EQUAL_INT32(i < 13 ? model->a[i] : rest[i - 13], value);
        }
    }
}

static void announce(uint16_t segment)
{
    const struct jp_ecu_kind *kind = ecu.internal.robot.kind;
    struct jp_ecu_segment planned;

    balancer.pilot.leg = (struct jp_pilot_leg){JP_Q24(8), -JP_Q24(3.14), JP_Q16(0.25), -JP_Q16(3)};
    kind->segment(&balancer, (uint16_t)(segment - 1U), &planned);
    TEST_ASSERT_EQUAL_UINT(3, jp_telemetry_segment(&planned, ecu.internal.plan.frames));
    ecu.internal.plan.left = 3;
}

static void test_the_last_reset_is_reported_where_it_is_known(void)
{
    struct jp_reset_report report = reset_report;

    jp_ecu_report_reset(&ecu, &report);
    EXPECT_FRAME(0x18F, 0x06, 0x02, 0x04, 0x01, 0x04, 0x03, 0x02, 0x01);
    EXPECT_FRAME(0x191, 0x23, 0xC1, 0x00, 0x08, 0x10, 0x00, 0x02, 0x00);
    report = (struct jp_reset_report){.cause = JP_RESET_WATCHDOG, .crashes = 256};
    EXPECT_FRAME(0x18F, 0x04, 0xFF, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00);
    EXPECT_FRAME(0x191, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00);
}

static void test_no_reset_is_reported_where_none_is_known(void)
{
    for (unsigned tick = 0; tick < 200; tick++) {
        const unsigned count = jp_telemetry_due(&ecu, frames);

        for (unsigned i = 0; i < count; i++) {
            TEST_ASSERT_TRUE(frames[i].id < 0x18F);
        }
    }
}

static void test_a_plan_is_announced_once_in_three_frames(void)
{
    announce(300);
    EXPECT_FRAME(0x18A, 0xFF, 0xFF, 0xFF, 0xFF, 0x07, 0x00, 0x00, 0x80);
    TEST_ASSERT_EQUAL_UINT8(2, ecu.internal.plan.left);
    announce(2);
    ecu.internal.plan.left = 2;
    EXPECT_FRAME(0x18B, 0x02, 0xF6, 0x28, 0xDC, 0x0C, 0x00, 0x04, 0x00);
    TEST_ASSERT_EQUAL_UINT8(1, ecu.internal.plan.left);
    EXPECT_FRAME(0x18C, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00, 0xFD, 0xFF);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.internal.plan.left);
    for (unsigned tick = 0; tick < 100; tick++) {
        TEST_ASSERT_LESS_OR_EQUAL_UINT(1, jp_telemetry_due(&ecu, frames));
    }
}

/* Whatever the unit of the model is, and saturated. */
static void test_a_forecast_is_sent_in_joules(void)
{
    struct jp_energy_model model = jp_energy_model_courier24;

    balancer.pilot.config.model = &model;
    model.unit_exponent = 2;
    announce(255);
    ecu.internal.plan.left = 1;
    EXPECT_FRAME(0x18C, 0xFF, 0x00, 0x00, 0x00, 0x00, 0x00, 0xF4, 0xFF); /* −12 J */
    model.unit_exponent = -1;
    announce(255);
    ecu.internal.plan.left = 1;
    EXPECT_FRAME(0x18C, 0xFF, 0x00, 0x00, 0x00, 0x00, 0x80, 0xFE, 0xFF); /* −1.5 J */
    model.unit_exponent = 15;
    announce(255);
    ecu.internal.plan.left = 1;
    EXPECT_FRAME(0x18C, 0xFF, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80);
}

static void test_a_result_is_told_once(void)
{
    telemetry->segments_ended = 2;
    telemetry->segment_energy_model = INT64_MAX;
    telemetry->segment_energy_battery = INT64_MIN;
    EXPECT_FRAME(0x18D, 0x02, 0xFF, 0xFF, 0xFF, 0x0F, 0x00, 0x00, 0x80);
    for (unsigned tick = 0; tick < 100; tick++) {
        TEST_ASSERT_LESS_OR_EQUAL_UINT(1, jp_telemetry_due(&ecu, frames));
    }
    telemetry->segments_ended = 0; /* a new route */
    (void)jp_telemetry_due(&ecu, frames);
    telemetry->segments_ended = 1;
    telemetry->segment_energy_model = -1;
    telemetry->segment_energy_battery = (jp_energy)-3 * 65536 * 65536;
    EXPECT_FRAME(0x18D, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0xFD, 0xFF);
}

/* In 1/4096 J, so that legs of minutes fit. */
static void test_a_result_of_kilojoules(void)
{
    telemetry->segments_ended = 1;
    telemetry->segment_energy_model = (jp_energy)5000 * 65536 * 65536;
    telemetry->segment_energy_battery = (jp_energy)5000 * 65536 * 65536;
    EXPECT_FRAME(0x18D, 0x01, 0x00, 0x80, 0x38, 0x01, 0x00, 0x88, 0x13);
}

/* The schedule */

static const struct {
    uint32_t id;
    uint32_t cycle_ms; /* of the DBC */
} cyclic[] = {
    {JP_CAN_ECU_STATUS_FRAME_ID, JP_CAN_ECU_STATUS_CYCLE_TIME_MS},
    {JP_CAN_ECU_ERRORS_FRAME_ID, JP_CAN_ECU_ERRORS_CYCLE_TIME_MS},
    {JP_CAN_ECU_LOSSES_FRAME_ID, JP_CAN_ECU_LOSSES_CYCLE_TIME_MS},
    {JP_CAN_ROUTE_STATUS_FRAME_ID, JP_CAN_ROUTE_STATUS_CYCLE_TIME_MS},
    {JP_CAN_POSE_FRAME_ID, JP_CAN_POSE_CYCLE_TIME_MS},
    {JP_CAN_MOTION_FRAME_ID, JP_CAN_MOTION_CYCLE_TIME_MS},
    {JP_CAN_REFERENCE_FRAME_ID, JP_CAN_REFERENCE_CYCLE_TIME_MS},
    {JP_CAN_MOTORS_FRAME_ID, JP_CAN_MOTORS_CYCLE_TIME_MS},
    {JP_CAN_ENERGY_SPENT_FRAME_ID, JP_CAN_ENERGY_SPENT_CYCLE_TIME_MS},
    {JP_CAN_ENERGY_DRAWN_FRAME_ID, JP_CAN_ENERGY_DRAWN_CYCLE_TIME_MS},
    {JP_CAN_ENERGY_PARAMETER_FRAME_ID, JP_CAN_ENERGY_PARAMETER_CYCLE_TIME_MS},
    {JP_CAN_RESET_REPORT_FRAME_ID, JP_CAN_RESET_REPORT_CYCLE_TIME_MS},
    {JP_CAN_CRASH_REPORT_FRAME_ID, JP_CAN_CRASH_REPORT_CYCLE_TIME_MS},
};
#define CYCLIC (sizeof cyclic / sizeof cyclic[0])

struct seen {
    uint32_t count;
    uint32_t last;
};

/* The time between two of a kind is the cycle's, to the tick that it falls in. */
static void note(struct seen *seen, uint32_t cycle_ms, uint32_t tick, uint32_t tick_rate)
{
    if (seen->count > 0U) {
        const uint32_t ticks = tick - seen->last;

        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(cycle_ms * tick_rate / 1000U, ticks);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32((cycle_ms * tick_rate + 999U) / 1000U, ticks);
    }
    seen->count++;
    seen->last = tick;
}

/* Two seconds; returns the most frames of one tick. */
static unsigned check_cycles(uint32_t tick_rate)
{
    struct seen seen[CYCLIC] = {{0, 0}};
    unsigned most = 0;

    start(tick_rate);
    jp_ecu_report_reset(&ecu, &reset_report);
    for (uint32_t tick = 0; tick < 2U * tick_rate; tick++) {
        const unsigned count = jp_telemetry_due(&ecu, frames);

        most = count > most ? count : most;
        for (unsigned i = 0; i < count; i++) {
            unsigned kind = 0;

            while (kind < CYCLIC && cyclic[kind].id != frames[i].id) {
                kind++;
            }
            TEST_ASSERT_LESS_THAN_UINT(CYCLIC, kind);
            note(&seen[kind], cyclic[kind].cycle_ms, tick, tick_rate);
        }
    }
    for (unsigned kind = 0; kind < CYCLIC; kind++) {
        TEST_ASSERT_EQUAL_UINT32(2000U / cyclic[kind].cycle_ms, seen[kind].count);
    }
    return most;
}

static void test_cycle_times_are_those_of_the_dbc(void)
{
    TEST_ASSERT_EQUAL_UINT(1, check_cycles(1000));
}

static void test_cycle_times_hold_at_every_tick_rate(void)
{
    static const uint32_t rates[] = {100, 125, 200, 250, 333, 400, 500, 800, 999};

    for (unsigned i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        TEST_ASSERT_LESS_OR_EQUAL_UINT(JP_TELEMETRY_FRAMES_MAX - 2U, check_cycles(rates[i]));
    }
    TEST_ASSERT_EQUAL_UINT(1, check_cycles(1001));
    TEST_ASSERT_EQUAL_UINT(1, check_cycles(1500));
    TEST_ASSERT_EQUAL_UINT(1, check_cycles(2000));
    TEST_ASSERT_EQUAL_UINT(1, check_cycles(3000));
    TEST_ASSERT_EQUAL_UINT(1, check_cycles(10000));
}

static void test_a_plan_and_a_result_join_the_fullest_tick(void)
{
    unsigned most = 0;

    start(100);
    jp_ecu_report_reset(&ecu, &reset_report);
    for (uint16_t tick = 0; tick < 100; tick++) {
        unsigned count;

        announce(1);
        telemetry->segments_ended++;
        count = jp_telemetry_due(&ecu, frames);
        most = count > most ? count : most;
    }
    TEST_ASSERT_EQUAL_UINT(JP_TELEMETRY_FRAMES_MAX, most);
}

/* What was learned: limited to what a signal holds. */
static void expect_lessons(const struct jp_ecu_lessons *lessons, const uint8_t expected[8])
{
    struct jp_can_frame frame;

    jp_telemetry_lessons(lessons, &frame);
    TEST_ASSERT_EQUAL_HEX32(0x193, frame.id);
    TEST_ASSERT_EQUAL_UINT8(8, frame.length);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, frame.data, 8);
}

static void test_what_was_learned_is_limited(void)
{
    expect_lessons(&(struct jp_ecu_lessons){.version = 0x1234,
                                            .changes = 3,
                                            .outliers = 4,
                                            .left_out = 5,
                                            .cause = JP_CAUSE_PAYLOAD,
                                            .evidence = JP_EVIDENCE_CURRENT,
                                            .stored = JP_STORED_OTHER_TABLES},
                   (const uint8_t[]){0x34, 0x12, 3, 4, 5, 0x96, 0, 0});
    expect_lessons(&(struct jp_ecu_lessons){.version = 0x10000,
                                            .changes = 256,
                                            .outliers = UINT32_MAX,
                                            .left_out = 255,
                                            .cause = JP_CAUSE_OTHER,
                                            .stored = JP_STORED_DAMAGED},
                   (const uint8_t[]){0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xA3, 0, 0});
}

static void test_a_report_is_told_once_the_last_frame_first(void)
{
    unsigned seen = 0;

    ecu.internal.learned = (struct jp_ecu_report){.frames = {{.id = 0x193}, {.id = 0x192}}, .left = 2};
    for (uint16_t tick = 0; tick < 10; tick++) {
        const unsigned count = jp_telemetry_due(&ecu, frames);

        for (unsigned i = 0; i < count; i++) {
            if (frames[i].id == 0x192U || frames[i].id == 0x193U) {
                TEST_ASSERT_EQUAL_HEX32(0x192U + seen, frames[i].id);
                seen++;
            }
        }
    }
    TEST_ASSERT_EQUAL_UINT(2, seen);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.internal.learned.left);
}

/* A plan is told first, so that no tick holds more frames than without learning. */
static void test_what_was_learned_waits_for_a_plan(void)
{
    unsigned most = 0;

    announce(1);
    ecu.internal.learned.left = 2;
    for (uint16_t tick = 0; tick < 3; tick++) {
        const unsigned count = jp_telemetry_due(&ecu, frames);

        most = count > most ? count : most;
        TEST_ASSERT_EQUAL_UINT8(2, ecu.internal.learned.left);
    }
    TEST_ASSERT_LESS_OR_EQUAL_UINT(2, most);
    (void)jp_telemetry_due(&ecu, frames);
    TEST_ASSERT_EQUAL_UINT8(1, ecu.internal.learned.left);
}
