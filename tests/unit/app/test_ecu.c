/* The whole application on a bus: from idle over a route to its end, every frame it must not take, outages, a reset. */
#include <joulepath/tables.h>
#include <string.h>

#include "hal/app/ecu.h"

#include "hal/app/telemetry.h"
#include "tests/support/commands.h"

#include "unity.h"

/* The bus as the test sees it. */
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
static struct jp_retained retained;
static struct jp_sensors sensors;
static uint8_t sample_counter;
static uint8_t command_counter;
static uint8_t waypoint_counter;
static uint8_t offer_counter;

static enum jp_status send(void *context, const struct jp_can_frame *frame)
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

static enum jp_can_state state_of(void *context)
{
    const struct bus *from = context;

    return from->state;
}

static const struct jp_can_port port = {&bus, send, state_of};

static void init(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ecu_init(&ecu, &config, &jp_energy_model_courier24, &port, &retained, &field));
}

static void start(uint32_t tick_rate)
{
    config = jp_robot_courier24;
    config.monitor.freeze_ticks = 0;
    config.estimator.tick_rate = tick_rate;
    config.reference.tick_rate = tick_rate;
    config.lqr.tick_rate = tick_rate;
    config.meter.tick_rate = tick_rate;
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

/* A robot whose wheels are held, with the currents that belong to its voltages. */

static bool give_sample(void)
{
    const struct jp_voltages *voltages = &jp_robot_last_tick(&ecu.robot)->voltages;
    struct jp_can_frame frames[JP_SAMPLE_PARTS];
    bool complete = false;

    sensors.current_left = jp_q16_divide(voltages->left, config.monitor.motor_resistance);
    sensors.current_right = jp_q16_divide(voltages->right, config.monitor.motor_resistance);
    jp_message_from_sensors(frames, &sample_counter, &sensors);
    for (int part = 0; part < JP_SAMPLE_PARTS; part++) {
        TEST_ASSERT_FALSE(complete);
        complete = jp_ecu_accept(&ecu, &frames[part]);
    }
    return complete;
}

static void tick(void)
{
    bus.this_tick = 0;
    jp_ecu_tick(&ecu);
    TEST_ASSERT_LESS_OR_EQUAL_UINT(1U + JP_TELEMETRY_FRAMES_MAX, bus.this_tick);
    bus.most_in_a_tick = bus.this_tick > bus.most_in_a_tick ? bus.this_tick : bus.most_in_a_tick;
}

static void run(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        (void)give_sample();
        tick();
        jp_ecu_work(&ecu);
    }
}

static void run_without_samples(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        tick();
        jp_ecu_work(&ecu);
    }
}

static void command(uint8_t mode, uint8_t route)
{
    const struct jp_can_frame frame = operator_command(++command_counter & 15U, mode, route);

    TEST_ASSERT_FALSE(jp_ecu_accept(&ecu, &frame));
}

/* For so many commands, 100 ms apart. */
static void hold(uint8_t mode, uint8_t route, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        command(mode, route);
        run(config.estimator.tick_rate / 10U);
    }
}

static void offer(uint8_t route, const struct jp_point *points, uint8_t length)
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

static void expect_state(enum jp_robot_state state)
{
    const bool on = state == JP_ROBOT_BALANCING || state == JP_ROBOT_DRIVING;

    TEST_ASSERT_EQUAL_INT(state, jp_robot_state_now(&ecu.robot));
    TEST_ASSERT_EQUAL_UINT8(on ? 1 : 0, bus.actuation.enabled);
}

static void expect_route(enum jp_route_state state, enum jp_route_reason reason)
{
    TEST_ASSERT_EQUAL_INT(state, ecu.internal.routes.state);
    TEST_ASSERT_EQUAL_INT(reason, ecu.internal.routes.reason);
}

static void expect_operator(enum jp_operator_state state, enum jp_operator_mode mode)
{
    TEST_ASSERT_EQUAL_INT(state, ecu.internal.operator_link.state);
    TEST_ASSERT_EQUAL_INT(mode, ecu.internal.operator_link.mode);
}

static void make_balancing(void)
{
    run(3);
    expect_state(JP_ROBOT_IDLE);
    command(JP_MODE_STAND, 0);
    hold(JP_MODE_STAND, 0, 1);
    expect_state(JP_ROBOT_BALANCING);
    expect_operator(JP_OPERATOR_ALIVE, JP_MODE_STAND);
}

static const struct jp_point near_route[2] = {{JP_Q16(0.3), 0}, {JP_Q16(0.6), JP_Q16(0.1)}};

static void make_driving(void)
{
    make_balancing();
    offer(7, near_route, 2);
    expect_route(JP_ROUTE_READY, JP_REASON_NONE);
    hold(JP_MODE_DRIVE, 7, 3);
    expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
    expect_state(JP_ROBOT_DRIVING);
}

/* As EcuLosses tells it. */
static void expect_refused(uint8_t count, enum jp_refusal refusal)
{
    struct jp_can_ecu_losses_t losses;

    TEST_ASSERT_EQUAL_INT(0, jp_can_ecu_losses_unpack(&losses, bus.last[2], JP_CAN_LENGTH_MAX));
    TEST_ASSERT_EQUAL_UINT8(count, losses.rejected);
    TEST_ASSERT_EQUAL_UINT8(refusal, losses.stand_refusal);
}

/* Start */

