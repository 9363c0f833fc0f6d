/* What a skid-steered robot makes of a motion: headings that it missed, slopes, accelerations, duties, and what is left
 * when it ends. */
#include "tests/support/skid_robot_rig.h"

static struct jp_skid_robot_internal *const inside = &robot.internal;

static void drive(jp_q24 speed, jp_q24 turn_rate)
{
    const struct jp_skid_command command = {.motion = {speed, turn_rate}, .duration = JP_Q16(4)};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &command));
}

static jp_turns_per_s reference_of(int side)
{
    return inside->control.sides[side].reference;
}

/** Turns of a wheel that differ by what turns the body. */
static jp_turns_per_s across(void)
{
    return (reference_of(JP_SKID_RIGHT) - reference_of(JP_SKID_LEFT)) / 2;
}

static jp_turns_per_s ahead(void)
{
    return (reference_of(JP_SKID_RIGHT) + reference_of(JP_SKID_LEFT)) / 2;
}

/** One whose gyro shows this more than its wheels turn it. */
static void run_askew(uint32_t ticks, jp_turns_per_s more)
{
    for (uint32_t i = 0; i < ticks; i++) {
        move_wheels();
        sensors.yaw_rate += more;
        jp_skid_robot_tick(&robot, JP_OK, &sensors, &actuation);
    }
}

/* ---- Heading ---- */

/* The sum of what the turn rate has missed, a quarter of a radian at most, times the gain is made up for. */
static void expect_made_up(jp_q24 turn_rate, jp_turns_per_s more)
{
    double missed = 0;

    set_up_rig();
    config.wheels.spin_rate = JP_Q24(1);
    init();
    make_standing();
    drive(JP_Q24(0.4), turn_rate);
    for (int i = 0; i < 2 * RATE; i++) {
        const double measured = telemetry().motion.turn_rate / 16777216.0;

        run_askew(1, more);
        missed += (telemetry().reference.turn_rate / 16777216.0 - measured) / RATE;
        missed = missed > 0.25 ? 0.25 : missed < -0.25 ? -0.25 : missed;
        const double turning = telemetry().reference.turn_rate / 16777216.0 + 2 * missed;

        TEST_ASSERT_INT32_WITHIN(1500, (int32_t)(turning * inside->control.spread), across());
    }
    TEST_ASSERT_TRUE(missed > 0.02 || missed < -0.02);
}

static void test_a_heading_that_was_missed_is_made_up_for(void)
{
    expect_made_up(0, JP_Q24(0.02));
    expect_made_up(JP_Q24(0.2), -JP_Q24(0.02));
    expect_made_up(-JP_Q24(0.2), JP_Q24(0.03));
    expect_made_up(JP_Q24(0.1), JP_Q24(0.1)); /* to the limit */
    expect_made_up(JP_Q24(0.1), -JP_Q24(0.1));
}

static void test_a_stand_forgets_the_heading_that_was_missed(void)
{
    make_standing();
    drive(JP_Q24(0.4), 0);
    run_askew(RATE, JP_Q24(0.005));
    TEST_ASSERT_TRUE(inside->heading_error < -JP_Q24(0.001));
    jp_skid_robot_stop(&robot);
    run(RATE);
    expect_state(JP_SKID_ROBOT_STANDING);
    TEST_ASSERT_EQUAL_INT32(0, inside->heading_error);
    TEST_ASSERT_EQUAL_INT32(0, across());
    run_askew(RATE, JP_Q24(0.005)); /* nor does it turn while it stands */
    TEST_ASSERT_EQUAL_INT32(0, across());
}

static void test_a_turn_to_the_right(void)
{
    make_standing();
    drive(0, -JP_Q24(0.3));
    run(RATE);
    TEST_ASSERT_EQUAL_INT32(-JP_Q24(0.3), telemetry().reference.turn_rate);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.003), -jp_q24_multiply(JP_Q24(0.3), inside->control.spread), across());
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), -JP_Q24(0.3), telemetry().motion.turn_rate);
}

/* ---- Slopes ---- */

/* Treads creep as the slope pulls: κ |v| and Kx |w|, per g. */
static void expect_creep(jp_q24 speed, jp_q24 turn_rate, double rise)
{
    set_up_rig();
    sensors.accel_x = (jp_q24)(rise * JP_Q24_ONE);
    config.odometry.creep = JP_Q24(0.1);
    config.odometry.turn_creep_along = JP_Q24(0.5);
    init();
    make_standing();
    drive(speed, turn_rate);
    run(3 * RATE);
    const double told = telemetry().rise / 16777216.0;
    const double v = telemetry().reference.speed / 16777216.0;
    const double w = telemetry().reference.turn_rate / 16777216.0;
    const double yielding = 0.1 * (v < 0 ? -v : v) + 0.5 * (w < 0 ? -w : w);

    TEST_ASSERT_EQUAL_INT32(speed, telemetry().reference.speed);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), sensors.accel_x, telemetry().rise);
    TEST_ASSERT_INT32_WITHIN(64, (int32_t)((v + yielding * told) * config.control.turns_per_metre), ahead());
}

