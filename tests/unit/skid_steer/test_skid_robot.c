/* The skid-steered robot: its configuration, its states, its commands. */
#include "tests/support/config_check.h"
#include "tests/support/skid_robot_rig.h"

/* Configuration */

static void test_init_refuses_null(void)
{
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_robot_init(NULL, &config, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_robot_init(&robot, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_robot_init(&robot, &config, NULL));
}

static enum jp_status init_as(const struct jp_skid_robot_config *tried, const char **field)
{
    return jp_skid_robot_init(&robot, tried, field);
}

DEFINE_EXPECT_CONFIG_OF(init_as, jp_skid_robot_zhang2018)

static void test_init_checks_every_part(void)
{
    const char *field = "";

    config = jp_skid_robot_zhang2018;
    expect_config(NULL);
    FIELD(odometry.step_ticks, 0, "odometry.step_ticks");
    FIELD(control.back_emf, 0, "control.back_emf");
    FIELD(monitor.tilt_limit, 0, "monitor.tilt_limit");
    FIELD(monitor.half_track, JP_Q16_ONE - 1, "monitor.half_track");
    FIELD(monitor.half_track, JP_Q16_ONE + 1, "monitor.half_track");
    FIELD(wheels.smoothing, 0, "wheels.smoothing");
    FIELD(meter.electronics_power, -1, "meter.electronics_power");
    FIELD(odometry.tick_rate, 499, "control.tick_rate");
    FIELD(meter.tick_rate, 501, "control.tick_rate");
    RANGE("", limits.speed, 1, JP_Q24(8));
    RANGE("", limits.acceleration, JP_Q24(0.01), JP_Q24(64));
    RANGE("", limits.turn_acceleration, JP_Q24(0.01), JP_Q24(64));
    RANGE("", heading_gain, 0, JP_Q24(16));
    config = jp_skid_robot_burger;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_init(&robot, &config, &field));
    TEST_ASSERT_EQUAL_PTR(&config, jp_skid_robot_configuration(&robot));
}

/* On and off */

static void test_starts_idle_and_stays(void)
{
    TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_IDLE, jp_skid_robot_state_now(&robot));
    run(100);
    expect_state(JP_SKID_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_UINT32(100, telemetry().tick);
}

static void test_enable_refuses_null_and_needs_a_frame(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_robot_enable(NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_enable(&robot));
    tick_read(JP_ERR_HARDWARE);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_enable(&robot));
    make_standing();
}

static void test_enable_only_from_idle(void)
{
    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_enable(&robot));
    setUp();
    make_driving();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_enable(&robot));
    setUp();
    make_fault();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_enable(&robot));
}

static void test_enable_is_refused_where_it_is_too_steep(void)
{
    sensors.accel_x = JP_Q24(0.4);
    wake();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_enable(&robot));
    set_up_rig();
    sensors.accel_x = -JP_Q24(0.4);
    wake();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_enable(&robot));
    set_up_rig();
    sensors.accel_z = JP_Q24(0.8);
    wake();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_enable(&robot));
}

/** Off, without its faults; then on again. */
static void disable(void)
{
    jp_skid_robot_disable(&robot);
    run(1);
    expect_state(JP_SKID_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().faults);
    run(RATE / 5);
    expect_state(JP_SKID_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
    run(RATE / 2);
    expect_state(JP_SKID_ROBOT_STANDING);
}

static void test_disable_leads_to_idle_from_every_state(void)
{
    wake();
    disable();
    setUp();
    make_standing();
    disable();
    setUp();
    make_driving();
    disable();
    setUp();
    make_fault();
    disable();
}

static void test_position_does_not_jump_when_it_is_disabled(void)
{
    make_driving();
    run(RATE);
    const int64_t before = telemetry().x;

    jp_skid_robot_disable(&robot);
    run(40);
    TEST_ASSERT_TRUE(telemetry().x >= before);
    TEST_ASSERT_TRUE(telemetry().x - before < (int64_t)1 << 28);
}

/** As a command brakes: shorted at speed the motors could tip the robot over. */
static void test_a_disable_at_speed_brakes_gently(void)
{
    make_driving();
    run(RATE / 2);
    const jp_q24 speed = telemetry().reference.speed;

    jp_skid_robot_disable(&robot);
    run(RATE / 10);
    expect_state(JP_SKID_ROBOT_IDLE);
    TEST_ASSERT_INT32_WITHIN(100, speed - config.limits.acceleration / 10, telemetry().reference.speed);
    TEST_ASSERT_TRUE(actuation.duty_left > 0);
    TEST_ASSERT_FALSE(robot.internal.controlled);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot)); /* and goes on braking */
    run(1);
    expect_state(JP_SKID_ROBOT_STANDING);
    run(1);
    expect_state(JP_SKID_ROBOT_DRIVING);
    run(RATE / 2);
    expect_state(JP_SKID_ROBOT_STANDING);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().reference.speed);
}