static void test_init_refuses_what_jp_robot_init_does(void)
{
    const struct jp_energy_model *model = &jp_energy_model_courier24;
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_init(NULL, &config, model, &port, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_init(&ecu, NULL, model, &port, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_init(&ecu, &config, NULL, &port, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_init(&ecu, &config, model, NULL, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_init(&ecu, &config, model, &port, NULL, NULL));
    config.monitor.tilt_limit = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_ecu_init(&ecu, &config, model, &port, NULL, &field));
    TEST_ASSERT_EQUAL_STRING("monitor.tilt_limit", field);
}

static void test_before_the_first_sample_it_only_reports(void)
{
    run_without_samples(1000);
    TEST_ASSERT_EQUAL_UINT(0, bus.commands);
    TEST_ASSERT_EQUAL_UINT16(10, bus.counts[0]);
    TEST_ASSERT_EQUAL_UINT16(50, bus.counts[4]);
    TEST_ASSERT_EQUAL_HEX16(0, jp_robot_last_tick(&ecu.robot)->faults);
    TEST_ASSERT_EQUAL_UINT16(0, jp_ecu_lost_samples(&ecu));
    TEST_ASSERT_NULL(jp_retained_newest(&retained));
}

static void test_the_tick_may_begin_when_a_sample_is_complete(void)
{
    TEST_ASSERT_FALSE(give_sample()); /* the first is not used */
    TEST_ASSERT_TRUE(give_sample());
    TEST_ASSERT_FALSE(give_sample()); /* the one before still waits */
    tick();
    TEST_ASSERT_TRUE(give_sample());
}

static void test_works_without_retained_memory(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ecu_init(&ecu, &config, &jp_energy_model_courier24, &port, NULL, &field));
    make_balancing();
    TEST_ASSERT_EQUAL_UINT32(0, ecu.resets);
}

/* The way of a route */

static void test_from_idle_over_a_route_to_its_end(void)
{
    make_driving();
    for (int i = 0; i < 100 && ecu.internal.routes.state == JP_ROUTE_DRIVING; i++) {
        hold(JP_MODE_DRIVE, 7, 1);
    }
    expect_route(JP_ROUTE_DONE, JP_REASON_NONE);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(2, jp_robot_last_tick(&ecu.robot)->segments_ended);
    for (unsigned kind = 0xA; kind <= 0xD; kind++) { /* plan and result of each segment */
        TEST_ASSERT_EQUAL_UINT16(2, bus.counts[kind]);
        TEST_ASSERT_EQUAL_UINT8(2, bus.last[kind][0]);
    }
    TEST_ASSERT_EQUAL_UINT8(7, bus.last[3][0]);
    TEST_ASSERT_EQUAL_UINT8(JP_ROUTE_DONE, bus.last[3][1]);
    hold(JP_MODE_DRIVE, 7, 5); /* driven once */
    expect_state(JP_ROBOT_BALANCING);
    hold(JP_MODE_OFF, 0, 3);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_HEX16(0, jp_robot_last_tick(&ecu.robot)->faults);
    TEST_ASSERT_LESS_OR_EQUAL_UINT(4, bus.most_in_a_tick);
}

static void test_status_frames_show_what_is_so(void)
{
    make_driving();
    TEST_ASSERT_EQUAL_HEX8(JP_ROBOT_DRIVING | JP_MODE_DRIVE << 3 | JP_OPERATOR_ALIVE << 5, bus.last[0][0]);
    TEST_ASSERT_EQUAL_HEX8(JP_ROUTE_DRIVING, bus.last[3][1]);
}

static void test_stand_stops_a_route(void)
{
    make_driving();
    command(JP_MODE_STAND, 0);
    run(2);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_COMMAND);
    expect_state(JP_ROBOT_BALANCING);
    hold(JP_MODE_DRIVE, 7, 5); /* a stopped route is not taken up again */
    expect_state(JP_ROBOT_BALANCING);
}

static void test_stand_of_a_second_node_stops_a_route(void)
{
    const uint8_t others = (uint8_t)(3U + JP_E2E_GAP_MAX);
    struct jp_can_frame frame;

    make_driving();
    frame = operator_command((command_counter + others) & 15U, JP_MODE_STAND, 0);
    (void)jp_ecu_accept(&ecu, &frame);
    command(JP_MODE_DRIVE, 7);
    run(2);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_COMMAND);
    expect_state(JP_ROBOT_BALANCING);
    hold(JP_MODE_DRIVE, 7, 5);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_off_switches_off_from_driving(void)
{
    make_driving();
    command(JP_MODE_OFF, 0);
    command(JP_MODE_OFF, 0);
    run(3);
    expect_state(JP_ROBOT_DRIVING);
    command(JP_MODE_OFF, 0);
    run(3);
    expect_state(JP_ROBOT_IDLE);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_SWITCHED_OFF);
}

static void test_a_fall_ends_the_route(void)
{
    make_driving();
    ecu.robot.internal.estimator.pitch = JP_PHASE_TURN / 8;
    run(2);
    expect_state(JP_ROBOT_FALLEN);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_SWITCHED_OFF);
    hold(JP_MODE_STAND, 0, 3);
    expect_state(JP_ROBOT_FALLEN);
    expect_refused(3, JP_REFUSAL_FALLEN);
    hold(JP_MODE_OFF, 0, 3);
    ecu.robot.internal.estimator.pitch = JP_PHASE_TURN / 8;
    hold(JP_MODE_STAND, 0, 1);
    expect_state(JP_ROBOT_IDLE);
    expect_refused(4, JP_REFUSAL_NOT_UPRIGHT);
    ecu.robot.internal.estimator.pitch = 0;
    hold(JP_MODE_STAND, 0, 2);
    expect_state(JP_ROBOT_BALANCING);
    expect_refused(4, JP_REFUSAL_NONE);
}

static void test_the_next_route_is_received_while_one_is_driven(void)
{
    static const struct jp_point other = {JP_Q16(0.5), 0};

    make_driving();
    offer(8, &other, 1);
    expect_route(JP_ROUTE_READY, JP_REASON_NONE);
    expect_state(JP_ROBOT_DRIVING);
    TEST_ASSERT_EQUAL_UINT8(7, ecu.internal.routes.driven.id);
    hold(JP_MODE_DRIVE, 8, 3);
    expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT8(8, ecu.internal.routes.driven.id);
    for (int i = 0; i < 100 && ecu.internal.routes.state == JP_ROUTE_DRIVING; i++) {
        hold(JP_MODE_DRIVE, 8, 1);
    }
    expect_route(JP_ROUTE_DONE, JP_REASON_NONE);
}

