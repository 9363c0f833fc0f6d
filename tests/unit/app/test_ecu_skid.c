/* The application of a robot that its sides steer: over a route to its end, what it refuses, what it tells, silence,
 * faults, another controller, lost samples, and a reset in any tick of a drive. */
#include "tests/support/ecu_skid_rig.h"

/* Start */

static void test_init_refuses_what_the_robot_and_the_pilot_do(void)
{
    const struct jp_ecu_skid_config sound = tables;
    struct jp_path_limits limits = *tables.limits;
    struct jp_ecu_robot robot;
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_skid_init(NULL, &tables, &robot, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_skid_init(&skid, NULL, &robot, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_skid_init(&skid, &tables, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_skid_init(&skid, &tables, &robot, NULL));
    tables.limits = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, start(&field));
    tables = sound;
    tables.robot = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, start(&field));
    tables = sound;
    tables.stored = JP_STORED_TAKEN;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, start(&field));
    tables = sound;
    tables.limits = &limits;
    limits.speed = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, start(&field));
    tables = sound;
    config.control.resistance = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, start(&field));
}

/* The way of a route */

static void drive_to_the_end(uint8_t route)
{
    for (int i = 0; i < 200 && ecu.internal.routes.state == JP_ROUTE_DRIVING; i++) {
        hold(JP_MODE_DRIVE, route, 1);
    }
}

static void test_from_idle_over_a_route_to_its_end(void)
{
    make_driving();
    drive_to_the_end(7);
    run(RATE / 10U);
    expect_route(JP_ROUTE_DONE, JP_REASON_NONE);
    expect_state(JP_ECU_STANDING);
    for (unsigned kind = 0xA; kind <= 0xD; kind++) { /* plan and result of each leg */
        TEST_ASSERT_EQUAL_UINT16(2, bus.counts[kind]);
        TEST_ASSERT_EQUAL_UINT8(2, bus.last[kind][0]);
    }
    TEST_ASSERT_EQUAL_UINT8(7, bus.last[3][0]);
    TEST_ASSERT_EQUAL_UINT8(JP_ROUTE_DONE, bus.last[3][1]);
    TEST_ASSERT_EQUAL_UINT8(2, bus.last[3][4]);
    TEST_ASSERT_EQUAL_UINT8(2, bus.last[3][5]);
    hold(JP_MODE_DRIVE, 7, 5); /* driven once */
    expect_state(JP_ECU_STANDING);
    hold(JP_MODE_OFF, 0, 3);
    expect_state(JP_ECU_IDLE);
    TEST_ASSERT_EQUAL_HEX16(0, faults());
}

static void test_stand_stops_a_route(void)
{
    make_driving();
    hold(JP_MODE_STAND, 0, 8);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_COMMAND);
    expect_state(JP_ECU_STANDING);
    expect_rest();
    hold(JP_MODE_DRIVE, 7, 5); /* a stopped route is not taken up again */
    expect_state(JP_ECU_STANDING);
}

static void test_off_brakes_and_then_shorts_the_motors(void)
{
    make_driving();
    hold(JP_MODE_OFF, 0, 4);
    expect_state(JP_ECU_IDLE);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_SWITCHED_OFF);
    run(2U * RATE);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT8(1, bus.actuation.enabled);
    TEST_ASSERT_EQUAL_INT32(0, bus.actuation.duty_left);
    TEST_ASSERT_EQUAL_INT32(0, bus.actuation.duty_right);
}

static void test_a_route_on_the_way_replaces_the_one_before(void)
{
    static const struct jp_point other = {JP_Q16(1.5), 0};

    make_driving();
    offer(8, &other, 1);
    hold(JP_MODE_DRIVE, 8, 3);
    TEST_ASSERT_EQUAL_UINT8(8, ecu.internal.routes.driven.id);
    drive_to_the_end(8);
    expect_route(JP_ROUTE_DONE, JP_REASON_NONE);
}

static void test_a_route_that_cannot_be_planned_stops_with_the_reason(void)
{
    static const struct jp_point here[2] = {{JP_Q16(1), 0}, {JP_Q16(1), 0}};

    make_standing();
    offer(7, here, 2);
    hold(JP_MODE_DRIVE, 7, 5);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_PLAN);
    expect_state(JP_ECU_STANDING);
    TEST_ASSERT_EQUAL_INT8(JP_ERR_ZERO_LENGTH, (int8_t)bus.last[3][6]);
}