static void test_disable_after_enable_wins(void)
{
    wake();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
    jp_skid_robot_disable(&robot);
    run(10);
    expect_state(JP_SKID_ROBOT_IDLE);

    jp_skid_robot_disable(&robot);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
    run(1);
    expect_state(JP_SKID_ROBOT_STANDING);
}

/** Bridges are off until the speed is known from which a robot brakes that was reset in motion. */
static void test_wakes_in_motion_and_brakes(void)
{
    make_driving();
    run(RATE / 2);
    const jp_q24 speed = telemetry().reference.speed;
    const uint32_t counts =
        1 + (uint32_t)(jp_phase_step(robot.internal.control.sides[JP_SKID_LEFT].reference, jp_phase_per_rate(RATE)) /
                       config.control.wheel_per_count);

    init();
    for (int i = 0; i < JP_SKID_WAKE_TICKS + 1; i++) {
        sensors.encoder_left += counts;
        sensors.encoder_right += counts;
        jp_skid_robot_tick(&robot, JP_OK, &sensors, &actuation);
        TEST_ASSERT_EQUAL_UINT8(0, actuation.enabled);
        TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, i < JP_SKID_WAKE_TICKS ? jp_skid_robot_enable(&robot) : JP_ERR_STATE);
    }
    TEST_ASSERT_INT32_WITHIN(speed / 50, speed, telemetry().reference.speed);
    jp_skid_robot_tick(&robot, JP_OK, &sensors, &actuation);
    TEST_ASSERT_EQUAL_UINT8(1, actuation.enabled);
    TEST_ASSERT_TRUE(actuation.duty_left > 0);
}

static void test_bridges_short_the_motors_of_a_robot_without_frames(void)
{
    for (int i = 0; i < JP_SKID_WAKE_TICKS; i++) {
        tick_read(JP_ERR_HARDWARE);
        TEST_ASSERT_EQUAL_UINT8(0, actuation.enabled);
    }
    tick_read(JP_ERR_HARDWARE);
    TEST_ASSERT_EQUAL_UINT8(1, actuation.enabled);
    TEST_ASSERT_EQUAL_INT32(0, actuation.duty_left);
}

/* Commands */

static enum jp_status drive(jp_q24 speed, jp_q24 turn_rate, jp_q16 duration)
{
    const struct jp_skid_command command = {.motion = {speed, turn_rate}, .duration = duration};

    return jp_skid_robot_drive(&robot, &command);
}

static void test_drive_refuses_what_is_out_of_range(void)
{
    struct jp_skid_command command = one_second;

    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_robot_drive(NULL, &one_second));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_robot_drive(&robot, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, drive(JP_Q24(8) + 1, 0, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, drive(0, -JP_Q24(8) - 1, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, drive(0, 0, 0));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, drive(0, 0, JP_Q16(16384) + 1));
    command.acceleration = config.limits.acceleration + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_robot_drive(&robot, &command));
    command.acceleration = -1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_robot_drive(&robot, &command));
    command.acceleration = 0;
    command.turn_acceleration = config.limits.turn_acceleration + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_robot_drive(&robot, &command));
    TEST_ASSERT_EQUAL_INT(JP_OK, drive(JP_Q24(0.1), 0, JP_Q16(16384)));
}

static void test_drive_needs_motors_that_run(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_drive(&robot, &one_second));
    make_fault();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_drive(&robot, &one_second));
}