static void test_a_goal_is_driven_to_and_changed_on_the_way(void)
{
    static const struct jp_point first = {JP_Q16(0.3), 0};
    static const struct jp_point second = {0, JP_Q16(0.3)};
    struct jp_can_frame frame;
    uint8_t goals = 0;

    make_balancing();
    for (unsigned i = 0; i < 150 && ecu.internal.routes.state != JP_ROUTE_DONE; i++) {
        frame = goal(++goals & 15U, i < 8U ? first : second);
        (void)jp_ecu_accept(&ecu, &frame);
        hold(JP_MODE_DRIVE, JP_ROUTE_GOAL, 1);
        if (i >= 3U && i < 8U) {
            TEST_ASSERT_EQUAL_INT32(first.x, ecu.internal.routes.driven.points[0].x);
        }
        if (i >= 8U) {
            TEST_ASSERT_EQUAL_INT32(second.y, ecu.internal.routes.driven.points[0].y);
        }
    }
    expect_route(JP_ROUTE_DONE, JP_REASON_NONE);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_a_route_that_cannot_be_planned_stops_with_the_reason(void)
{
    static const struct jp_point here = {0, 0};

    make_balancing();
    offer(7, &here, 1);
    hold(JP_MODE_DRIVE, 7, 3);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_PLAN);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_INT8(JP_ERR_ZERO_LENGTH, (int8_t)bus.last[3][6]);
}

static void test_a_late_plan_is_not_the_end_of_the_route(void)
{
    make_driving();
    for (int i = 0; i < 10000 && jp_robot_state_now(&ecu.robot) == JP_ROBOT_DRIVING; i++) {
        (void)give_sample(); /* the background is busy */
        tick();
    }
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(1, jp_robot_last_tick(&ecu.robot)->segments_ended);
    ecu.internal.worked_tick = ecu.tick; /* not so long that the operator counts as lost */
    jp_ecu_work(&ecu);
    expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
    run(2);
    expect_state(JP_ROBOT_DRIVING);
    for (int i = 0; i < 100 && ecu.internal.routes.state == JP_ROUTE_DRIVING; i++) {
        hold(JP_MODE_DRIVE, 7, 1);
    }
    expect_route(JP_ROUTE_DONE, JP_REASON_NONE);
}

/* The operator's silence */

static void test_silence_stops_a_driving_robot_within_500_ms(void)
{
    make_driving();
    command(JP_MODE_DRIVE, 7);
    run(498);
    expect_operator(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
    expect_state(JP_ROBOT_DRIVING);
    run(3);
    expect_operator(JP_OPERATOR_LOST, JP_MODE_STAND);
    expect_state(JP_ROBOT_BALANCING);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_TIMEOUT);
    TEST_ASSERT_EQUAL_UINT8(1, ecu.operator_timeouts);
    run(2000);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT8(1, ecu.operator_timeouts);
}

static void test_after_a_silence_only_stand_and_then_drive_set_it_moving(void)
{
    static const struct jp_point other = {JP_Q16(0.5), 0};

    make_driving();
    run(600);
    offer(8, &other, 1);
    hold(JP_MODE_DRIVE, 8, 10);
    expect_state(JP_ROBOT_BALANCING);
    expect_route(JP_ROUTE_READY, JP_REASON_NONE);
    command(JP_MODE_STAND, 0);
    hold(JP_MODE_DRIVE, 8, 3);
    expect_state(JP_ROBOT_DRIVING);
}

static void test_a_lost_operator_does_not_switch_an_idle_robot_on(void)
{
    make_balancing();
    run(600);
    expect_operator(JP_OPERATOR_LOST, JP_MODE_STAND);
    jp_robot_disable(&ecu.robot);
    run(100);
    expect_state(JP_ROBOT_IDLE);
}

static void test_a_fault_stays_until_the_operator_switches_off(void)
{
    run(3);
    sensors.bus_voltage = 0;
    run(10);
    sensors.bus_voltage = JP_Q16(24);
    expect_state(JP_ROBOT_FAULT);
    run(1000); /* nobody is there */
    expect_state(JP_ROBOT_FAULT);
    expect_refused(0, JP_REFUSAL_NONE);
    hold(JP_MODE_STAND, 0, 3); /* the first command is not obeyed */
    expect_state(JP_ROBOT_FAULT);
    expect_refused(2, JP_REFUSAL_FAULT);
    TEST_ASSERT_EQUAL_HEX8(JP_FAULT_BUS_VOLTAGE, bus.last[1][0]);
    hold(JP_MODE_OFF, 0, 4);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_HEX8(0, bus.last[1][0]);
}

/* Frames that must not be taken */

static void give(uint32_t id, uint8_t length)
{
    const struct jp_can_frame frame = {.id = id, .length = length};

    TEST_ASSERT_FALSE(jp_ecu_accept(&ecu, &frame));
}

static void test_unknown_remote_and_extended_frames_are_counted(void)
{
    static const uint32_t known[] = {0x10, 0x20, 0x21, 0x22, 0x100, 0x101, 0x102, 0x103, 0x180, 0x18E, 0x190, 0x193};
    uint16_t count = 0;

    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        give(known[i] | JP_CAN_REMOTE, 8);
        give(known[i] | JP_CAN_EXTENDED, 8);
        give(known[i] | JP_CAN_EXTENDED | JP_CAN_REMOTE, 8);
        count = (uint16_t)(count + 3U);
        TEST_ASSERT_EQUAL_UINT16(count, ecu.unknown_frames);
    }
    give(0x000, 8);
    give(0x7FF, 0);
    give(0x194, 8);
    TEST_ASSERT_EQUAL_UINT16(count + 3U, ecu.unknown_frames);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.sample_counts.malformed);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.conflicts);
    ecu.unknown_frames = UINT16_MAX;
    give(0x000, 8);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, ecu.unknown_frames);
}