static void test_treads_are_as_much_faster_as_they_creep(void)
{
    expect_creep(JP_Q24(0.4), 0, 0.1);
    expect_creep(-JP_Q24(0.4), 0, 0.1);
    expect_creep(JP_Q24(0.3), JP_Q24(0.3), -0.1);
    expect_creep(0, -JP_Q24(0.3), 0.1);
}

static void test_a_slope_takes_its_current(void)
{
    sensors.accel_x = JP_Q24(0.1);
    make_standing();
    drive(JP_Q24(0.4), 0);
    run(3 * RATE);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), config.control.rolling + config.control.climbing / 10,
                             inside->control.sides[JP_SKID_LEFT].load);
}

/** The accelerometer feels what the reference does. */
static void run_felt(uint32_t ticks)
{
    for (uint32_t i = 0; i < ticks; i++) {
        sensors.accel_x = jp_q24_multiply(inside->acceleration, JP_Q24(1 / 9.80665));
        run(1);
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0025), 0, telemetry().rise);
    }
}

/* What is felt of its own acceleration is no slope. */
static void test_its_own_acceleration_is_no_slope(void)
{
    jp_q24 before = 0;

    make_standing();
    drive(JP_Q24(0.4), 0);
    for (int i = 0; i < RATE; i++) {
        run_felt(1);
        TEST_ASSERT_EQUAL_INT32((telemetry().reference.speed - before) * RATE, inside->acceleration);
        before = telemetry().reference.speed;
    }
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.4), before);
    jp_skid_robot_stop(&robot);
    run_felt(RATE);
    TEST_ASSERT_EQUAL_INT32(0, inside->acceleration);
}

/* Free of its ground a turn takes what turns the body faster alone. */
static void test_a_turn_that_begins_takes_its_current(void)
{
    config.control.turning = 0;
    config.control.rolling = 0;
    init();
    make_standing();
    drive(0, JP_Q24(0.3));
    run(10);
    const jp_q16 expected = (jp_q16)((int64_t)config.control.turn_acceleration * config.limits.turn_acceleration >> 24);

    TEST_ASSERT_INT32_WITHIN(8, expected, inside->control.sides[JP_SKID_RIGHT].load);
}

/* ---- Duties ---- */

/* Each bridge gives its voltage, whatever the bus has. */
static void test_duties_are_shares_of_the_bus(void)
{
    make_standing();
    drive(JP_Q24(0.3), JP_Q24(0.3));
    for (int i = 0; i < 100; i++) {
        sensors.bus_voltage = JP_Q16(40) + i * JP_Q16(0.1);
        run(1);
        const struct jp_voltages voltages = telemetry().voltages;

        TEST_ASSERT_TRUE(voltages.right > voltages.left);
        TEST_ASSERT_INT32_WITHIN(2, voltages.left, jp_multiply_shift(sensors.bus_voltage, actuation.duty_left, 31));
        TEST_ASSERT_INT32_WITHIN(2, voltages.right, jp_multiply_shift(sensors.bus_voltage, actuation.duty_right, 31));
    }
}

static void expect_nothing_is_given(void)
{
    const struct jp_voltages voltages = telemetry().voltages;

    TEST_ASSERT_EQUAL_INT32(0, voltages.left);
    TEST_ASSERT_EQUAL_INT32(0, voltages.right);
    TEST_ASSERT_FALSE(voltages.saturated);
    TEST_ASSERT_EQUAL_INT32(0, actuation.duty_left);
    TEST_ASSERT_EQUAL_INT32(0, actuation.duty_right);
}

static void test_a_robot_that_has_slowed_down_gives_nothing(void)
{
    make_driving();
    run(RATE / 2);
    jp_skid_robot_disable(&robot);
    run(RATE);
    expect_nothing_is_given();
    TEST_ASSERT_EQUAL_INT32(0, inside->acceleration);
}