/* The operator's silence */

static void test_silence_stops_a_driving_robot(void)
{
    make_driving();
    command(JP_MODE_DRIVE, 7);
    run(RATE / 2U - 3U);
    expect_operator(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
    run(5);
    expect_operator(JP_OPERATOR_LOST, JP_MODE_STAND);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_TIMEOUT);
    run(2U * RATE);
    expect_state(JP_ECU_STANDING);
    expect_rest();
    hold(JP_MODE_DRIVE, 7, 10);
    expect_state(JP_ECU_STANDING);
}

/* Refusals and faults */

static void test_it_does_not_stand_on_ground_that_is_too_steep(void)
{
    sensors.accel_x = JP_Q24(0.6);
    sensors.accel_z = JP_Q24(0.8);
    run(RATE);
    hold(JP_MODE_STAND, 0, 3);
    expect_state(JP_ECU_IDLE);
    expect_refused(2, JP_REFUSAL_STEEP); /* the first command only begins the sequence */
    sensors.accel_x = 0;
    sensors.accel_z = JP_Q24_ONE;
    run(2U * RATE);
    hold(JP_MODE_STAND, 0, 2);
    expect_state(JP_ECU_STANDING);
    expect_refused(2, JP_REFUSAL_NONE);
}

static void test_a_fault_is_named_and_stays_until_the_operator_switches_off(void)
{
    make_driving();
    sensors.bus_voltage = 0;
    run(10);
    sensors.bus_voltage = JP_Q16(46);
    expect_state(JP_ECU_FAULT);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_SWITCHED_OFF);
    hold(JP_MODE_STAND, 0, 3);
    expect_state(JP_ECU_FAULT);
    expect_refused(3, JP_REFUSAL_FAULT);
    TEST_ASSERT_EQUAL_HEX8(JP_FAULT_BUS_VOLTAGE, bus.last[1][0]);
    hold(JP_MODE_OFF, 0, 4);
    expect_state(JP_ECU_IDLE);
    TEST_ASSERT_EQUAL_HEX8(0, bus.last[1][0]);
    hold(JP_MODE_STAND, 0, 2);
    expect_state(JP_ECU_STANDING);
}

/* Idle it shorts the motors, but not those that another controller drives. */
static void test_bridges_of_another_controller_are_left_to_it(void)
{
    const struct jp_can_frame others = {.id = JP_CAN_MOTOR_COMMAND_FRAME_ID, .length = 8};

    (void)jp_ecu_accept(&ecu, &others);
    run(100);
    TEST_ASSERT_EQUAL_UINT(0, bus.commands);
    hold(JP_MODE_STAND, 0, 2);
    expect_state(JP_ECU_IDLE);
    expect_refused(1, JP_REFUSAL_CONFLICT);
    run(RATE);
    TEST_ASSERT_NOT_EQUAL(0, bus.commands);
    hold(JP_MODE_STAND, 0, 2);
    expect_state(JP_ECU_STANDING);
}

/* What is told */

static void test_pitch_is_that_of_the_ground(void)
{
    struct jp_can_motion_t motion;

    sensors.accel_x = JP_Q24(0.25881904510252074); /* 15° uphill */
    sensors.accel_z = JP_Q24(0.9659258262890683);
    run(5U * RATE);
    TEST_ASSERT_EQUAL_INT(0, jp_can_motion_unpack(&motion, bus.last[5], JP_CAN_LENGTH_MAX));
    TEST_ASSERT_INT16_WITHIN(20, -2731, motion.pitch); /* 2⁻¹⁶ turn */
}

static void test_the_pose_is_that_of_the_odometry(void)
{
    struct jp_can_pose_t pose;

    make_driving();
    drive_to_the_end(7);
    run(RATE);
    TEST_ASSERT_EQUAL_INT(0, jp_can_pose_unpack(&pose, bus.last[4], JP_CAN_LENGTH_MAX));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.03), near_route[1].x, pose.x);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.03), near_route[1].y, pose.y);
    TEST_ASSERT_INT16_WITHIN(40, 512, pose.heading); /* 45°, 2⁻¹² turn */
}