static void test_wrong_lengths_are_counted(void)
{
    static const struct {
        uint32_t id;
        uint8_t length;
    } known[] = {{0x10, 8},  {0x20, 8},  {0x21, 8},  {0x22, 8}, {0x100, 4},
                 {0x101, 8}, {0x102, 8}, {0x103, 8}, {0x180, 8}};
    uint8_t count = 0;

    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        for (uint8_t length = 0; length <= 8; length++) {
            if (length != known[i].length) {
                give(known[i].id, length);
                count++;
            }
            TEST_ASSERT_EQUAL_UINT8(count, ecu.sample_counts.malformed);
        }
    }
    TEST_ASSERT_EQUAL_UINT8(0, ecu.internal.queue_head);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.internal.samples.parts);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.conflicts);
    ecu.sample_counts.malformed = UINT8_MAX;
    give(0x20, 0);
    TEST_ASSERT_EQUAL_UINT8(UINT8_MAX, ecu.sample_counts.malformed);
}

static void test_frames_of_others_are_neither_taken_nor_counted(void)
{
    give(JP_CAN_BATTERY_STATUS_FRAME_ID, 8);
    TEST_ASSERT_EQUAL_UINT16(0, ecu.unknown_frames);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.conflicts);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.internal.queue_head);
}

static void test_frames_with_its_own_ids_are_conflicts(void)
{
    give(JP_CAN_MOTOR_COMMAND_FRAME_ID, 8);
    for (uint32_t id = 0x180; id <= 0x18E; id++) {
        give(id, 8);
    }
    TEST_ASSERT_EQUAL_UINT8(16, ecu.conflicts);
    TEST_ASSERT_EQUAL_UINT16(0, ecu.unknown_frames);
    ecu.conflicts = UINT8_MAX;
    give(JP_CAN_ECU_STATUS_FRAME_ID, 8);
    TEST_ASSERT_EQUAL_UINT8(UINT8_MAX, ecu.conflicts);
}

static void test_off_withdraws_a_stand_that_the_tick_has_not_seen(void)
{
    run(3);
    hold(JP_MODE_OFF, 0, 3);
    command(JP_MODE_STAND, 0);
    jp_ecu_work(&ecu);
    for (unsigned i = 0; i < JP_OPERATOR_CONFIRMATIONS; i++) {
        command(JP_MODE_OFF, 0);
    }
    jp_ecu_work(&ecu);
    jp_ecu_tick(&ecu);
    expect_state(JP_ROBOT_IDLE);
}

static void test_the_bridges_are_left_to_another_controller(void)
{
    unsigned commands;

    run(3);
    give(JP_CAN_MOTOR_COMMAND_FRAME_ID, 8);
    commands = bus.commands;
    run(499);
    TEST_ASSERT_EQUAL_UINT(commands, bus.commands);
    run(1);
    TEST_ASSERT_EQUAL_UINT(commands + 1U, bus.commands);
}

static void test_bridges_of_its_own_are_not_left_to_another_controller(void)
{
    unsigned commands;

    run(3);
    hold(JP_MODE_STAND, 0, 4);
    expect_state(JP_ROBOT_BALANCING);
    give(JP_CAN_MOTOR_COMMAND_FRAME_ID, 8);
    commands = bus.commands;
    run(10);
    TEST_ASSERT_EQUAL_UINT(commands + 10U, bus.commands);
    hold(JP_MODE_OFF, 0, 5);
    expect_state(JP_ROBOT_IDLE);
    commands = bus.commands;
    run(10);
    TEST_ASSERT_EQUAL_UINT(commands + 10U, bus.commands);
}

