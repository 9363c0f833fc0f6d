/* The robot: every transition and those that must not happen, segments to the tick, routes, faults, energies. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "unity.h"

#define RATE 1000

static struct jp_robot_config config;
static struct jp_robot robot;
static struct jp_sensors sensors;
static struct jp_actuation actuation;

static void init(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_init(&robot, &config, &jp_energy_model_courier24, &field));
}

void setUp(void)
{
    config = jp_robot_courier24;
    config.monitor.freeze_ticks = 0;
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)};
    init();
}

void tearDown(void)
{
}

/* Helpers: a robot whose wheels are held, with the currents that belong to its voltages. */

static void tick_read(enum jp_status read)
{
    sensors.current_left = jp_q16_divide(robot.internal.telemetry.voltages.left, config.monitor.motor_resistance);
    sensors.current_right = jp_q16_divide(robot.internal.telemetry.voltages.right, config.monitor.motor_resistance);
    jp_robot_tick(&robot, read, &sensors, &actuation);
}

static void run(uint32_t ticks)
{
    for (uint32_t i = 0; i < ticks; i++) {
        tick_read(JP_OK);
    }
}

static void work(uint32_t ticks)
{
    for (uint32_t i = 0; i < ticks; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
        tick_read(JP_OK);
    }
}

static struct jp_telemetry telemetry(void)
{
    struct jp_telemetry copy;

    jp_robot_telemetry(&robot, &copy);
    return copy;
}

static void expect_state(enum jp_robot_state state)
{
    bool on = state == JP_ROBOT_BALANCING || state == JP_ROBOT_DRIVING;

    TEST_ASSERT_EQUAL_INT(state, telemetry().state);
    TEST_ASSERT_EQUAL_UINT8(on ? 1 : 0, actuation.enabled);
    if (!on) {
        TEST_ASSERT_EQUAL_INT32(0, actuation.duty_left);
        TEST_ASSERT_EQUAL_INT32(0, actuation.duty_right);
        TEST_ASSERT_EQUAL_INT32(0, telemetry().voltages.left);
    }
}

static const struct jp_segment_command one_second = {{JP_Q24(0.1), 0}, 0, JP_Q16(1)};

static void make_balancing(void)
{
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    expect_state(JP_ROBOT_BALANCING);
}

static void make_driving(void)
{
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(1);
    expect_state(JP_ROBOT_DRIVING);
}

static void make_fallen(void)
{
    make_balancing();
    robot.internal.estimator.pitch = JP_PHASE_TURN / 8;
    run(1);
    expect_state(JP_ROBOT_FALLEN);
}

static void make_fault(void)
{
    make_balancing();
    sensors.bus_voltage = 0;
    run(3);
    sensors.bus_voltage = JP_Q16(24);
    expect_state(JP_ROBOT_FAULT);
}

/* Configuration */

static void test_init_refuses_null(void)
{
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_init(NULL, &config, &jp_energy_model_courier24, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_init(&robot, NULL, &jp_energy_model_courier24, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_init(&robot, &config, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_init(&robot, &config, &jp_energy_model_courier24, NULL));
}

static void expect_config(const char *expected)
{
    const char *field = "";
    enum jp_status status = jp_robot_init(&robot, &config, &jp_energy_model_courier24, &field);

    if (expected == NULL) {
        TEST_ASSERT_EQUAL_INT(JP_OK, status);
    } else {
        TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, status);
        TEST_ASSERT_EQUAL_STRING(expected, field);
    }
    config = jp_robot_courier24;
}

#define FIELD(member, value, expected)                                                                                 \
    do {                                                                                                               \
        config.member = (value);                                                                                       \
        expect_config(expected);                                                                                       \
    } while (0)

static void test_init_checks_every_part(void)
{
    struct jp_energy_model model = jp_energy_model_courier24;
    const char *field = "";

    expect_config(NULL);
    FIELD(estimator.tilt_gain, -1, "estimator.tilt_gain");
    FIELD(reference.travel_bandwidth, -1, "reference.travel_bandwidth");
    FIELD(lqr.pitch_reserve, -1, "lqr.pitch_reserve");
    FIELD(monitor.tilt_limit, 0, "monitor.tilt_limit");
    FIELD(meter.electronics_power, -1, "meter.electronics_power");
    FIELD(metres_per_turn, JP_Q24(0.0625) - 1, "metres_per_turn");
    FIELD(metres_per_turn, JP_Q24(0.0625), NULL);
    FIELD(metres_per_turn, JP_Q24(4), NULL);
    FIELD(metres_per_turn, JP_Q24(4) + 1, "metres_per_turn");
    FIELD(reference.tick_rate, 999, "estimator.tick_rate");
    FIELD(lqr.tick_rate, 1001, "estimator.tick_rate");
    FIELD(meter.tick_rate, 500, "estimator.tick_rate");
    config.limits.speed = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_robot_init(&robot, &config, &model, &field));
    config.limits.speed = JP_Q24(1);
    model.settling_time = -1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_robot_init(&robot, &config, &model, &field));
    config = jp_robot_gao2018;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_init(&robot, &config, &jp_energy_model_published, &field));
}