/* After a fault at speed it finds out anew how fast it is: bridges off, then it brakes from there. */
static void test_it_wakes_anew_after_a_fault(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        set_up_rig();
        make_standing();
        drive(sign * JP_Q24(0.4), 0);
        run(RATE / 2);
        sensors.bus_voltage = 0;
        run(3);
        sensors.bus_voltage = JP_Q16(46);
        expect_state(JP_SKID_ROBOT_FAULT);
        const struct jp_motion before = telemetry().reference;

        driven_rate = sign * JP_Q24(0.3);
        jp_skid_robot_disable(&robot);
        run(2);
        const struct jp_motion then = telemetry().reference;

        TEST_ASSERT_TRUE(sign * then.speed < sign * before.speed);
        for (int i = 0; i < JP_SKID_WAKE_TICKS - 1; i++) {
            run(1);
            TEST_ASSERT_EQUAL_UINT8(0, actuation.enabled);
            expect_nothing_is_given();
            TEST_ASSERT_EQUAL_INT32(then.speed, telemetry().reference.speed);
        }
        run(1);
        const jp_q24 found = telemetry().reference.speed;

        expect_nothing_is_given();
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), sign * jp_q24_divide(JP_Q24(0.3), config.control.turns_per_metre),
                                 found);
        run(10);
        TEST_ASSERT_EQUAL_INT32(found - sign * 10 * inside->braking.speed_step, telemetry().reference.speed);
        TEST_ASSERT_TRUE(sign * actuation.duty_right > 0);
    }
}

/* Counts of its first frame are no motion; of one that was reset in motion it finds the speed, and brakes. */
static void test_it_wakes_at_any_counts(void)
{
    angles[JP_SKID_LEFT] = 5 * JP_PHASE_TURN;
    angles[JP_SKID_RIGHT] = 9 * JP_PHASE_TURN;
    wake();
    TEST_ASSERT_EQUAL_INT32(0, telemetry().reference.speed);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().reference.turn_rate);
    TEST_ASSERT_EQUAL_INT64(0, telemetry().x);
    set_up_rig();
    driven_rate = JP_Q24(0.3);
    run(JP_SKID_WAKE_TICKS + 1);
    const jp_q24 found = telemetry().reference.speed;

    TEST_ASSERT_TRUE(found > 0);
    run(10);
    TEST_ASSERT_EQUAL_INT32(found - 10 * inside->braking.speed_step, telemetry().reference.speed);
}

/* ---- What is left behind ---- */

/* A wheel that was held has its way behind it: enabled again it does not make up for it. */
static void test_a_stand_begins_without_the_way_behind(void)
{
    make_standing();
    held[JP_SKID_LEFT] = true;
    drive(JP_Q24(0.1), 0);
    run(20);
    TEST_ASSERT_TRUE(inside->control.sides[JP_SKID_LEFT].behind != 0);
    jp_skid_robot_disable(&robot);
    run(RATE / 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
    run(1);
    expect_state(JP_SKID_ROBOT_STANDING);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), 0, telemetry().voltages.left);
    TEST_ASSERT_TRUE(inside->control.sides[JP_SKID_LEFT].behind == 0);
}

/* A stall stops both sides in the tick in which it is found, and nothing pushes on. */
static void test_a_stall_lets_go(void)
{
    make_standing();
    held[JP_SKID_LEFT] = true;
    drive(JP_Q24(0.4), JP_Q24(0.01));
    run(1);
    while (jp_skid_robot_state_now(&robot) == JP_SKID_ROBOT_DRIVING) {
        run(1);
    }
    expect_state(JP_SKID_ROBOT_FAULT);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().reference.speed);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().reference.turn_rate);
    TEST_ASSERT_EQUAL_INT32(0, inside->acceleration);
    TEST_ASSERT_EQUAL_INT32(0, inside->heading_error);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.5), 0, telemetry().voltages.left);
    TEST_ASSERT_TRUE(inside->control.sides[JP_SKID_LEFT].behind == 0);
    TEST_ASSERT_EQUAL_INT32(inside->control.sides[JP_SKID_LEFT].load, inside->control.sides[JP_SKID_RIGHT].load);
}

static void test_commands_are_counted(void)
{
    make_standing();
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().commands);
    for (uint16_t i = 1; i < 4; i++) {
        drive(JP_Q24(0.1), 0);
        run(5);
        TEST_ASSERT_EQUAL_UINT16(i, telemetry().commands);
    }
}

/* Rounded to ticks; a part of one is still a command. */
static void test_durations_are_rounded_to_ticks(void)
{
    struct jp_skid_command command = {.motion = {JP_Q24(0.1), 0}, .duration = 1};

    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &command));
    command.duration = 203; /* 1.549 ticks */
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &command));
    run(1);
    TEST_ASSERT_EQUAL_UINT32(1, telemetry().command_ticks_left);
    command.duration = 190; /* 1.450 */
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &command));
    run(1);
    TEST_ASSERT_EQUAL_UINT32(0, telemetry().command_ticks_left);
}