static void test_the_energy_model_is_sent_one_number_after_the_other(void)
{
    int32_t numbers[18];

    TEST_ASSERT_EQUAL_UINT(sizeof numbers, sizeof(struct jp_skid_energy_model));
    memcpy(numbers, &jp_skid_energy_zhang2018, sizeof numbers);
    run(1);
    for (unsigned i = 0; i < 36U; i++) {
        int32_t value;

        run(RATE / 10U);
        memcpy(&value, bus.last[0xE] + 4, sizeof value); /* every host and target is little-endian */
        TEST_ASSERT_EQUAL_UINT8(18, bus.last[0xE][1]);
        TEST_ASSERT_EQUAL_INT32(numbers[bus.last[0xE][0]], value);
    }
    TEST_ASSERT_EQUAL_UINT16(36, bus.counts[0xE]);
}

static void test_what_was_learned_is_told_every_second(void)
{
    struct jp_can_learned_factors_t factors;
    struct jp_can_learned_deviations_t deviations;

    run(5U * RATE);
    for (unsigned kind = 0x18; kind <= 0x19; kind++) {
        TEST_ASSERT_UINT16_WITHIN(1, 5, bus.counts[kind]);
        TEST_ASSERT_EQUAL_UINT16(bus.counts[0x13], bus.counts[kind]);
    }
    TEST_ASSERT_EQUAL_INT(0, jp_can_learned_factors_unpack(&factors, bus.last[0x18], JP_CAN_LENGTH_MAX));
    TEST_ASSERT_EQUAL_INT(0, jp_can_learned_deviations_unpack(&deviations, bus.last[0x19], JP_CAN_LENGTH_MAX));
    TEST_ASSERT_EQUAL_UINT16(4096, factors.rolling);
    TEST_ASSERT_EQUAL_UINT16(4096, factors.electronics);
    TEST_ASSERT_UINT16_WITHIN(1, jp_skid_learning_zhang2018.factors.deviation[JP_SKID_FRICTION] >> 4,
                              deviations.friction);
    TEST_ASSERT_EQUAL_UINT16(0, bus.counts[0x12]); /* a balancer's */
}

static void test_each_leg_of_a_route_is_judged(void)
{
    make_driving();
    drive_to_the_end(7);
    TEST_ASSERT_EQUAL_UINT32(2, skid.pilot.legs_learned_from + skid.pilot.legs_left_out);
    TEST_ASSERT_EQUAL_PTR(&skid.pilot.learner.state, jp_ecu_learned_state(&ecu));
}

/* A robot that its sides steer has one meter: its model is of what leaves the battery. */
static void test_both_energies_are_the_batterys(void)
{
    make_driving();
    run(100);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(bus.last[9], bus.last[9], 8);
    TEST_ASSERT_GREATER_THAN_INT64(0, jp_skid_robot_meter(&skid.robot)->battery);
}

static void expect_stored(enum jp_stored stored)
{
    struct jp_ecu_lessons lessons;

    init();
    jp_ecu_read_lessons(&ecu, &lessons);
    TEST_ASSERT_EQUAL_INT(stored, lessons.stored);
}

static void test_what_is_stored_is_taken_if_it_fits(void)
{
    const struct jp_gyro_scale scale = {10737418, 3000000};
    struct jp_learned_state state;

    jp_learned_state_start(&state, jp_skid_learning_zhang2018.factors.identity);
    state.version = 9;
    tables.state = &state;
    tables.scale = &scale;
    tables.stored = JP_STORED_TAKEN;
    expect_stored(JP_STORED_TAKEN);
    TEST_ASSERT_EQUAL_UINT32(9, jp_ecu_learned_state(&ecu)->version);
    state.identity++;
    expect_stored(JP_STORED_OTHER_TABLES);
    TEST_ASSERT_EQUAL_INT32(scale.error, jp_ecu_skid_gyro_scale(&skid).error);
    TEST_ASSERT_EQUAL_UINT32(0, jp_ecu_learned_state(&ecu)->version);
    state.identity = 0;
    expect_stored(JP_STORED_NOTHING);
    tables.stored = JP_STORED_DAMAGED;
    expect_stored(JP_STORED_DAMAGED);
    TEST_ASSERT_EQUAL_INT32(0, jp_ecu_skid_gyro_scale(&skid).error);
}