/* Transitions */

static void test_starts_idle_and_stays(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, telemetry().state);
    run(100);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_UINT32(100, telemetry().tick);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
}

static void test_enable_needs_a_frame(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    tick_read(JP_ERR_HARDWARE);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    make_balancing();
}

static void test_enable_is_refused_when_tilted(void)
{
    run(1);
    robot.internal.estimator.pitch = (jp_phase)(uint32_t)config.monitor.tilt_limit << 32;
    robot.internal.estimator.pitch += (jp_phase)1 << 44; /* levelling takes less in a tick */
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    robot.internal.estimator.pitch = 0 - robot.internal.estimator.pitch;
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    robot.internal.estimator.pitch = 3 * JP_PHASE_TURN; /* rolled over on its way back */
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_enable_only_from_idle(void)
{
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    setUp();
    make_driving();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    setUp();
    make_fallen();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    setUp();
    make_fault();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
}

static void disable(void)
{
    jp_robot_disable(&robot);
    run(1);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().faults);
    run(10);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    expect_state(JP_ROBOT_BALANCING);
    run(100);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_disable_leads_to_idle_from_every_state(void)
{
    run(1);
    disable();
    setUp();
    make_balancing();
    disable();
    setUp();
    make_driving();
    disable();
    setUp();
    make_fault();
    disable();
    setUp();
    make_fallen();
    robot.internal.estimator.pitch = 0;
    run(1);
    disable();
}

static void test_disable_after_enable_wins(void)
{
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    jp_robot_disable(&robot);
    run(10);
    expect_state(JP_ROBOT_IDLE);

    jp_robot_disable(&robot);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_falls_from_balancing_and_driving_both_ways(void)
{
    make_fallen();
    setUp();
    make_driving();
    robot.internal.estimator.pitch = 0 - JP_PHASE_TURN / 8;
    run(1);
    expect_state(JP_ROBOT_FALLEN);
    TEST_ASSERT_EQUAL_UINT32(0, telemetry().segment_ticks_left);
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().faults);
    robot.internal.estimator.pitch = 0; /* upright again: it stays off */
    run(100);
    expect_state(JP_ROBOT_FALLEN);
}

static void test_idle_does_not_fall(void)
{
    run(1);
    robot.internal.estimator.pitch = JP_PHASE_TURN / 8;
    run(10);
    expect_state(JP_ROBOT_IDLE);
}

static void test_faults_switch_off_and_stay(void)
{
    make_fault();
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_BUS_VOLTAGE, telemetry().faults);
    run(100);
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_BUS_VOLTAGE, telemetry().faults);
    jp_robot_stop(&robot);
    run(1);
    expect_state(JP_ROBOT_FAULT);

    setUp();
    make_driving();
    for (int i = 0; i < 3; i++) {
        expect_state(JP_ROBOT_DRIVING);
        tick_read(JP_ERR_HARDWARE);
    }
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, telemetry().faults);
}

static void test_fallen_stays_fallen_under_a_fault(void)
{
    make_fallen();
    sensors.bus_voltage = 0;
    run(10);
    expect_state(JP_ROBOT_FALLEN);
}

static void test_a_short_dropout_is_bridged(void)
{
    make_balancing();
    tick_read(JP_ERR_HARDWARE);
    tick_read(JP_ERR_HARDWARE);
    run(1);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_idle_shows_faults_and_refuses_to_start(void)
{
    run(1);
    sensors.bus_voltage = 0;
    run(3);
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    jp_robot_disable(&robot); /* the cause is still there */
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_enable(&robot));
    run(3);
    expect_state(JP_ROBOT_FAULT);
}