/* No tread is faster than limits.speed, 1 m/s: on the spot a tread does w B/(2χ). */
static void test_drive_refuses_what_a_tread_cannot(void)
{
    const jp_q24 turn = jp_q24_divide(config.limits.speed, jp_q24_divide(JP_Q24(0.35), config.odometry.ratio));

    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, drive(config.limits.speed, 0, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, drive(config.limits.speed + 1, 0, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, drive(-config.limits.speed - 1, 0, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_OK, drive(0, turn - 100, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, drive(0, turn + 100, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, drive(0, -turn - 100, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, drive(config.limits.speed / 2 + 100, turn / 2 + 100, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_OK, drive(config.limits.speed / 2 - 100, turn / 2 - 100, JP_Q16(1)));
}

static void test_drives_for_the_duration_then_brakes_and_stands(void)
{
    make_driving();
    run(RATE - 1);
    TEST_ASSERT_EQUAL_UINT32(0, telemetry().command_ticks_left);
    TEST_ASSERT_EQUAL_INT32(one_second.motion.speed, telemetry().reference.speed);
    expect_state(JP_SKID_ROBOT_DRIVING);
    run(1);
    TEST_ASSERT_EQUAL_INT32(one_second.motion.speed - robot.internal.braking.speed_step, telemetry().reference.speed);
    run(RATE / 2);
    expect_state(JP_SKID_ROBOT_STANDING);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().reference.speed);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().command.speed);
}

static void test_turns_on_the_spot_then_brakes_and_stands(void)
{
    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, drive(0, JP_Q24(0.3), JP_Q16(1)));
    run(RATE);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.3), telemetry().motion.turn_rate);
    run(10);
    expect_state(JP_SKID_ROBOT_DRIVING);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().reference.speed);
    TEST_ASSERT_TRUE(telemetry().reference.turn_rate > 0);
    run(RATE / 2);
    expect_state(JP_SKID_ROBOT_STANDING);
}

static void test_speeds_up_with_the_limit_or_as_asked(void)
{
    struct jp_skid_command slow = one_second;

    make_driving();
    run(99);
    TEST_ASSERT_INT32_WITHIN(100, config.limits.acceleration / 5, telemetry().reference.speed);

    slow.acceleration = config.limits.acceleration / 4;
    slow.motion.turn_rate = JP_Q24(0.3);
    slow.turn_acceleration = config.limits.turn_acceleration / 8;
    setUp();
    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &slow));
    run(100);
    TEST_ASSERT_INT32_WITHIN(200, config.limits.acceleration / 20, telemetry().reference.speed);
    TEST_ASSERT_INT32_WITHIN(200, config.limits.turn_acceleration / 40, telemetry().reference.turn_rate);
}

/** A tick's share of the acceleration is rounded up. */
static void test_a_tick_changes_the_speed_by_its_share(void)
{
    for (int32_t more = 0; more < 2; more++) {
        set_up_rig();
        config.limits.acceleration = 1000 * RATE + more;
        init();
        make_driving();
        run(10);
        const jp_q24 before = telemetry().reference.speed;
        run(1);
        TEST_ASSERT_EQUAL_INT32(1000 + more, telemetry().reference.speed - before);
    }
}

static void test_a_command_replaces_the_one_before_it(void)
{
    make_driving();
    run(RATE / 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, drive(JP_Q24(0.1), 0, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_OK, drive(-JP_Q24(0.2), 0, JP_Q16(2)));
    run(1);
    TEST_ASSERT_EQUAL_INT32(-JP_Q24(0.2), telemetry().command.speed);
    TEST_ASSERT_EQUAL_UINT32(2 * RATE - 1, telemetry().command_ticks_left);
    run(RATE);
    TEST_ASSERT_EQUAL_INT32(-JP_Q24(0.2), telemetry().reference.speed);
}

static void test_a_stream_of_commands_keeps_it_going(void)
{
    make_standing();
    for (int i = 0; i < 20; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, drive(JP_Q24(0.2), 0, JP_Q16(0.2)));
        run(RATE / 10);
    }
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.2), telemetry().reference.speed);
    run(RATE / 2);
    expect_state(JP_SKID_ROBOT_STANDING);
}