static void test_beside_another_controller_the_robot_does_not_stand_up(void)
{
    run(3);
    hold(JP_MODE_STAND, 0, 1); /* the first command is not obeyed */
    give(JP_CAN_MOTOR_COMMAND_FRAME_ID, 8);
    hold(JP_MODE_STAND, 0, 4);
    expect_operator(JP_OPERATOR_ALIVE, JP_MODE_STAND);
    expect_state(JP_ROBOT_IDLE);
    /* Each command is refused once, however many slices of work it stays. */
    expect_refused(4, JP_REFUSAL_CONFLICT);
    give(JP_CAN_MOTOR_COMMAND_FRAME_ID, 8); /* it is still there */
    command(JP_MODE_STAND, 0);
    run(499);
    expect_state(JP_ROBOT_IDLE);
    command(JP_MODE_STAND, 0);
    run(2);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_another_controller_does_not_switch_a_standing_robot_off(void)
{
    make_balancing();
    give(JP_CAN_MOTOR_COMMAND_FRAME_ID, 8);
    hold(JP_MODE_STAND, 0, 2);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_corrupt_commands_and_samples_are_counted(void)
{
    struct jp_can_frame frames[JP_SAMPLE_PARTS];
    struct jp_can_frame frame = operator_command(1, JP_MODE_STAND, 0);

    run(2);
    frame.data[2] ^= 1U;
    (void)jp_ecu_accept(&ecu, &frame);
    frame = route_offer(1, 7, 1, 0);
    frame.data[7] ^= 1U;
    (void)jp_ecu_accept(&ecu, &frame);
    run(1);
    TEST_ASSERT_EQUAL_UINT8(2, ecu.operator_counts.crc_errors);
    jp_message_from_sensors(frames, &sample_counter, &sensors);
    frames[0].data[7] ^= 1U;
    for (int part = 0; part < JP_SAMPLE_PARTS; part++) {
        (void)jp_ecu_accept(&ecu, &frames[part]);
    }
    TEST_ASSERT_EQUAL_UINT8(1, ecu.sample_counts.crc_errors);
    command(3, 0);
    command(3, 0);
    run(1);
    TEST_ASSERT_EQUAL_UINT8(1, ecu.operator_counts.malformed);
    command_counter--;
    command(JP_MODE_STAND, 0);
    run(1);
    TEST_ASSERT_EQUAL_UINT8(1, ecu.operator_counts.sequence_errors);
}

static void test_a_flood_of_commands_overflows_the_queue_and_nothing_else(void)
{
    run(2);
    for (unsigned i = 0; i < JP_ECU_QUEUE + 8U; i++) {
        command(JP_MODE_STAND, 0);
    }
    TEST_ASSERT_EQUAL_UINT8(9, ecu.sample_counts.rejected); /* one place always stays free */
    jp_ecu_work(&ecu);
    TEST_ASSERT_EQUAL_UINT8(ecu.internal.queue_head, ecu.internal.queue_tail);
    hold(JP_MODE_STAND, 0, 3);
    expect_state(JP_ROBOT_BALANCING);
    for (unsigned i = 0; i < 400; i++) {
        command(JP_MODE_DRIVE, 9);
    }
    TEST_ASSERT_EQUAL_UINT8(UINT8_MAX, ecu.sample_counts.rejected);
    run(10);
    expect_state(JP_ROBOT_BALANCING);
}

/* Outages */

static void test_samples_may_stay_away_for_the_hold_ticks(void)
{
    make_balancing();
    for (int i = 0; i < 5; i++) {
        run_without_samples(JP_SAMPLE_HOLD_TICKS);
        expect_state(JP_ROBOT_BALANCING);
        run(50);
        expect_state(JP_ROBOT_BALANCING);
    }
    TEST_ASSERT_EQUAL_UINT16(5U * JP_SAMPLE_HOLD_TICKS, jp_ecu_lost_samples(&ecu));
    TEST_ASSERT_EQUAL_HEX16(0, jp_robot_last_tick(&ecu.robot)->faults);
}

static void test_samples_that_stay_away_longer_are_a_fault(void)
{
    make_balancing();
    run_without_samples(JP_SAMPLE_HOLD_TICKS + config.monitor.confirm_ticks - 1U);
    expect_state(JP_ROBOT_BALANCING);
    run_without_samples(1);
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, jp_robot_last_tick(&ecu.robot)->faults);
    hold(JP_MODE_STAND, 0, 3);
    expect_state(JP_ROBOT_FAULT);
    hold(JP_MODE_OFF, 0, 3);
    expect_state(JP_ROBOT_IDLE);
    hold(JP_MODE_STAND, 0, 1);
    expect_state(JP_ROBOT_BALANCING);
}

/* Nothing is held over a fault that was cleared: the robot may have been carried elsewhere. */
static void test_samples_that_come_back_after_off_are_taken_as_they_are(void)
{
    sensors.encoder_left = 100000;
    sensors.encoder_right = 90000;
    make_balancing();
    run_without_samples(200);
    expect_state(JP_ROBOT_FAULT);
    for (int i = 0; i < 3; i++) {
        command(JP_MODE_OFF, 0);
        run_without_samples(100);
    }
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, jp_robot_state_now(&ecu.robot));
    sensors.encoder_left += 5000;
    run(1);
    TEST_ASSERT_EQUAL_UINT32(105000, ecu.robot.internal.estimator.encoder_left);
    TEST_ASSERT_EQUAL_UINT32(90000, ecu.robot.internal.estimator.encoder_right);
    run(100);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_HEX16(0, jp_robot_last_tick(&ecu.robot)->faults);
    TEST_ASSERT_EQUAL_INT32(0, jp_robot_last_tick(&ecu.robot)->motion.wheel_rate);
}

static void check_refusals(enum jp_status answer)
{
    setUp();
    make_balancing();
    bus.answer = answer;
    run(JP_SAMPLE_HOLD_TICKS);
    bus.answer = JP_OK;
    bus.commands = 0; /* the receiver at the other end begins anew */
    bus.receiver = (struct jp_e2e_receiver){.synchronised = false};
    TEST_ASSERT_GREATER_OR_EQUAL_UINT16(JP_SAMPLE_HOLD_TICKS, ecu.send_errors);
    run(100);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_HEX16(0, jp_robot_last_tick(&ecu.robot)->faults);

    bus.answer = answer;
    run(JP_SAMPLE_HOLD_TICKS + config.monitor.confirm_ticks);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&ecu.robot));
    run(1); /* what was not written shows in the tick after */
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_FAULT, jp_robot_state_now(&ecu.robot));
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, jp_robot_last_tick(&ecu.robot)->faults);
}

static void test_the_bus_may_refuse_frames_for_the_hold_ticks_and_longer_is_a_fault(void)
{
    check_refusals(JP_ERR_BUSY);
    check_refusals(JP_ERR_HARDWARE);
}

static void test_send_errors_saturate(void)
{
    ecu.send_errors = UINT16_MAX;
    bus.answer = JP_ERR_BUSY;
    run(10);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, ecu.send_errors);
}

static void test_each_bus_off_is_counted_once(void)
{
    for (uint8_t i = 1; i <= 3; i++) {
        bus.state = JP_CAN_BUS_OFF;
        run(5);
        TEST_ASSERT_EQUAL_UINT8(i, ecu.bus_offs);
        bus.state = JP_CAN_ON;
        run(5);
        TEST_ASSERT_EQUAL_UINT8(i, ecu.bus_offs);
    }
    bus.state = JP_CAN_DOWN;
    run(5);
    TEST_ASSERT_EQUAL_UINT8(3, ecu.bus_offs);
    ecu.bus_offs = UINT8_MAX;
    bus.state = JP_CAN_BUS_OFF;
    run(5);
    TEST_ASSERT_EQUAL_UINT8(UINT8_MAX, ecu.bus_offs);
}