static void test_disable_recovers_from_an_encoder_that_jumped(void)
{
    make_balancing();
    sensors.encoder_left += 100000;
    run(3);
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_ENCODER_JUMP, telemetry().faults);
    disable();
}

static void test_residual_counts_anew_after_disable(void)
{
    make_balancing();
    /* The motors are reviewed after the duties are out, so the next tick switches off. */
    for (uint32_t i = 0; i <= config.monitor.residual_ticks; i++) {
        expect_state(JP_ROBOT_BALANCING);
        sensors.current_left = JP_Q16(5);
        jp_robot_tick(&robot, JP_OK, &sensors, &actuation);
    }
    expect_state(JP_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_ENCODER_LEFT, telemetry().faults);
    jp_robot_disable(&robot);
    run(2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    sensors.current_left = JP_Q16(5);
    jp_robot_tick(&robot, JP_OK, &sensors, &actuation);
    expect_state(JP_ROBOT_BALANCING);
}

/* Segments */

static void test_drive_refuses_what_is_out_of_range(void)
{
    struct jp_segment_command segment = one_second;

    make_balancing();
#define REFUSED(member, value)                                                                                         \
    do {                                                                                                               \
        segment = one_second;                                                                                          \
        segment.member = (value);                                                                                      \
        TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_drive(&robot, &segment));                                      \
    } while (0)
    REFUSED(motion.speed, config.limits.speed + 1);
    REFUSED(motion.speed, -config.limits.speed - 1);
    REFUSED(motion.speed, INT32_MIN);
    REFUSED(motion.turn_rate, JP_Q24(8) + 1);
    REFUSED(motion.turn_rate, INT32_MIN);
    REFUSED(turn, JP_Q24(6.283185307179586) + 1);
    REFUSED(turn, -JP_Q24(6.283185307179586) - 1);
    REFUSED(duration, 0);
    REFUSED(duration, -1);
    REFUSED(duration, JP_Q16(16384) + 1);
#undef REFUSED
    segment = (struct jp_segment_command){{-config.limits.speed, -JP_Q24(8)}, JP_Q24(6.283185307179586), JP_Q16(16384)};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &segment));
    run(1);
    TEST_ASSERT_EQUAL_UINT32(16384U * RATE - 1U, telemetry().segment_ticks_left);
}

static void test_drive_needs_running_motors(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_drive(&robot, &one_second));
    make_fallen();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_drive(&robot, &one_second));
    setUp();
    make_fault();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_drive(&robot, &one_second));
}

static void test_one_segment_may_wait(void)
{
    make_driving();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    TEST_ASSERT_EQUAL_INT(JP_ERR_BUSY, jp_robot_drive(&robot, &one_second));
    run(RATE);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segment);
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().segments_ended);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
}

/** Ticks in state driving. */
static uint32_t driven_ticks(jp_q16 duration)
{
    const struct jp_segment_command segment = {{JP_Q24(0.1), 0}, 0, duration};
    uint32_t ticks = 0;

    setUp();
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &segment));
    for (run(1); telemetry().state == JP_ROBOT_DRIVING; run(1)) {
        ticks++;
        TEST_ASSERT_EQUAL_INT32(segment.motion.speed, telemetry().command.speed);
    }
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().command.speed);
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().segments_ended);
    return ticks;
}

static void test_segments_last_to_the_tick(void)
{
    TEST_ASSERT_EQUAL_UINT32(1000, driven_ticks(JP_Q16(1)));
    TEST_ASSERT_EQUAL_UINT32(125, driven_ticks(JP_Q16(0.125)));
    TEST_ASSERT_EQUAL_UINT32(2, driven_ticks(JP_Q16(0.002)));
    TEST_ASSERT_EQUAL_UINT32(2, driven_ticks(JP_Q16(0.0016)));
    TEST_ASSERT_EQUAL_UINT32(1, driven_ticks(JP_Q16(0.0014)));
    TEST_ASSERT_EQUAL_UINT32(1, driven_ticks(1));
}