/* Lost samples */

static void test_samples_may_stay_away_for_any_number_of_the_hold_ticks(void)
{
    make_driving();
    for (unsigned lost = 1; lost <= HOLD_TICKS; lost++) {
        run_without_samples(lost);
        TEST_ASSERT_TRUE(jp_ecu_runs(&ecu));
        run(60);
        command((uint8_t)ecu.internal.operator_link.mode, 7);
        TEST_ASSERT_TRUE(jp_ecu_runs(&ecu));
    }
    TEST_ASSERT_EQUAL_HEX16(0, faults());
}

static void test_samples_that_stay_away_longer_are_a_fault(void)
{
    make_driving();
    run_without_samples(HOLD_TICKS + config.monitor.confirm_ticks - 1U);
    TEST_ASSERT_TRUE(jp_ecu_runs(&ecu));
    run_without_samples(1);
    expect_state(JP_ECU_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, faults());
    run(2U * RATE);
    expect_rest();
}

static void stand_without_samples(unsigned commands)
{
    for (unsigned i = 0; i < commands; i++) {
        command(JP_MODE_STAND, 0);
        run_without_samples(RATE / 10U);
    }
}

/* Sensors on the bus have a second to start. */
static void test_sensors_that_never_come_are_a_fault_once_it_shall_stand(void)
{
    run_without_samples(2U * RATE);
    expect_state(JP_ECU_IDLE);
    TEST_ASSERT_EQUAL_HEX16(0, faults());
    init();
    stand_without_samples(9);
    expect_state(JP_ECU_IDLE);
    stand_without_samples(3);
    expect_state(JP_ECU_FAULT);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, faults());
    stand_without_samples(1);
    expect_refused(12, JP_REFUSAL_FAULT); /* the first command only begins the sequence */
    run(10);
    expect_state(JP_ECU_FAULT);
    hold(JP_MODE_OFF, 0, 4);
    hold(JP_MODE_STAND, 0, 4);
    expect_state(JP_ECU_STANDING);
}

/* A reset */

static void reset(void)
{
    rolling = skid.robot.internal.control.sides[JP_SKID_LEFT].reference;
    bus.commands = 0;
    bus.receiver = (struct jp_e2e_receiver){.synchronised = false};
    init();
}

/* The wheels roll on while the controller wakes. */
static void check_reset(unsigned ticks)
{
    struct jp_point before;
    struct jp_point after;
    jp_angle heading;

    setUp();
    make_driving();
    run(ticks);
    jp_skid_odometry_now(jp_skid_robot_odometry(&skid.robot), &config.odometry, &before, &heading);
    reset();
    TEST_ASSERT_EQUAL_UINT32(1, ecu.resets);
    expect_operator(JP_OPERATOR_LOST, JP_MODE_STAND);
    run(JP_SKID_WAKE_TICKS + 3U);
    rolling = 0;
    jp_skid_odometry_now(jp_skid_robot_odometry(&skid.robot), &config.odometry, &after, &heading);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.03), before.x, after.x);
    run(2U * RATE);
    expect_state(JP_ECU_STANDING);
    expect_rest();
    TEST_ASSERT_EQUAL_HEX16(0, faults());
    offer(7, near_route, 2);
    hold(JP_MODE_DRIVE, 7, 5);
    expect_state(JP_ECU_STANDING); /* nobody has said Stand */
}

static void test_a_reset_in_any_tick_of_a_drive_brakes_to_a_stand(void)
{
    for (unsigned ticks = 0; ticks < 300U; ticks += 7U) {
        check_reset(ticks);
    }
}

static void test_a_reset_while_it_wakes_after_one_goes_on_too(void)
{
    for (unsigned ticks = 1; ticks < JP_SKID_WAKE_TICKS + 4U; ticks++) {
        setUp();
        make_driving();
        reset();
        run(ticks);
        reset();
        rolling = 0;
        run(2U * RATE);
        expect_state(JP_ECU_STANDING);
        expect_rest();
    }
}