/* A reset */

static void reset(void)
{
    bus.commands = 0;
    bus.receiver = (struct jp_e2e_receiver){.synchronised = false};
    bus.actuation = (struct jp_actuation){0, 0, 0};
    init();
}

static void test_a_reset_in_motion_balances_from_the_first_sample_on(void)
{
    struct jp_point position;

    make_driving();
    position = jp_robot_position(&ecu.robot);
    reset();
    TEST_ASSERT_EQUAL_UINT32(1, ecu.resets);
    expect_operator(JP_OPERATOR_LOST, JP_MODE_STAND);
    run_without_samples(10);
    TEST_ASSERT_EQUAL_UINT(0, bus.commands);
    (void)give_sample();
    TEST_ASSERT_TRUE(give_sample());
    tick();
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&ecu.robot));
    TEST_ASSERT_EQUAL_UINT(1, bus.commands);
    TEST_ASSERT_INT32_WITHIN(8, position.x, jp_robot_position(&ecu.robot).x);
    TEST_ASSERT_INT32_WITHIN(8, position.y, jp_robot_position(&ecu.robot).y);
    run(1000);
    expect_state(JP_ROBOT_BALANCING);
    expect_operator(JP_OPERATOR_LOST, JP_MODE_STAND);
    TEST_ASSERT_EQUAL_HEX8(JP_ROBOT_BALANCING | JP_MODE_STAND << 3 | JP_OPERATOR_LOST << 5, bus.last[0][0]);
    TEST_ASSERT_EQUAL_UINT8(1, bus.last[0][1]);
}

static void test_after_a_reset_drive_needs_a_stand(void)
{
    make_driving();
    reset();
    run(3);
    offer(7, near_route, 2);
    hold(JP_MODE_DRIVE, 7, 10);
    expect_operator(JP_OPERATOR_LOST, JP_MODE_STAND);
    expect_state(JP_ROBOT_BALANCING);
    command(JP_MODE_STAND, 0);
    hold(JP_MODE_DRIVE, 7, 3);
    expect_operator(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
    expect_state(JP_ROBOT_DRIVING);
}

static void test_after_a_reset_off_is_obeyed(void)
{
    make_balancing();
    reset();
    run(3);
    expect_state(JP_ROBOT_BALANCING);
    hold(JP_MODE_OFF, 0, 4);
    expect_state(JP_ROBOT_IDLE);
}

static void test_a_reset_in_idle_stays_idle(void)
{
    run(10);
    reset();
    run(10);
    expect_state(JP_ROBOT_IDLE);
    expect_operator(JP_OPERATOR_NONE, JP_MODE_OFF);
    TEST_ASSERT_EQUAL_UINT32(1, ecu.resets);
}

static void test_resets_are_counted(void)
{
    for (uint32_t i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_UINT32(i, ecu.resets);
        run(3);
        reset();
    }
}

static void test_after_loss_of_power_nothing_goes_on(void)
{
    make_driving();
    memset(&retained, 0xA5, sizeof retained);
    reset();
    run(10);
    expect_state(JP_ROBOT_IDLE);
    expect_operator(JP_OPERATOR_NONE, JP_MODE_OFF);
    TEST_ASSERT_EQUAL_UINT32(0, ecu.resets);
}

/* Writes what the robot would, but for one thing, and resets; true when the controller goes on from it. */
static bool goes_on_from(void (*change)(struct jp_snapshot *))
{
    static struct jp_snapshot snapshot;
    bool balancing;

    setUp();
    make_balancing();
    jp_robot_snapshot(&ecu.robot, &snapshot);
    change(&snapshot);
    jp_retained_write(&retained, &snapshot, 4);
    reset();
    TEST_ASSERT_EQUAL_UINT32(5, ecu.resets);
    run(3);
    balancing = jp_robot_state_now(&ecu.robot) == JP_ROBOT_BALANCING;
    expect_operator(balancing ? JP_OPERATOR_LOST : JP_OPERATOR_NONE, balancing ? JP_MODE_STAND : JP_MODE_OFF);
    expect_state(balancing ? JP_ROBOT_BALANCING : JP_ROBOT_IDLE);
    return balancing;
}

static void nothing(struct jp_snapshot *snapshot)
{
    (void)snapshot;
}

static void other_wheels(struct jp_snapshot *snapshot)
{
    snapshot->odometry.metres_per_turn++;
}

static void other_tick_rate(struct jp_snapshot *snapshot)
{
    snapshot->estimator.phase_per_rate *= 2;
}

static void wild_bias(struct jp_snapshot *snapshot)
{
    snapshot->estimator.gyro_bias = INT64_MIN;
}

static void wild_position(struct jp_snapshot *snapshot)
{
    snapshot->odometry.y = INT64_MAX;
}

static void no_bool(struct jp_snapshot *snapshot)
{
    memset(&snapshot->balancing, 2, sizeof snapshot->balancing);
}

static void test_only_a_record_that_can_be_this_robots_is_taken_up(void)
{
    TEST_ASSERT_TRUE(goes_on_from(nothing));
    TEST_ASSERT_FALSE(goes_on_from(other_wheels));
    TEST_ASSERT_FALSE(goes_on_from(other_tick_rate));
    TEST_ASSERT_FALSE(goes_on_from(wild_bias));
    TEST_ASSERT_FALSE(goes_on_from(wild_position));
    TEST_ASSERT_FALSE(goes_on_from(no_bool));
}

/* The bits of a sample hold a part of the count: one wheel is beyond it, the other is not. */
static void test_a_reset_keeps_pose_beyond_the_range_of_a_sample(void)
{
    const uint32_t far = 3U << (JP_SAMPLE_COUNT_BITS - 1U);
    struct jp_telemetry before;

    jp_sample_link_resume(&ecu.internal.samples, far, 0);
    sensors.encoder_left = far;
    make_balancing();
    TEST_ASSERT_EQUAL_UINT32(far, ecu.robot.internal.estimator.encoder_left);
    jp_robot_telemetry(&ecu.robot, &before);
    reset();
    run(3);
    TEST_ASSERT_EQUAL_UINT32(far, ecu.robot.internal.estimator.encoder_left);
    TEST_ASSERT_EQUAL_INT32(before.position.x, jp_robot_position(&ecu.robot).x);
    TEST_ASSERT_EQUAL_UINT64(before.motion.yaw, jp_robot_last_tick(&ecu.robot)->motion.yaw);
}

/* Learning */

#define LEARNED        0x12
#define LEARNER_STATUS 0x13

static struct jp_ecu_learning learning;
static struct jp_learned_state state;

static struct jp_can_learner_status_t learner_status(void)
{
    struct jp_can_learner_status_t signals;

    TEST_ASSERT_EQUAL_INT(0, jp_can_learner_status_unpack(&signals, bus.last[LEARNER_STATUS], JP_CAN_LENGTH_MAX));
    return signals;
}

static struct jp_can_learned_t learned(void)
{
    struct jp_can_learned_t signals;

    TEST_ASSERT_EQUAL_INT(0, jp_can_learned_unpack(&signals, bus.last[LEARNED], JP_CAN_LENGTH_MAX));
    return signals;
}

static void learn(enum jp_stored stored)
{
    const char *field = "";

    learning = (struct jp_ecu_learning){
        .horizon = &jp_horizon_courier24, .learning = &jp_learning_courier24, .stored = stored, .state = &state};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ecu_learn(&ecu, &learning, &field));
}