static void test_segment_steps_the_reference(void)
{
    const struct jp_segment_command segment = {{JP_Q24(0.5), JP_Q24(0.2)}, JP_Q24(1), JP_Q16(0.5)};

    make_balancing();

    jp_phase heading = telemetry().target_yaw;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &segment));
    run(1);
    TEST_ASSERT_INT32_WITHIN(2000, JP_Q24(0.15915494309189535), jp_phase_difference(telemetry().target_yaw, heading));
    TEST_ASSERT_EQUAL_INT32(jp_q24_multiply(JP_Q24(0.5), config.reference.turns_per_metre),
                            robot.internal.reference.wheel.target_rate);
    run(500);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.wheel.target_rate);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.yaw.target_rate);
    /* σ + w T = 1.1 rad */
    TEST_ASSERT_INT32_WITHIN(200, JP_Q24(0.17507043740108488), jp_phase_difference(telemetry().target_yaw, heading));
}

static void test_energies_of_segments_add_up_to_the_meter(void)
{
    jp_energy sum_model = 0;
    jp_energy sum_battery = 0;

    make_balancing();

    jp_energy start_model = telemetry().energy_model;
    jp_energy start_battery = telemetry().energy_battery;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(1);
    start_model = telemetry().energy_model;
    start_battery = telemetry().energy_battery;
    for (int segment = 0; segment < 5; segment++) {
        if (segment < 4) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
        }
        run(RATE);
        TEST_ASSERT_EQUAL_UINT16(segment + 1, telemetry().segments_ended);
        TEST_ASSERT_GREATER_THAN_INT64(0, telemetry().segment_energy_model);
        sum_model += telemetry().segment_energy_model;
        sum_battery += telemetry().segment_energy_battery;
    }
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_INT64(telemetry().energy_model - start_model, sum_model);
    TEST_ASSERT_EQUAL_INT64(telemetry().energy_battery - start_battery, sum_battery);
}

static void test_counts_restart_when_the_robot_stood(void)
{
    make_driving();
    run(RATE);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().segment);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(1);
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().segment);
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().segments_ended);
    robot.internal.telemetry.segment = UINT16_MAX;
    robot.internal.telemetry.segments_ended = UINT16_MAX;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(RATE);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, telemetry().segment);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, telemetry().segments_ended);
}

static void test_stop_stands_at_once_and_drops_the_waiting_segment(void)
{
    make_driving();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    jp_robot_stop(&robot);
    run(1);
    expect_state(JP_ROBOT_BALANCING);
    run(2 * RATE);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.wheel.target_rate);
}

static void test_drive_after_stop_is_driven(void)
{
    make_driving();
    jp_robot_stop(&robot);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(2);
    expect_state(JP_ROBOT_DRIVING);
    TEST_ASSERT_EQUAL_UINT32(RATE - 1U, telemetry().segment_ticks_left);
}

static void test_nothing_waits_over_a_disable(void)
{
    make_driving();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    disable(); /* balancing again, and stays so */

    robot.internal.next_full = 1; /* handed over while the tick switched off */
    jp_robot_disable(&robot);
    run(2);
    robot.internal.next_full = 1;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(5);
    expect_state(JP_ROBOT_BALANCING);
}

/* Routes */

static const struct jp_point route[] = {{JP_Q16(0.3), 0}, {JP_Q16(0.6), JP_Q16(0.1)}};

static void test_follow_refuses(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_follow(&robot, route, 2));
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_follow(&robot, NULL, 2));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_follow(&robot, route, 0));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
    setUp();
    make_fallen();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_follow(&robot, route, 2));
}

static void test_route_is_driven_to_its_end(void)
{
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    run(1);
    expect_state(JP_ROBOT_DRIVING);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    TEST_ASSERT_EQUAL_UINT16(1, robot.internal.route_planned); /* the next one when this one nears its end */

    uint32_t left = telemetry().segment_ticks_left;

    work(left - 100U);
    TEST_ASSERT_EQUAL_UINT16(1, robot.internal.route_planned);
    work(102);
    TEST_ASSERT_EQUAL_UINT16(2, robot.internal.route_planned);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segment);
    work(telemetry().segment_ticks_left + 1U);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segments_ended);
    work(10);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_planning_failure_stops_the_robot(void)
{
    static const struct jp_point far[] = {{JP_Q16(0.3), 0}, {JP_Q16(1000), 0}};
    static const struct jp_point again[] = {{JP_Q16(2), 0}};

    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, far, 2));
    work(1);

    uint32_t left = telemetry().segment_ticks_left;

    work(left - 100U);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_work(&robot));
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_work(&robot)); /* the first failure stays */
    expect_state(JP_ROBOT_DRIVING);
    run(100);
    expect_state(JP_ROBOT_BALANCING);
    jp_robot_stop(&robot);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, again, 1));
    work(2); /* the stop comes first */
    expect_state(JP_ROBOT_DRIVING);
}