static void test_a_reset_in_idle_stays_idle(void)
{
    run(100);
    reset();
    run(100);
    expect_state(JP_ECU_IDLE);
    expect_operator(JP_OPERATOR_NONE, JP_MODE_OFF);
}

/* It is as good a pose as it was in the fault. */
static void test_a_reset_in_a_fault_keeps_the_pose(void)
{
    struct jp_skid_odometry before;

    make_driving();
    run(RATE);
    sensors.bus_voltage = 0;
    run(RATE);
    expect_state(JP_ECU_FAULT);
    before = *jp_skid_robot_odometry(&skid.robot);
    TEST_ASSERT_TRUE(before.x > 0);
    sensors.bus_voltage = JP_Q16(46);
    reset();
    run(RATE);
    expect_state(JP_ECU_IDLE);
    expect_operator(JP_OPERATOR_NONE, JP_MODE_OFF);
    TEST_ASSERT_EQUAL_INT64(before.x, jp_skid_robot_odometry(&skid.robot)->x);
    TEST_ASSERT_EQUAL_INT64(before.y, jp_skid_robot_odometry(&skid.robot)->y);
    TEST_ASSERT_EQUAL_UINT64(before.heading, jp_skid_robot_odometry(&skid.robot)->heading);
    TEST_ASSERT_EQUAL_INT32(before.steering_ratio, jp_skid_robot_odometry(&skid.robot)->steering_ratio);
}

static void test_after_a_reset_off_is_obeyed_at_once(void)
{
    make_driving();
    reset();
    rolling = 0;
    for (unsigned i = 0; i < 4U; i++) {
        command(JP_MODE_OFF, 0);
        run(1);
    }
    run(2U * RATE);
    expect_state(JP_ECU_IDLE);
    expect_rest();
}

/* Whether it goes on from a record that was changed so. */
static bool goes_on_from(void (*change)(struct jp_skid_snapshot *), enum jp_retained_kind kind)
{
    static union jp_retained_snapshot snapshot;

    setUp();
    make_driving();
    memset(&snapshot, 0, sizeof snapshot);
    jp_skid_robot_snapshot(&skid.robot, &snapshot.skid);
    change(&snapshot.skid);
    jp_retained_write(&retained, kind, &snapshot, 4);
    init();
    TEST_ASSERT_EQUAL_UINT32(5, ecu.resets);
    return ecu.internal.operator_link.state == JP_OPERATOR_LOST;
}

static void nothing(struct jp_skid_snapshot *snapshot)
{
    (void)snapshot;
}

static void other_wheels(struct jp_skid_snapshot *snapshot)
{
    snapshot->way_per_count++;
}

static void other_tick_rate(struct jp_skid_snapshot *snapshot)
{
    snapshot->tick_rate--;
}

static void wild_bias(struct jp_skid_snapshot *snapshot)
{
    snapshot->gyro_bias = INT32_MIN;
}

static void wild_x(struct jp_skid_snapshot *snapshot)
{
    snapshot->x = INT64_MIN;
}

static void wild_y(struct jp_skid_snapshot *snapshot)
{
    snapshot->y = INT64_MAX;
}

static void no_variance(struct jp_skid_snapshot *snapshot)
{
    snapshot->ratio_ratio = 0;
}

static void motors_off(struct jp_skid_snapshot *snapshot)
{
    snapshot->ran = 0;
}

static void neither_on_nor_off(struct jp_skid_snapshot *snapshot)
{
    snapshot->ran = 2;
}

static void test_a_record_goes_on_only_if_it_can_be_this_robots(void)
{
    static void (*const changes[])(struct jp_skid_snapshot *) = {
        other_wheels, other_tick_rate, wild_bias, wild_x, wild_y, no_variance, motors_off, neither_on_nor_off};

    TEST_ASSERT_TRUE(goes_on_from(nothing, JP_RETAINED_SKID));
    TEST_ASSERT_FALSE(goes_on_from(nothing, JP_RETAINED_BALANCER));
    for (unsigned i = 0; i < sizeof changes / sizeof changes[0]; i++) {
        TEST_ASSERT_FALSE(goes_on_from(changes[i], JP_RETAINED_SKID));
    }
}
