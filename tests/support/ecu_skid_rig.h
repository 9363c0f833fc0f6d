/** The whole application of a robot that its sides steer on a bus, with an operator and wheels that turn as the
 * controller asks. */
#ifndef JOULEPATH_TESTS_SUPPORT_ECU_SKID_RIG_H
#define JOULEPATH_TESTS_SUPPORT_ECU_SKID_RIG_H

#include <joulepath/tables.h>
#include <string.h>

#include "hal/app/ecu.h"
#include "hal/app/ecu_skid.h"
#include "tests/support/commands.h"

#include "unity.h"

#define RATE       500U /* ticks a second */
#define HOLD_TICKS ((unsigned)JP_SAMPLE_HOLD_MS * RATE / 1000U)

static struct {
    enum jp_status answer; /* of send() */
    struct jp_e2e_receiver receiver;
    struct jp_actuation actuation;
    unsigned commands;                   /* MotorCommands */
    uint8_t last[32][JP_CAN_LENGTH_MAX]; /* frames 0x180 to 0x19F */
    uint16_t counts[32];
} bus;

static struct jp_skid_robot_config config;
static struct jp_ecu_skid_config tables;
static struct jp_ecu_skid skid;
static struct jp_ecu ecu;
static struct jp_retained retained;
static struct jp_sensors sensors;
static jp_phase angles[JP_SKID_SIDES];
static jp_turns_per_s rolling; /**< of both sides, whatever the controller asks; 0: as it asks */
static uint8_t sample_counter;
static uint8_t command_counter;
static uint8_t waypoint_counter;
static uint8_t offer_counter;

static inline enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    if (bus.answer != JP_OK) {
        return bus.answer;
    }
    TEST_ASSERT_EQUAL_UINT8(8, frame->length);
    if (frame->id == JP_CAN_MOTOR_COMMAND_FRAME_ID) {
        const enum jp_e2e_result result = jp_message_to_actuation(&bus.receiver, frame, &bus.actuation);

        TEST_ASSERT_EQUAL_INT(bus.commands == 0U ? JP_E2E_FIRST : JP_E2E_OK, result);
        bus.commands++;
        return JP_OK;
    }
    TEST_ASSERT_EQUAL_HEX32(0x180, frame->id & ~0x1FU);
    memcpy(bus.last[frame->id & 0x1FU], frame->data, JP_CAN_LENGTH_MAX);
    bus.counts[frame->id & 0x1FU]++;
    return JP_OK;
}

static inline enum jp_can_state always_on(void *context)
{
    (void)context;
    return JP_CAN_ON;
}

static const struct jp_can_port port = {NULL, send, always_on};

static inline enum jp_status start(const char **field)
{
    struct jp_ecu_robot robot;
    const enum jp_status status = jp_ecu_skid_init(&skid, &tables, &robot, field);

    return status == JP_OK ? jp_ecu_init(&ecu, &robot, &port, &retained) : status;
}

static inline void init(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, start(&field));
}

void setUp(void)
{
    config = jp_skid_robot_zhang2018;
    config.monitor.freeze_ticks = 0;
    tables = (struct jp_ecu_skid_config){.robot = &config,
                                         .energy = &jp_skid_energy_zhang2018,
                                         .learning = &jp_skid_learning_zhang2018,
                                         .limits = &jp_path_limits_zhang2018,
                                         .corner = JP_Q24(0.35)};
    memset(&bus, 0, sizeof bus);
    memset(&retained, 0, sizeof retained);
    memset(angles, 0, sizeof angles);
    rolling = 0;
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(46)};
    sample_counter = 0;
    command_counter = 0;
    waypoint_counter = 0;
    offer_counter = 0;
    init();
}

void tearDown(void)
{
}

static inline jp_turns_per_s wheel_rate(int side)
{
    return rolling != 0 ? rolling : skid.robot.internal.control.sides[side].reference;
}

static inline uint32_t counts_of(int side)
{
    angles[side] += jp_phase_step(wheel_rate(side), jp_phase_per_rate(RATE));
    return (uint32_t)((int64_t)angles[side] / (int64_t)config.control.wheel_per_count);
}

/** (u − K ω)/R; none where the bridges are off. */
static inline jp_q16 current_of(int side, jp_q16 voltage)
{
    if (bus.actuation.enabled == 0U) {
        return 0;
    }
    const jp_q16 back_emf =
        jp_multiply_shift(config.control.back_emf, skid.robot.internal.control.sides[side].rate, 24);

    return jp_q16_divide(voltage - back_emf, config.control.resistance);
}