static void test_infeasible_and_empty_targets_are_failures(void)
{
    static const struct jp_point behind = {JP_Q16(-1), 0};
    static const struct jp_point here = {0, 0};

    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, &here, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, jp_robot_work(&robot));
    config.limits.turn = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, &behind, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, jp_robot_work(&robot));
    run(10);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_stop_and_disable_forget_the_route(void)
{
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
    work(1);
    jp_robot_stop(&robot);
    work(RATE);
    expect_state(JP_ROBOT_BALANCING);

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
    work(1);
    disable();
    work(RATE);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_a_fall_forgets_the_route(void)
{
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
    work(1);
    robot.internal.estimator.pitch = JP_PHASE_TURN / 8;
    work(1);
    expect_state(JP_ROBOT_FALLEN);
    work(1);
    robot.internal.estimator.pitch = 0;
    run(1);
    disable();
    work(RATE);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_follow_replaces_the_waiting_segment(void)
{
    static const struct jp_point other = {JP_Q16(0.5), 0};

    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
    work(1);
    work(telemetry().segment_ticks_left - 50U);
    TEST_ASSERT_EQUAL_UINT16(2, robot.internal.route_planned);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, &other, 1));
    work(1);
    TEST_ASSERT_EQUAL_UINT16(1, robot.internal.route_planned);
    work(60);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segment);
    work(telemetry().segment_ticks_left + 5U);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segments_ended);
}

/* Telemetry and outputs */

static void test_telemetry_is_consistent(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, robot.internal.sequence);
    run(1);
    TEST_ASSERT_EQUAL_UINT32(2, robot.internal.sequence);
    robot.internal.sequence = UINT32_MAX - 1U;
    run(1);
    TEST_ASSERT_EQUAL_UINT32(0, robot.internal.sequence);
    make_driving();

    struct jp_telemetry copy = telemetry();

    TEST_ASSERT_EQUAL_INT(JP_ROBOT_DRIVING, copy.state);
    TEST_ASSERT_EQUAL_UINT32(robot.internal.telemetry.tick, copy.tick);
    TEST_ASSERT_EQUAL_MEMORY(&robot.internal.telemetry.motion, &copy.motion, sizeof copy.motion);
    TEST_ASSERT_EQUAL_INT32(robot.internal.telemetry.voltages.left, copy.voltages.left);
    TEST_ASSERT_EQUAL_INT32(robot.internal.telemetry.voltages.right, copy.voltages.right);
    TEST_ASSERT_EQUAL_UINT32(robot.internal.telemetry.segment_ticks_left, copy.segment_ticks_left);
    TEST_ASSERT_EQUAL_UINT16(1, copy.segment);
    TEST_ASSERT_EQUAL_INT32(robot.internal.reference.wheel.rate, copy.reference_wheel_rate);
    TEST_ASSERT_EQUAL_UINT64(robot.internal.reference.wheel.target, copy.target_wheel);
    TEST_ASSERT_EQUAL_INT32(jp_odometry_position(&robot.internal.odometry).x, copy.position.x);
    TEST_ASSERT_EQUAL_UINT64(robot.internal.reference.wheel.angle, copy.reference_wheel);
    TEST_ASSERT_EQUAL_UINT64(robot.internal.reference.yaw.angle, copy.reference_yaw);
    TEST_ASSERT_EQUAL_UINT64(robot.internal.reference.yaw.target, copy.target_yaw);
    TEST_ASSERT_EQUAL_INT64(robot.internal.meter.model, copy.energy_model);
    TEST_ASSERT_EQUAL_INT64(robot.internal.meter.battery, copy.energy_battery);
}

