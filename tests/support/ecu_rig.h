/** The whole application on a bus, with an operator and a robot whose wheels are held. */
#ifndef JOULEPATH_TESTS_SUPPORT_ECU_RIG_H
#define JOULEPATH_TESTS_SUPPORT_ECU_RIG_H

#include <joulepath/tables.h>
#include <string.h>

#include "tests/support/ecu_start.h"

#include "hal/app/telemetry.h"
#include "tests/support/commands.h"

#include "unity.h"

/** The bus as the test sees it. */
struct bus {
    enum jp_status answer; /* of send() */
    enum jp_can_state state;
    struct jp_e2e_receiver receiver;
    struct jp_actuation actuation;
    unsigned commands; /* MotorCommands */
    unsigned this_tick;
    unsigned most_in_a_tick;
    uint8_t last[32][JP_CAN_LENGTH_MAX]; /* frames 0x180 to 0x19F */
    uint16_t counts[32];
};

static struct bus bus;
static struct jp_robot_config config;
static struct jp_ecu ecu;
static struct jp_ecu_balancer balancer;
static struct jp_retained retained;
static struct jp_sensors sensors;
static uint8_t sample_counter;
static uint8_t command_counter;
static uint8_t waypoint_counter;
static uint8_t offer_counter;

static inline enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    struct bus *to = context;

    to->this_tick++;
    if (to->answer != JP_OK) {
        return to->answer;
    }
    TEST_ASSERT_EQUAL_UINT8(8, frame->length);
    if (frame->id == JP_CAN_MOTOR_COMMAND_FRAME_ID) {
        const enum jp_e2e_result result = jp_message_to_actuation(&to->receiver, frame, &to->actuation);

        TEST_ASSERT_EQUAL_INT(to->commands == 0U ? JP_E2E_FIRST : JP_E2E_OK, result);
        to->commands++;
        return JP_OK;
    }
    TEST_ASSERT_EQUAL_HEX32(0x180, frame->id & ~0x1FU);
    memcpy(to->last[frame->id & 0x1FU], frame->data, JP_CAN_LENGTH_MAX);
    to->counts[frame->id & 0x1FU]++;
    return JP_OK;
}

static inline enum jp_can_state state_of(void *context)
{
    const struct bus *from = context;

    return from->state;
}

static const struct jp_can_port port = {&bus, send, state_of};

static inline void init(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK,
                          ecu_start(&ecu, &balancer, &config, &jp_energy_model_courier24, &port, &retained, &field));
}

static inline void start(uint32_t tick_rate)
{
    config = jp_robot_courier24;
    config.monitor.freeze_ticks = 0;
    config.estimator.tick_rate = tick_rate;
    config.reference.tick_rate = tick_rate;
    config.lqr.tick_rate = tick_rate;
    config.meter.tick_rate = tick_rate;
    config.trajectory.tick_rate = tick_rate;
    memset(&bus, 0, sizeof bus);
    memset(&retained, 0, sizeof retained);
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)};
    sample_counter = 0;
    command_counter = 0;
    waypoint_counter = 0;
    offer_counter = 0;
    init();
}

void setUp(void)
{
    start(1000);
}

void tearDown(void)
{
}

/** With the currents that belong to the robot's voltages, of wheels that are held. */
static inline void hold_wheels(void)
{
    const struct jp_voltages *voltages = &jp_robot_last_tick(&balancer.robot)->voltages;

    sensors.current_left = jp_q16_divide(voltages->left, config.monitor.motor_resistance);
    sensors.current_right = jp_q16_divide(voltages->right, config.monitor.motor_resistance);
}

static inline bool give_sample(void)
{
    struct jp_can_frame frames[JP_SAMPLE_PARTS];
    bool complete = false;

    hold_wheels();
    jp_message_from_sensors(frames, &sample_counter, &sensors);
    for (int part = 0; part < JP_SAMPLE_PARTS; part++) {
        TEST_ASSERT_FALSE(complete);
        complete = jp_ecu_accept(&ecu, &frames[part]);
    }
    return complete;
}

static inline void tick(void)
{
    bus.this_tick = 0;
    jp_ecu_tick(&ecu);
    TEST_ASSERT_LESS_OR_EQUAL_UINT(1U + JP_TELEMETRY_FRAMES_MAX, bus.this_tick);
    bus.most_in_a_tick = bus.this_tick > bus.most_in_a_tick ? bus.this_tick : bus.most_in_a_tick;
}

static inline void run(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        (void)give_sample();
        tick();
        jp_ecu_work(&ecu);
    }
}

static inline void run_without_samples(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        tick();
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
        run(config.estimator.tick_rate / 10U);
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

static inline void expect_state(enum jp_robot_state state)
{
    const bool on = state == JP_ROBOT_BALANCING || state == JP_ROBOT_DRIVING;

    TEST_ASSERT_EQUAL_INT(state, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_EQUAL_UINT8(on ? 1 : 0, bus.actuation.enabled);
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

static inline void make_balancing(void)
{
    run(3);
    expect_state(JP_ROBOT_IDLE);
    command(JP_MODE_STAND, 0);
    hold(JP_MODE_STAND, 0, 1);
    expect_state(JP_ROBOT_BALANCING);
    expect_operator(JP_OPERATOR_ALIVE, JP_MODE_STAND);
}

static const struct jp_point near_route[2] = {{JP_Q16(0.3), 0}, {JP_Q16(0.6), JP_Q16(0.1)}};

static inline void make_driving(void)
{
    make_balancing();
    offer(7, near_route, 2);
    expect_route(JP_ROUTE_READY, JP_REASON_NONE);
    hold(JP_MODE_DRIVE, 7, 3);
    expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
    expect_state(JP_ROBOT_DRIVING);
}

/** As EcuLosses tells it. */
static inline void expect_refused(uint8_t count, enum jp_refusal refusal)
{
    struct jp_can_ecu_losses_t losses;

    TEST_ASSERT_EQUAL_INT(0, jp_can_ecu_losses_unpack(&losses, bus.last[2], JP_CAN_LENGTH_MAX));
    TEST_ASSERT_EQUAL_UINT8(count, losses.rejected);
    TEST_ASSERT_EQUAL_UINT8(refusal, losses.stand_refusal);
}

#endif