static void test_what_waits_is_forgotten_by_a_fault_and_a_disable(void)
{
    make_driving();
    sensors.bus_voltage = 0;
    run(2);
    drive(JP_Q24(0.2), 0);
    run(1);
    expect_state(JP_SKID_ROBOT_FAULT);
    TEST_ASSERT_FALSE(jp_skid_robot_has_next(&robot));
    set_up_rig();
    make_driving();
    drive(JP_Q24(0.2), 0);
    jp_skid_robot_disable(&robot);
    TEST_ASSERT_FALSE(jp_skid_robot_has_next(&robot));
    run(1);
    TEST_ASSERT_EQUAL_UINT16(1, telemetry().commands);
}

/* As jp_skid_robot_drive() leaves it that was interrupted by the tick of a disable. */
static void test_a_command_that_comes_too_late_is_not_driven(void)
{
    wake();
    inside->next = (struct jp_skid_next){.motion = {JP_Q24(0.2), 0}, .speed_step = 1000, .ticks = 100};
    inside->next_full = 1;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
    run(5);
    expect_state(JP_SKID_ROBOT_STANDING);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().reference.speed);
}

/* In whichever tick of a step of the odometry, and in every tick after it. */
static void test_position_never_jumps_when_it_is_disabled(void)
{
    for (uint32_t phase = 0; phase < config.odometry.step_ticks; phase++) {
        set_up_rig();
        make_driving();
        run(RATE / 4 + phase);
        jp_skid_robot_disable(&robot);
        for (int i = 0; i < 20; i++) {
            const int64_t before = telemetry().x;

            run(1);
            TEST_ASSERT_TRUE(telemetry().x >= before);
            TEST_ASSERT_TRUE(telemetry().x - before < (int64_t)1 << 26);
        }
    }
}

/* ---- What it knows ---- */

static void test_a_scale_of_the_gyro_that_was_learned_is_known(void)
{
    const struct jp_gyro_scale known = {(int32_t)1 << 23, (int32_t)1 << 22};
    struct jp_gyro_scale told;

    jp_skid_robot_know_gyro_scale(&robot, &known);
    jp_skid_odometry_scale(jp_skid_robot_odometry(&robot), &config.odometry, &told);
    TEST_ASSERT_EQUAL_INT32(known.error, told.error);
}

/* What a tread does is judged with the steering ratio as it is learned now. */
static void test_the_steering_ratio_that_was_learned_spreads_the_sides(void)
{
    struct jp_skid_snapshot snapshot;
    const jp_q24 turn = jp_q24_divide(jp_q24_multiply(JP_Q24(0.9), config.odometry.ratio), JP_Q24(0.35));
    const struct jp_skid_command command = {.motion = {0, turn}, .duration = JP_Q16(1)};

    config.odometry.scale_deviation = 0; /* what it learns is the wheels' */
    init();
    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &command));
    jp_skid_robot_snapshot(&robot, &snapshot);
    snapshot.steering_ratio -= snapshot.steering_ratio / 4;
    snapshot.ratio -= snapshot.ratio / 4;
    init();
    TEST_ASSERT_TRUE(jp_skid_robot_resume(&robot, &snapshot));
    make_standing();
    run(20);
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, jp_skid_robot_drive(&robot, &command));
    TEST_ASSERT_INT32_WITHIN(64, jp_q24_divide(config.control.turns_per_radian, telemetry().steering_ratio),
                             inside->control.spread);
}

/* Pitch forward is positive, so uphill is negative: a slope of 0.1 is 5.7° of a turn. */
static void test_pitch_is_that_of_the_ground(void)
{
    sensors.accel_x = JP_Q24(0.1);
    sensors.accel_z = JP_Q24(0.995);
    wake();
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0001), -JP_Q24(5.739 / 360), jp_skid_robot_pitch(&robot));
    set_up_rig();
    sensors.accel_x = -JP_Q24(0.1);
    sensors.accel_z = JP_Q24(0.995);
    wake();
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0001), JP_Q24(5.739 / 360), jp_skid_robot_pitch(&robot));
}

/* What a motor generates is burnt by the share of the file. */
static void test_bridges_burn_what_braking_generates(void)
{
    jp_energy taken[2];

    for (int i = 0; i < 2; i++) {
        set_up_rig();
        config.burnt = i * JP_Q16_ONE;
        init();
        sensors.accel_x = -JP_Q24(0.2); /* downhill */
        make_standing();
        drive(JP_Q24(0.6), 0);
        run(2 * RATE);
        taken[i] = telemetry().energy;
    }
    TEST_ASSERT_TRUE(taken[1] > taken[0] + (taken[0] < 0 ? -taken[0] : taken[0]) / 100);
}