static void test_stop_brakes_and_forgets_what_waits(void)
{
    make_driving();
    run(RATE / 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, drive(JP_Q24(0.3), 0, JP_Q16(5)));
    jp_skid_robot_stop(&robot);
    run(1);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().command.speed);
    run(RATE / 2);
    expect_state(JP_SKID_ROBOT_STANDING);
    run(RATE);
    expect_state(JP_SKID_ROBOT_STANDING);
}

static void test_stop_of_a_robot_that_rests_does_nothing(void)
{
    wake();
    jp_skid_robot_stop(&robot);
    run(2);
    expect_state(JP_SKID_ROBOT_IDLE);
    make_driving();
    expect_state(JP_SKID_ROBOT_DRIVING);
}

static void test_a_command_does_not_survive_a_disable(void)
{
    make_driving();
    TEST_ASSERT_EQUAL_INT(JP_OK, drive(JP_Q24(0.3), 0, JP_Q16(5)));
    jp_skid_robot_disable(&robot);
    run(5);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
    run(50);
    expect_state(JP_SKID_ROBOT_STANDING);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().reference.speed);
}

static void test_stopping_distance(void)
{
    const jp_q24 expected = JP_Q24(0.25 / 2 * 9 / 8 + 0.5 * 4 / RATE);

    config.limits.acceleration = JP_Q24(1);
    TEST_ASSERT_INT32_WITHIN(4, expected, jp_skid_robot_stopping_distance(&config, JP_Q24(0.5)));
    TEST_ASSERT_INT32_WITHIN(4, expected, jp_skid_robot_stopping_distance(&config, -JP_Q24(0.5)));
    TEST_ASSERT_EQUAL_INT32(0, jp_skid_robot_stopping_distance(&config, 0));
    config.limits.acceleration = JP_Q24(0.01);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_skid_robot_stopping_distance(&config, JP_Q24(8)));

    config.limits.acceleration = JP_Q24(64); /* the greatest: twice as much has no format */
    config.control.tick_rate = 1000;
    TEST_ASSERT_INT32_WITHIN(4, JP_Q24(0.5625) + JP_Q24(0.032), jp_skid_robot_stopping_distance(&config, JP_Q24(8)));
}

/* What it tells */

static void test_telemetry_tells_of_motion_and_energy(void)
{
    make_driving();
    run(RATE - 1);
    const struct jp_skid_telemetry told = telemetry();

    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), one_second.motion.speed, told.motion.speed);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), 0, told.motion.turn_rate);
    TEST_ASSERT_TRUE(told.x > (int64_t)1 << 30);
    TEST_ASSERT_TRUE(told.x < (int64_t)1 << 31);
    TEST_ASSERT_TRUE(told.energy > jp_skid_robot_meter(&robot)->electronics_tick * RATE);
    TEST_ASSERT_EQUAL_INT32(robot.internal.odometry.steering_ratio, told.steering_ratio);
    TEST_ASSERT_EQUAL_PTR(&robot.internal.odometry, jp_skid_robot_odometry(&robot));
    TEST_ASSERT_EQUAL_UINT32(0, told.saturated_ticks);
    TEST_ASSERT_EQUAL_UINT32(0, told.dropped_frames);
}

static void test_no_telemetry_within_a_tick(void)
{
    struct jp_skid_telemetry told;

    jp_skid_robot_control(&robot, JP_OK, &sensors, &actuation);
    TEST_ASSERT_FALSE(jp_skid_robot_telemetry(&robot, &told));
    jp_skid_robot_account(&robot);
    TEST_ASSERT_TRUE(jp_skid_robot_telemetry(&robot, &told));
}

static void test_counts_saturated_ticks_and_dropped_frames(void)
{
    make_standing();
    held[JP_SKID_LEFT] = true;
    TEST_ASSERT_EQUAL_INT(JP_OK, drive(JP_Q24(0.9), 0, JP_Q16(1)));
    run(100);
    TEST_ASSERT_TRUE(telemetry().saturated_ticks > 10);
    tick_read(JP_ERR_HARDWARE);
    TEST_ASSERT_EQUAL_UINT32(1, telemetry().dropped_frames);
}