static void test_duty_is_the_share_of_the_bus(void)
{
    make_balancing();
    robot.internal.estimator.pitch = JP_PHASE_TURN / 100;
    run(1);
    TEST_ASSERT_TRUE(telemetry().voltages.left != 0);
    TEST_ASSERT_EQUAL_INT32(jp_divide((int64_t)telemetry().voltages.left * ((int64_t)1 << 31), JP_Q16(24)),
                            actuation.duty_left);
    robot.internal.estimator.pitch = JP_PHASE_TURN / 10; /* below the tilt limit, above the supply */
    sensors.bus_voltage = JP_Q16(20);
    run(1);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(20), telemetry().voltages.left);
    TEST_ASSERT_EQUAL_INT32(JP_Q31_MAX, actuation.duty_left);
    TEST_ASSERT_EQUAL_INT32(JP_Q31_MAX, actuation.duty_right);
    TEST_ASSERT_EQUAL_UINT32(1, telemetry().saturated_ticks);
    robot.internal.telemetry.saturated_ticks = UINT32_MAX;
    run(1);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, telemetry().saturated_ticks);
}

static jp_q31 share(jp_q16 voltage)
{
    return jp_divide((int64_t)voltage * ((int64_t)1 << 31), sensors.bus_voltage);
}

static void test_duties_are_rounded_at_every_voltage(void)
{
    config.monitor.voltage_min = 1;
    config.monitor.voltage_max = JP_Q16(1000);
    config.monitor.current_limit = JP_Q16(4000);
    init();
    make_balancing();
    for (uint32_t i = 0; i < 3000; i++) {
        const uint32_t random = i * 2654435761U;

        sensors.bus_voltage = JP_Q16(1000) >> (random >> 28);
        sensors.bus_voltage -= (jp_q16)(random & 0xFFFFU) % sensors.bus_voltage;
        robot.internal.estimator.pitch = (jp_phase)(int64_t)(int32_t)random << 20;
        run(1);
        TEST_ASSERT_EQUAL_INT32(share(telemetry().voltages.left), actuation.duty_left);
        TEST_ASSERT_EQUAL_INT32(share(telemetry().voltages.right), actuation.duty_right);
    }
    expect_state(JP_ROBOT_BALANCING);
}

static void test_start_counts_do_not_matter_to_the_bit(void)
{
    struct jp_telemetry expected = {0};

    for (uint32_t offset = 0; offset < 3; offset++) {
        setUp();
        sensors.encoder_left = 0U - 17U * offset;
        sensors.encoder_right = 0x7FFFFFFFU * offset;
        make_balancing();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
        for (uint32_t i = 0; i < 1000; i++) {
            sensors.encoder_left += i / 100U;
            sensors.encoder_right += i / 90U;
            work(1);
        }
        expect_state(JP_ROBOT_DRIVING);
        if (offset == 0) {
            expected = telemetry();
        }
        TEST_ASSERT_EQUAL_UINT64(expected.motion.wheel, telemetry().motion.wheel);
        TEST_ASSERT_EQUAL_UINT64(expected.motion.yaw, telemetry().motion.yaw);
        TEST_ASSERT_EQUAL_INT32(expected.voltages.left, telemetry().voltages.left);
        TEST_ASSERT_EQUAL_INT32(expected.voltages.right, telemetry().voltages.right);
        TEST_ASSERT_EQUAL_INT32(expected.position.x, telemetry().position.x);
        TEST_ASSERT_EQUAL_INT64(expected.energy_battery, telemetry().energy_battery);
    }
}

/* A reset of the controller */

static struct jp_snapshot snapshot;

/* Another controller that knows but the snapshot. */
static void reset(void)
{
    jp_robot_snapshot(&robot, &snapshot);
    init();
    jp_robot_resume(&robot, &snapshot);
    actuation = (struct jp_actuation){0, 0, 0};
}

static void expect_snapshot(bool balancing)
{
    jp_robot_snapshot(&robot, &snapshot);
    TEST_ASSERT_EQUAL_INT(balancing, snapshot.balancing);
    TEST_ASSERT_EQUAL_MEMORY(&robot.internal.estimator, &snapshot.estimator, sizeof snapshot.estimator);
    TEST_ASSERT_EQUAL_MEMORY(&robot.internal.odometry, &snapshot.odometry, sizeof snapshot.odometry);
}

static void test_a_snapshot_tells_whether_the_motors_ran(void)
{
    run(1);
    expect_snapshot(false);
    setUp();
    make_balancing();
    expect_snapshot(true);
    setUp();
    make_driving();
    expect_snapshot(true);
    setUp();
    make_fallen();
    expect_snapshot(false);
    setUp();
    make_fault();
    expect_snapshot(false);
}