static void drive_route(uint8_t route)
{
    offer(route, near_route, 2);
    for (int i = 0; i < 100 && (i < 5 || ecu.internal.routes.state == JP_ROUTE_DRIVING); i++) {
        hold(JP_MODE_DRIVE, route, 1);
    }
    expect_route(JP_ROUTE_DONE, JP_REASON_NONE);
}

static void test_tables_out_of_range_are_refused_by_name(void)
{
    const char *field = "";
    struct jp_learning bad_learning = jp_learning_courier24;
    struct jp_horizon bad_horizon = jp_horizon_courier24;
    struct jp_ecu_learning bad = {.horizon = &bad_horizon, .learning = &bad_learning};

    bad_learning.identity = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_ecu_learn(&ecu, &bad, &field));
    TEST_ASSERT_EQUAL_STRING("learning.identity", field);
    bad_learning.identity = 1;
    bad_horizon.duration_min = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_ecu_learn(&ecu, &bad, &field));
    TEST_ASSERT_EQUAL_STRING("horizon.duration_min", field);
    bad.learning = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_learn(&ecu, &bad, &field));
    TEST_ASSERT_NULL(jp_ecu_learned_state(&ecu));
    bad.learning = &bad_learning;
    bad.stored = JP_STORED_TAKEN;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_learn(&ecu, &bad, &field));
    bad.stored = JP_STORED_NOTHING;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_learn(&ecu, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_learn(NULL, &bad, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_learn(&ecu, &bad, NULL));
    TEST_ASSERT_EQUAL_PTR(&jp_energy_model_courier24, jp_robot_model(&ecu.robot));
    bad.horizon = NULL;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ecu_learn(&ecu, &bad, &field));
}

static void test_without_tables_nothing_is_learned_or_told(void)
{
    make_balancing();
    drive_route(7);
    TEST_ASSERT_EQUAL_UINT16(0, bus.counts[LEARNED]);
    TEST_ASSERT_EQUAL_UINT16(0, bus.counts[LEARNER_STATUS]);
    TEST_ASSERT_NULL(jp_ecu_learned_state(&ecu));
}

static void test_what_was_learned_is_told_every_second(void)
{
    learn(JP_STORED_NOTHING);
    run(10000);
    TEST_ASSERT_UINT_WITHIN(1, 10, bus.counts[LEARNED]);
    TEST_ASSERT_UINT_WITHIN(1, 10, bus.counts[LEARNER_STATUS]);
    TEST_ASSERT_LESS_OR_EQUAL_UINT(3, bus.most_in_a_tick);
    TEST_ASSERT_EQUAL_UINT16(4096, learned().friction);
    TEST_ASSERT_EQUAL_INT16(0, learned().payload);
    TEST_ASSERT_EQUAL_UINT16(0, learner_status().version);
    TEST_ASSERT_EQUAL_UINT8(JP_STORED_NOTHING, learner_status().stored);
}

/* Its wheels are held: what is learned is nonsense, but learned it is. */
static void test_each_segment_of_a_route_is_taken_and_told(void)
{
    jp_q16 friction;
    jp_q16 payload;

    learn(JP_STORED_NOTHING);
    make_driving();
    for (uint16_t segment = 1; segment <= 2; segment++) {
        while (jp_robot_last_tick(&ecu.robot)->segments_ended < segment) {
            hold(JP_MODE_DRIVE, 7, 1);
        }
        run(5);
        TEST_ASSERT_EQUAL_UINT32(segment, ecu.watch.learned_from + ecu.watch.left_out);
        TEST_ASSERT_EQUAL_UINT32(segment, ecu.internal.segments_told);
    }
    TEST_ASSERT_EQUAL_UINT16(ecu.learner.state.version, learner_status().version);
    TEST_ASSERT_EQUAL_UINT8(ecu.watch.left_out, learner_status().left_out);
    TEST_ASSERT_EQUAL_UINT8(ecu.watch.evidence, learner_status().evidence);
    TEST_ASSERT_EQUAL_PTR(&ecu.learner.state, jp_ecu_learned_state(&ecu));
    jp_learner_causes(&ecu.learner, &friction, &payload);
    TEST_ASSERT_INT_WITHIN(1, friction >> 4, learned().friction);
}