static inline void move(void)
{
    const jp_turns_per_s ahead = wheel_rate(JP_SKID_RIGHT) - wheel_rate(JP_SKID_LEFT);

    sensors.encoder_left = counts_of(JP_SKID_LEFT);
    sensors.encoder_right = counts_of(JP_SKID_RIGHT);
    sensors.current_left = current_of(JP_SKID_LEFT, skid.robot.internal.voltages.left);
    sensors.current_right = current_of(JP_SKID_RIGHT, skid.robot.internal.voltages.right);
    sensors.yaw_rate = jp_q24_multiply(jp_q24_multiply(ahead, config.wheels.turn_per_wheel), config.odometry.ratio);
}

static inline void give_sample(void)
{
    struct jp_can_frame frames[JP_SAMPLE_PARTS];

    move();
    jp_message_from_sensors(frames, &sample_counter, &sensors);
    for (int part = 0; part < JP_SAMPLE_PARTS; part++) {
        (void)jp_ecu_accept(&ecu, &frames[part]);
    }
}

static inline void run(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        give_sample();
        jp_ecu_tick(&ecu);
        jp_ecu_work(&ecu);
    }
}

/** The robot moves on. */
static inline void run_without_samples(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        move();
        jp_ecu_tick(&ecu);
        jp_ecu_work(&ecu);
    }
}

static inline void command(uint8_t mode, uint8_t route)
{
    const struct jp_can_frame frame = operator_command(++command_counter & 15U, mode, route);

    TEST_ASSERT_FALSE(jp_ecu_accept(&ecu, &frame));
}

/** For so many commands, 100 ms apart. */
static inline void hold(uint8_t mode, uint8_t route, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        command(mode, route);
        run(RATE / 10U);
    }
}

static inline void offer(uint8_t route, const struct jp_point *points, uint8_t length)
{
    struct jp_can_frame frame = route_offer(++offer_counter & 15U, route, length, route_crc(points, length));

    (void)jp_ecu_accept(&ecu, &frame);
    for (uint8_t i = 0; i < length; i++) {
        frame = waypoint(++waypoint_counter & 15U, points[i]);
        (void)jp_ecu_accept(&ecu, &frame);
        run(1);
    }
    run(1);
}

static inline uint16_t faults(void)
{
    struct jp_skid_telemetry telemetry;

    TEST_ASSERT_TRUE(jp_skid_robot_telemetry(&skid.robot, &telemetry));
    return telemetry.faults;
}

static inline void expect_state(enum jp_ecu_state state)
{
    TEST_ASSERT_EQUAL_INT(state, jp_ecu_state_now(&ecu));
}

static inline void expect_route(enum jp_route_state state, enum jp_route_reason reason)
{
    TEST_ASSERT_EQUAL_INT(state, ecu.internal.routes.state);
    TEST_ASSERT_EQUAL_INT(reason, ecu.internal.routes.reason);
}

static inline void expect_operator(enum jp_operator_state state, enum jp_operator_mode mode)
{
    TEST_ASSERT_EQUAL_INT(state, ecu.internal.operator_link.state);
    TEST_ASSERT_EQUAL_INT(mode, ecu.internal.operator_link.mode);
}

/** As EcuLosses tells it. */
static inline void expect_refused(uint8_t count, enum jp_refusal refusal)
{
    struct jp_can_ecu_losses_t losses;

    TEST_ASSERT_EQUAL_INT(0, jp_can_ecu_losses_unpack(&losses, bus.last[2], JP_CAN_LENGTH_MAX));
    TEST_ASSERT_EQUAL_UINT8(count, losses.rejected);
    TEST_ASSERT_EQUAL_UINT8(refusal, losses.stand_refusal);
}

/** The robot is at rest, and its reference is. */
static inline void expect_rest(void)
{
    TEST_ASSERT_EQUAL_INT32(0, skid.robot.internal.reference.speed);
    TEST_ASSERT_EQUAL_INT32(0, skid.robot.internal.reference.turn_rate);
}

static inline void make_standing(void)
{
    run(2U * JP_SKID_WAKE_TICKS);
    expect_state(JP_ECU_IDLE);
    command(JP_MODE_STAND, 0);
    hold(JP_MODE_STAND, 0, 1);
    expect_state(JP_ECU_STANDING);
    expect_operator(JP_OPERATOR_ALIVE, JP_MODE_STAND);
}

static const struct jp_point near_route[2] = {{JP_Q16(0.6), 0}, {JP_Q16(1), JP_Q16(0.4)}};

static inline void make_driving(void)
{
    make_standing();
    offer(7, near_route, 2);
    expect_route(JP_ROUTE_READY, JP_REASON_NONE);
    hold(JP_MODE_DRIVE, 7, 3);
    hold(JP_MODE_DRIVE, 7, 4);
    expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
    expect_state(JP_ECU_DRIVING);
}

#endif