/* Wheels that roll, with the currents that belong to them; the robot is off. */
static void roll_in_idle(uint32_t left, uint32_t right, uint32_t ticks)
{
    for (uint32_t i = 0; i < ticks; i++) {
        sensors.encoder_left += left;
        sensors.encoder_right += right;
        run(1);
    }
}

static void test_a_resumed_robot_balances_from_the_first_frame_on(void)
{
    make_driving();
    run(200);
    reset();
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, telemetry().state);
    run(1);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().segment);
    run(2 * RATE);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &one_second));
    run(1);
    expect_state(JP_ROBOT_DRIVING);
}

static void test_a_resumed_robot_waits_for_a_plausible_frame(void)
{
    make_balancing();
    reset();
    for (int i = 0; i < 2; i++) {
        tick_read(JP_ERR_HARDWARE);
        expect_state(JP_ROBOT_IDLE);
    }
    run(1);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_a_resumed_robot_knows_where_it_is(void)
{
    struct jp_telemetry before;

    run(1);
    roll_in_idle(30, 40, 2000);
    roll_in_idle(0, 0, 2000);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    run(1);
    expect_state(JP_ROBOT_BALANCING);
    before = telemetry();
    TEST_ASSERT_TRUE(before.position.x != 0 && before.position.y != 0);
    reset();
    run(1);
    TEST_ASSERT_INT32_WITHIN(4, before.position.x, telemetry().position.x);
    TEST_ASSERT_INT32_WITHIN(4, before.position.y, telemetry().position.y);
    TEST_ASSERT_INT32_WITHIN(4, 0, jp_phase_difference(before.motion.yaw, telemetry().motion.yaw));
    TEST_ASSERT_EQUAL_UINT64(telemetry().motion.yaw, telemetry().target_yaw);
}

static void test_a_resumed_robot_counts_the_way_of_the_gap(void)
{
    const uint32_t counts = 300;
    jp_q24 turns;
    struct jp_point before;

    make_balancing();
    before = telemetry().position;
    reset();
    sensors.encoder_left += counts;
    sensors.encoder_right += counts;
    run(1);
    turns = (jp_q24)((2U * counts * config.estimator.wheel_per_count) >> 32);
    TEST_ASSERT_INT32_WITHIN(16, before.x + jp_q24_multiply(turns, config.metres_per_turn) / 256,
                             telemetry().position.x);
    TEST_ASSERT_EQUAL_INT32(before.y, telemetry().position.y);
}

static void test_a_resumed_robot_slows_down_from_its_speed(void)
{
    jp_q24 rate;

    make_balancing();
    robot.internal.estimator.wheel.rate = JP_Q24(0.5);
    robot.internal.estimator.yaw.rate = JP_Q24(-0.1);
    reset();
    robot.internal.estimator.wheel.angle =
        robot.internal.estimator.wheel_encoder - jp_phase_step(JP_Q24(0.5), robot.internal.estimator.phase_per_rate);
    robot.internal.estimator.yaw.angle =
        robot.internal.estimator.yaw_encoder + jp_phase_step(JP_Q24(0.1), robot.internal.estimator.phase_per_rate);
    run(1);
    rate = telemetry().motion.wheel_rate;
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.5), rate);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.005), rate, telemetry().reference_wheel_rate); /* a tick later */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.005), telemetry().motion.yaw_rate, telemetry().reference_yaw_rate);
    TEST_ASSERT_EQUAL_INT32(0, robot.internal.reference.wheel.target_rate);
}

static void test_a_robot_that_fell_during_the_reset_switches_off(void)
{
    make_balancing();
    robot.internal.estimator.pitch = JP_PHASE_TURN / 8;
    jp_robot_snapshot(&robot, &snapshot);
    reset();
    run(1);
    expect_state(JP_ROBOT_FALLEN);
}

static void test_a_snapshot_with_motors_off_starts_anew(void)
{
    run(1);
    roll_in_idle(30, 40, 100);
    reset();
    run(1);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().position.x);
    TEST_ASSERT_EQUAL_UINT64(0, telemetry().motion.yaw);
    run(100);
    expect_state(JP_ROBOT_IDLE);
}

static void test_resuming_happens_once(void)
{
    make_balancing();
    reset();
    run(1);
    sensors.bus_voltage = 0;
    run(3);
    sensors.bus_voltage = JP_Q16(24);
    expect_state(JP_ROBOT_FAULT);
    jp_robot_disable(&robot);
    run(10);
    expect_state(JP_ROBOT_IDLE);
}