/* Of one segment nothing is lost while frames of the report before wait. */
static void test_a_report_waits_for_the_one_before(void)
{
    learn(JP_STORED_NOTHING);
    make_balancing();
    ecu.internal.learned.frames_left = 2;
    ecu.internal.told_tick = ecu.tick - 2000U;
    ecu.learner.state.version = 9;
    jp_ecu_work(&ecu);
    TEST_ASSERT_EQUAL_UINT32(0, ecu.internal.learned.version);
    tick();
    tick();
    jp_ecu_work(&ecu);
    TEST_ASSERT_EQUAL_UINT32(9, ecu.internal.learned.version);
    TEST_ASSERT_EQUAL_UINT8(2, ecu.internal.learned.frames_left);
}

static void expect_model(const struct jp_energy_model *expected)
{
    TEST_ASSERT_EQUAL_MEMORY(expected, jp_robot_model(&ecu.robot), sizeof *expected);
}

static void test_a_route_is_planned_with_what_was_known_when_it_began(void)
{
    struct jp_energy_model then;

    learn(JP_STORED_NOTHING);
    TEST_ASSERT_NOT_EQUAL(&jp_energy_model_courier24, jp_robot_model(&ecu.robot));
    expect_model(&jp_energy_model_courier24);
    make_driving();
    then = *jp_robot_model(&ecu.robot);
    ecu.learner.state.x[0] = JP_Q24(1.5);
    hold(JP_MODE_DRIVE, 7, 1);
    expect_model(&then);
    for (int i = 0; i < 100 && ecu.internal.routes.state == JP_ROUTE_DRIVING; i++) {
        hold(JP_MODE_DRIVE, 7, 1);
    }
    expect_model(&then);
    ecu.learner.state.x[0] = JP_Q24(1.5);
    offer(8, near_route, 2);
    hold(JP_MODE_DRIVE, 8, 4);
    expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
    jp_learner_model(&ecu.learner, &then);
    expect_model(&then);
    TEST_ASSERT_TRUE(memcmp(&jp_energy_model_courier24, &then, sizeof then) != 0);
}

/* The tick may be telling of it at that moment. */
static void test_the_model_in_use_is_not_written_over(void)
{
    const struct jp_energy_model *in_use;
    struct jp_energy_model then;

    learn(JP_STORED_NOTHING);
    make_balancing();
    for (uint8_t route = 7; route < 10U; route++) {
        in_use = jp_robot_model(&ecu.robot);
        then = *in_use;
        ecu.learner.state.x[0] += JP_Q24(0.5);
        offer(route, near_route, 2);
        hold(JP_MODE_DRIVE, route, 4);
        expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
        TEST_ASSERT_NOT_EQUAL(in_use, jp_robot_model(&ecu.robot));
        TEST_ASSERT_TRUE(memcmp(&then, jp_robot_model(&ecu.robot), sizeof then) != 0);
        TEST_ASSERT_EQUAL_MEMORY(&then, in_use, sizeof then);
        hold(JP_MODE_STAND, 0, 1);
    }
}

static void expect_stored(enum jp_stored stored, uint32_t version)
{
    run(1010);
    TEST_ASSERT_EQUAL_INT(stored, ecu.stored);
    TEST_ASSERT_EQUAL_UINT8(stored, learner_status().stored);
    TEST_ASSERT_EQUAL_UINT16(version, learner_status().version);
}

static void test_it_goes_on_from_the_stored_state(void)
{
    struct jp_energy_model expected;

    jp_learned_state_start(&state, jp_learning_courier24.identity);
    state.x[0] = -JP_Q24(1);
    state.version = 31;
    learn(JP_STORED_TAKEN);
    TEST_ASSERT_EQUAL_MEMORY(&state, jp_ecu_learned_state(&ecu), sizeof state);
    jp_learner_model(&ecu.learner, &expected);
    expect_model(&expected);
    TEST_ASSERT_TRUE(memcmp(&jp_energy_model_courier24, &expected, sizeof expected) != 0);
    expect_stored(JP_STORED_TAKEN, 31);
}

static void expect_built_in(enum jp_stored given, enum jp_stored stored)
{
    start(1000);
    learn(given);
    expect_model(&jp_energy_model_courier24);
    expect_stored(stored, 0);
}

static void test_a_stored_state_that_does_not_fit_is_named(void)
{
    jp_learned_state_start(&state, jp_learning_courier24.identity + 1U);
    state.x[0] = JP_Q24(1);
    state.version = 31;
    expect_built_in(JP_STORED_TAKEN, JP_STORED_OTHER_TABLES);
    expect_built_in(JP_STORED_OTHER_ROBOT, JP_STORED_OTHER_ROBOT);
    expect_built_in(JP_STORED_OTHER_VERSION, JP_STORED_OTHER_VERSION);
    expect_built_in(JP_STORED_DAMAGED, JP_STORED_DAMAGED);
    /* Other parameters were stored before anything was learned. */
    state.identity = 0;
    expect_built_in(JP_STORED_TAKEN, JP_STORED_NOTHING);
}

/* Cycle times */

static void check_a_second(uint32_t tick_rate)
{
    static const uint16_t expected[32] = {10, 10, 10, 10, 50, 50, 50, 50, 50, 10, 0, 0, 0, 0, 10, 0};

    start(tick_rate);
    (void)give_sample();
    run(tick_rate);
    TEST_ASSERT_EQUAL_UINT(tick_rate, bus.commands);
    TEST_ASSERT_EQUAL_UINT16_ARRAY(expected, bus.counts, 32);
}

static void test_a_second_has_the_frames_of_the_dbc(void)
{
    check_a_second(1000);
    TEST_ASSERT_EQUAL_UINT(2, bus.most_in_a_tick);
    check_a_second(100);
    check_a_second(400);
    check_a_second(500);
    check_a_second(2000);
}
