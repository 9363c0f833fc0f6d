/* The control tick of a robot with four steered wheels: what it believes of its sensors, what it tells its drives, how
 * it counts its way and its energy, and how it goes on after faults and resets. */
#include <joulepath/four_wheel_robot.h>
#include <stddef.h>

#include "tests/support/config_check.h"
#include "unity.h"

#define DEGREES(x) ((int32_t)JP_ANGLE_DEGREES(x))
#define RATE       100
#define COUNT_M    (0.6283185307179586 / 51200)

static const struct jp_four_wheel_robot_config usual = {
    .wheels = {.wheelbase = JP_Q24(0.5),
               .track = JP_Q24(0.44),
               .steering_limit = DEGREES(100),
               .steering_step = DEGREES(1.7),
               .speed_max = JP_Q24(1.5),
               .speed_step = JP_Q24(0.01)},
    .tick_rate = RATE,
    .count_speed = (int32_t)(COUNT_M * RATE * 4294967296.0),
    .piece_ticks = 20,
    .twist_ticks = 30,
    .limits = {.count_jump = 2445,
               .current = JP_Q16(37.5),
               .voltage_min = JP_Q16(18),
               .voltage_max = JP_Q16(30),
               .speed_lag = JP_Q24(0.375),
               .angle_lag = DEGREES(20),
               .lag_ticks = 50,
               .confirm_ticks = 4},
};

static const struct jp_twist ahead = {.x = JP_Q24(0.5)};
static const struct jp_twist rest = {0, 0, 0};

static struct jp_four_wheel_robot_config config;
static struct jp_four_wheel_robot robot;
static struct jp_four_wheel_sensors sensors;
static struct jp_four_wheel_actuation actuation;
static struct jp_four_wheel_telemetry telemetry;
static int64_t rolled[JP_WHEELS]; /* 2⁻²⁴ of a count */
static const char *refused;

static void start(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_init(&robot, &config, &refused));
    sensors = (struct jp_four_wheel_sensors){.bus_voltage = JP_Q16(24), .bus_current = JP_Q16(2)};
    for (int i = 0; i < JP_WHEELS; i++) {
        rolled[i] = 0;
    }
}

void setUp(void)
{
    config = usual;
    start();
}

void tearDown(void)
{
}

static void look(void)
{
    TEST_ASSERT_TRUE(jp_four_wheel_robot_telemetry(&robot, &telemetry));
}

static void tick(enum jp_status read)
{
    jp_four_wheel_robot_control(&robot, read, &sensors, &actuation);
    TEST_ASSERT_FALSE(jp_four_wheel_robot_telemetry(&robot, &telemetry));
    jp_four_wheel_robot_account(&robot);
    look();
}

/* Drives that do at once what they are told. */
static void obey(void)
{
    for (int i = 0; i < JP_WHEELS && actuation.enabled != 0; i++) {
        const int64_t each = (int64_t)actuation.wheels.speed[i] * ((int64_t)1 << 32) / config.count_speed;

        rolled[i] += each;
        sensors.count[i] = (uint32_t)(uint64_t)(rolled[i] >> 24);
        sensors.angle[i] = actuation.wheels.angle[i];
    }
}

static void drive(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        obey();
        tick(JP_OK);
    }
}

static void renew(const struct jp_twist *twist, unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_drive(&robot, twist));
        drive(1);
    }
}

static void stand(void)
{
    tick(JP_OK);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_enable(&robot));
    tick(JP_OK);
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_STANDING, telemetry.state);
}

static enum jp_status check(const struct jp_four_wheel_robot_config *of, const char **field)
{
    return jp_four_wheel_robot_init(&robot, of, field);
}

DEFINE_EXPECT_CONFIG_OF(check, usual)

static void test_the_configuration_is_checked(void)
{
    expect_config(NULL);
    RANGE("", tick_rate, 100, 10000);
    config = usual;
    config.count_speed = 0;
    expect_config("count_speed");
    RANGE("", twist_ticks, 1, 10000);
    RANGE("", limits.count_jump, 1, UINT16_MAX);
    RANGE("", limits.confirm_ticks, 1, 100);
    config.limits.current = 0;
    expect_config("limits.current");
    config.limits.current = JP_Q16(2000);
    expect_config("limits.current");
    config.limits.voltage_min = 0;
    expect_config("limits.voltage_min");
    config.limits.voltage_max = config.limits.voltage_min;
    expect_config("limits.voltage_max");
    config.limits.speed_lag = 0;
    expect_config("limits.speed_lag");
    config.limits.angle_lag = 0;
    expect_config("limits.angle_lag");
    config.limits.lag_ticks = 0;
    expect_config("limits.lag_ticks");
    config.piece_ticks = 0;
    expect_config("four_wheel_trip.piece_ticks");
    config.wheels.track = 0;
    expect_config("track");
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_robot_init(NULL, &usual, &refused));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_robot_init(&robot, NULL, &refused));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_robot_init(&robot, &usual, NULL));
}

static void test_ticks_are_counted(void)
{
    for (uint32_t i = 1; i <= 5U; i++) {
        tick(i == 3U ? JP_ERR_STATE : JP_OK);
        TEST_ASSERT_EQUAL_UINT32(i, telemetry.tick);
    }
}

/* Wherever the encoders begin, the first frame is no motion. */
static void test_the_first_frame_moves_nothing(void)
{
    for (int i = 0; i < JP_WHEELS; i++) {
        sensors.count[i] = 123456U * (uint32_t)(i + 1);
    }
    tick(JP_OK);
    TEST_ASSERT_EQUAL_INT32(0, telemetry.odometry.twist.x);
    TEST_ASSERT_EQUAL_INT32(0, telemetry.odometry.twist.turn_rate);
    TEST_ASSERT_EQUAL_INT64(0, telemetry.odometry.x);
    TEST_ASSERT_EQUAL_INT64(0, telemetry.odometry.y);
}

/* What was asked for before is not done after it. */
static void test_a_disable_takes_an_enable_back(void)
{
    tick(JP_OK);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_enable(&robot));
    jp_four_wheel_robot_disable(&robot);
    for (int i = 0; i < 3; i++) {
        tick(JP_OK);
        TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_IDLE, telemetry.state);
        TEST_ASSERT_EQUAL_UINT32(0, actuation.enabled);
    }
}

/* Nor what was asked for while it failed. */
static void test_an_enable_of_a_tick_that_fails_is_over(void)
{
    tick(JP_OK);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_enable(&robot));
    for (uint32_t i = 0; i <= config.limits.confirm_ticks; i++) {
        tick(JP_ERR_HARDWARE);
    }
    jp_four_wheel_robot_disable(&robot);
    for (int i = 0; i < 4; i++) {
        tick(JP_OK);
    }
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_IDLE, telemetry.state);
}

/* Any motion that is told is driving, from the first tick on, while wheels are steered at a stand, too. */
static void test_any_motion_is_driving(void)
{
    static const struct jp_twist twists[] = {
        {JP_Q24(0.3), 0, 0},  {-JP_Q24(0.3), 0, 0}, {0, JP_Q24(0.3), 0},
        {0, -JP_Q24(0.3), 0}, {0, 0, JP_Q24(0.5)},  {0, 0, -JP_Q24(0.5)},
    };

    for (unsigned i = 0; i < sizeof twists / sizeof twists[0]; i++) {
        start();
        stand();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_drive(&robot, &twists[i]));
        drive(1);
        TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_DRIVING, telemetry.state);
        renew(&twists[i], 100);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_drive(&robot, &rest));
        drive(1);
        TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_DRIVING, telemetry.state); /* until its wheels have stopped */
        drive(100);
        TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_STANDING, telemetry.state);
    }
}

/* Angle by angle and wheel by wheel. */
static void test_each_wheel_of_a_snapshot_is_looked_at(void)
{
    struct jp_four_wheel_snapshot sound;

    stand();
    renew(&ahead, 20);
    jp_four_wheel_robot_snapshot(&robot, &sound);
    for (int i = 0; i < JP_WHEELS; i++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            struct jp_four_wheel_snapshot snapshot = sound;

            snapshot.wheels.angle[i] = sign * config.wheels.steering_limit;
            snapshot.wheels.speed[i] = sign * config.wheels.speed_max;
            start();
            TEST_ASSERT_TRUE(jp_four_wheel_robot_resume(&robot, &snapshot));
            start();
            snapshot.wheels.angle[i] += sign;
            TEST_ASSERT_FALSE(jp_four_wheel_robot_resume(&robot, &snapshot));
            snapshot.wheels.angle[i] = 0;
            snapshot.wheels.speed[i] += sign;
            TEST_ASSERT_FALSE(jp_four_wheel_robot_resume(&robot, &snapshot));
        }
    }
}

/* Beyond the limit of the steering and what a wheel may lag behind. */
static void test_each_wheel_has_angles_that_cannot_be(void)
{
    for (int i = 0; i < JP_WHEELS; i++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            const bool is_left = i == (int)JP_FRONT_LEFT || i == (int)JP_REAR_LEFT;

            start();
            stand();
            sensors.angle[i] = sign * (DEGREES(120) + 2);
            for (int k = 0; k < 8; k++) {
                tick(JP_OK);
            }
            TEST_ASSERT_EQUAL_HEX16(is_left ? JP_FAULT_ENCODER_LEFT : JP_FAULT_ENCODER_RIGHT, telemetry.faults);
        }
    }
}

static void test_it_is_idle_and_off_until_it_is_enabled(void)
{
    TEST_ASSERT_NULL(jp_four_wheel_robot_good_frame(&robot));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_four_wheel_robot_enable(&robot));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_robot_enable(NULL));
    sensors.angle[0] = DEGREES(30);
    tick(JP_OK);
    TEST_ASSERT_NOT_NULL(jp_four_wheel_robot_good_frame(&robot));
    TEST_ASSERT_EQUAL_UINT8(0, actuation.enabled);
    TEST_ASSERT_EQUAL_INT32(DEGREES(30), actuation.wheels.angle[0]);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_four_wheel_robot_drive(&robot, &ahead));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_enable(&robot));
    tick(JP_OK);
    TEST_ASSERT_EQUAL_UINT8(1, actuation.enabled);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_four_wheel_robot_enable(&robot));
    TEST_ASSERT_EQUAL_PTR(&config, jp_four_wheel_robot_configuration(&robot));
}

static void test_a_disable_takes_back_an_enable(void)
{
    jp_four_wheel_robot_disable(&robot);
    tick(JP_ERR_HARDWARE);
    TEST_ASSERT_NULL(jp_four_wheel_robot_good_frame(&robot));
    tick(JP_OK);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_enable(&robot));
    jp_four_wheel_robot_disable(&robot);
    tick(JP_OK);
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_IDLE, telemetry.state);
}

static void test_it_drives_the_twist_that_it_is_given(void)
{
    stand();
    renew(&ahead, 200);
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_DRIVING, telemetry.state);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.002), ahead.x, telemetry.odometry.twist.x);
    renew(&rest, 100);
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_STANDING, telemetry.state);
    TEST_ASSERT_EQUAL_INT(0, telemetry.faults);
    /* 0.5 m/s over 2 s, less what 1 m/s² takes away at the start and adds at the end. */
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), JP_Q16(1.0), (int32_t)(telemetry.odometry.x >> 16));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), 0, (int32_t)(telemetry.odometry.y >> 16));
}

static void test_sensors_that_come_back_after_long_are_taken(void)
{
    stand();
    for (unsigned i = 0; i < UINT16_MAX; i++) {
        jp_four_wheel_robot_control(&robot, JP_ERR_HARDWARE, &sensors, &actuation);
        jp_four_wheel_robot_account(&robot);
    }
    sensors.count[JP_FRONT_LEFT] += UINT16_MAX;
    tick(JP_OK);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, telemetry.faults);
    TEST_ASSERT_EQUAL_UINT32(UINT16_MAX, telemetry.dropped_frames);
    TEST_ASSERT_TRUE(telemetry.odometry.x > 0);
}

static void test_a_place_at_the_end_of_the_format_overflows_nothing(void)
{
    struct jp_four_wheel_snapshot snapshot;

    stand();
    renew(&ahead, 100);
    jp_four_wheel_robot_snapshot(&robot, &snapshot);
    snapshot.odometry.x = INT64_MAX;
    snapshot.odometry.y = INT64_MIN;
    TEST_ASSERT_TRUE(jp_four_wheel_robot_resume(&robot, &snapshot));
    renew(&ahead, 20);
    TEST_ASSERT_TRUE(telemetry.odometry.x < 0);
}

static void test_odometry_turns_to_the_left(void)
{
    const struct jp_twist turn = {.turn_rate = JP_Q24(0.5)};
    const struct jp_twist across = {.y = JP_Q24(0.2)};

    stand();
    renew(&turn, 400);
    TEST_ASSERT_TRUE(telemetry.standstills > 0U); /* its wheels had to turn first */
    renew(&rest, 100);
    const int32_t turned = (int32_t)jp_phase_angle(telemetry.odometry.heading);

    TEST_ASSERT_TRUE(turned > DEGREES(80) && turned < DEGREES(120));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.005), 0, (int32_t)(telemetry.odometry.x >> 16));
    renew(&across, 300);
    /* Its left is now about the way back of x. */
    TEST_ASSERT_TRUE(telemetry.odometry.x < -((int64_t)1 << 31) / 2);
}

static void test_a_twist_lapses_that_is_not_renewed(void)
{
    stand();
    renew(&ahead, 100);
    drive(usual.twist_ticks);
    TEST_ASSERT_EQUAL_INT32(ahead.x, telemetry.reference.x);
    drive(100);
    TEST_ASSERT_EQUAL_INT32(0, telemetry.reference.x);
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_STANDING, telemetry.state);
}

static void test_twists_are_checked(void)
{
    struct jp_twist twist = {.x = JP_Q24(16.1)};

    stand();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_robot_drive(&robot, &twist));
    twist = (struct jp_twist){.y = -JP_Q24(16.1)};
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_robot_drive(&robot, &twist));
    twist = (struct jp_twist){.turn_rate = JP_Q24(16.1)};
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_robot_drive(&robot, &twist));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_robot_drive(&robot, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_robot_drive(NULL, &ahead));
}

static void test_what_was_ordered_before_it_stood_is_forgotten(void)
{
    stand();
    renew(&ahead, 20);
    jp_four_wheel_robot_disable(&robot);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_drive(&robot, &ahead));
    drive(2);
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_IDLE, telemetry.state);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_enable(&robot));
    drive(5);
    TEST_ASSERT_EQUAL_INT32(0, telemetry.reference.x);
}

/* Frames that cannot be. */

static void expect_fault(unsigned faults, enum jp_status read)
{
    const struct jp_four_wheel_sensors bad = sensors;

    for (unsigned i = 1; i < usual.limits.confirm_ticks; i++) {
        sensors = bad;
        tick(read);
        TEST_ASSERT_EQUAL_INT(0, telemetry.faults);
    }
    sensors = bad;
    tick(read);
    TEST_ASSERT_EQUAL_HEX16(faults, telemetry.faults);
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_FAULT, telemetry.state);
    TEST_ASSERT_EQUAL_UINT32(usual.limits.confirm_ticks, telemetry.dropped_frames);
}

static void test_a_hal_that_cannot_read_is_a_fault_after_some_ticks(void)
{
    stand();
    expect_fault(JP_FAULT_HARDWARE, JP_ERR_HARDWARE);
}

static void test_a_voltage_out_of_range_is(void)
{
    stand();
    sensors.bus_voltage = JP_Q16(17.9);
    expect_fault(JP_FAULT_BUS_VOLTAGE, JP_OK);
}

static void test_a_current_out_of_range_is(void)
{
    stand();
    sensors.bus_current = -JP_Q16(37.6);
    expect_fault(JP_FAULT_CURRENT_RANGE, JP_OK);
}

static void test_an_angle_beyond_its_limit_is_of_its_side(void)
{
    stand();
    sensors.angle[JP_REAR_LEFT] = DEGREES(121);
    expect_fault(JP_FAULT_ENCODER_LEFT, JP_OK);
    setUp();
    stand();
    sensors.angle[JP_FRONT_RIGHT] = -DEGREES(121);
    expect_fault(JP_FAULT_ENCODER_RIGHT, JP_OK);
}

static void test_a_count_that_jumps_is(void)
{
    stand();
    sensors.count[JP_FRONT_LEFT] += 100000U;
    expect_fault(JP_FAULT_ENCODER_JUMP, JP_OK);
}

static void test_a_gap_is_ridden_out_without_losing_way(void)
{
    stand();
    renew(&ahead, 100);
    for (unsigned i = 0; i < 10; i++) {
        renew(&ahead, 10);
        obey();
        tick(JP_ERR_HARDWARE);
        obey();
        tick(JP_ERR_HARDWARE);
    }
    renew(&ahead, 30);
    TEST_ASSERT_EQUAL_INT(0, telemetry.faults);
    TEST_ASSERT_EQUAL_UINT32(20, telemetry.dropped_frames);
    /* All that the wheels rolled is counted. */
    const int64_t metres = (int64_t)sensors.count[0] * usual.count_speed / RATE;

    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), (int32_t)(metres >> 16), (int32_t)(telemetry.odometry.x >> 16));
}

static void test_idle_nothing_fails_before_the_first_frame(void)
{
    for (unsigned i = 0; i < 10; i++) {
        tick(JP_ERR_HARDWARE);
    }
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_IDLE, telemetry.state);
    tick(JP_OK);
    for (unsigned i = 0; i < 10; i++) {
        tick(JP_ERR_HARDWARE);
    }
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_FAULT, telemetry.state);
}

/* Drives that do not follow. */

static void test_a_wheel_that_does_not_roll_is_a_fault_of_its_side(void)
{
    stand();
    for (unsigned i = 0; i < 200 && telemetry.faults == 0U; i++) {
        const uint32_t stuck = sensors.count[JP_REAR_RIGHT];

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_drive(&robot, &ahead));
        obey();
        sensors.count[JP_REAR_RIGHT] = stuck;
        tick(JP_OK);
    }
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_STALLED_RIGHT, telemetry.faults);
}

static void test_a_wheel_that_does_not_steer_is(void)
{
    const struct jp_twist turn = {.turn_rate = JP_Q24(0.5)};

    stand();
    for (unsigned i = 0; i < 200 && telemetry.faults == 0U; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_drive(&robot, &turn));
        obey();
        sensors.angle[JP_FRONT_LEFT] = 0;
        /* A frame that is lost tells nothing of it. */
        tick(i % 10 == 9 ? JP_ERR_HARDWARE : JP_OK);
    }
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_STALLED_LEFT, telemetry.faults);
}

/* After a fault. */

static void test_in_a_fault_it_brakes_and_then_is_off(void)
{
    unsigned ticks = 0;

    stand();
    renew(&ahead, 100);
    for (unsigned i = 0; i < 4; i++) {
        obey();
        tick(JP_ERR_HARDWARE);
    }
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_FAULT, telemetry.state);
    TEST_ASSERT_EQUAL_UINT8(1, actuation.enabled);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_four_wheel_robot_drive(&robot, &ahead));
    while (actuation.enabled != 0 && ticks < 200) {
        obey();
        tick(JP_ERR_HARDWARE);
        ticks++;
    }
    TEST_ASSERT_TRUE(ticks >= 45 && ticks <= 60); /* 0.5 m/s at 1 m/s² */
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_FAULT, telemetry.state);
    jp_four_wheel_robot_disable(&robot);
    tick(JP_OK);
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_IDLE, telemetry.state);
    TEST_ASSERT_EQUAL_INT(0, telemetry.faults);
    stand();
}

static void test_a_disable_without_a_frame_needs_another_one(void)
{
    tick(JP_OK);
    jp_four_wheel_robot_disable(&robot);
    tick(JP_ERR_HARDWARE);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_four_wheel_robot_enable(&robot));
    tick(JP_OK);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_enable(&robot));
}

/* After a reset. */

static void test_it_goes_on_after_a_reset_and_brakes(void)
{
    struct jp_four_wheel_snapshot snapshot;

    stand();
    renew(&ahead, 100);
    const int64_t x = telemetry.odometry.x;
    const jp_energy energy = telemetry.energy;

    jp_four_wheel_robot_snapshot(&robot, &snapshot);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_init(&robot, &config, &refused));
    TEST_ASSERT_TRUE(jp_four_wheel_robot_resume(&robot, &snapshot));
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_DRIVING, jp_four_wheel_robot_state_now(&robot));
    look();
    TEST_ASSERT_TRUE(telemetry.odometry.x == x && telemetry.energy == energy);
    drive(100);
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_STANDING, telemetry.state);
    TEST_ASSERT_TRUE(telemetry.odometry.x > x && telemetry.energy > energy);
}

static void test_without_sensors_after_a_reset_it_fails(void)
{
    struct jp_four_wheel_snapshot snapshot;

    stand();
    jp_four_wheel_robot_snapshot(&robot, &snapshot);
    start();
    TEST_ASSERT_TRUE(jp_four_wheel_robot_resume(&robot, &snapshot));
    for (unsigned i = 0; i < 4; i++) {
        tick(JP_ERR_HARDWARE);
    }
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_FAULT, telemetry.state);
}

static void test_a_record_that_is_not_its_own_is_refused(void)
{
    struct jp_four_wheel_snapshot good;
    struct jp_four_wheel_snapshot bad;

    tick(JP_OK);
    jp_four_wheel_robot_snapshot(&robot, &good);
    TEST_ASSERT_FALSE(jp_four_wheel_robot_resume(&robot, &good)); /* its drives did not run */
    good.ran = 1;
    bad = good;
    bad.tick_rate++;
    TEST_ASSERT_FALSE(jp_four_wheel_robot_resume(&robot, &bad));
    bad = good;
    bad.count_speed++;
    TEST_ASSERT_FALSE(jp_four_wheel_robot_resume(&robot, &bad));
    bad = good;
    bad.wheels.angle[3] = INT32_MIN;
    TEST_ASSERT_FALSE(jp_four_wheel_robot_resume(&robot, &bad));
    bad = good;
    bad.wheels.speed[2] = JP_Q24(1.6);
    TEST_ASSERT_FALSE(jp_four_wheel_robot_resume(&robot, &bad));
    TEST_ASSERT_TRUE(jp_four_wheel_robot_resume(&robot, &good));
}

/* Energy and pieces. */

static void test_it_meters_what_leaves_the_battery(void)
{
    stand();
    for (unsigned i = 0; i < 98; i++) {
        tick(JP_OK);
    }
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), JP_Q16(48), jp_energy_to_q16(telemetry.energy, 0));
}

static void test_it_hands_on_the_pieces_of_its_way(void)
{
    struct jp_four_wheel_stretch stretch;
    unsigned pieces = 0;
    jp_energy before = 0;

    TEST_ASSERT_FALSE(jp_four_wheel_robot_take_stretch(&robot, &stretch));
    stand();
    for (unsigned i = 0; i < 10; i++) {
        renew(&ahead, 20);
        while (jp_four_wheel_robot_take_stretch(&robot, &stretch)) {
            TEST_ASSERT_EQUAL_INT32(JP_Q16(0.2), stretch.piece.duration);
            TEST_ASSERT_TRUE(stretch.energy > before);
            before = stretch.energy;
            pieces++;
        }
    }
    TEST_ASSERT_EQUAL_UINT(10, pieces);
    TEST_ASSERT_EQUAL_UINT32(0, jp_four_wheel_robot_stretches_lost(&robot));
}

static void test_pieces_that_nobody_takes_are_lost(void)
{
    struct jp_four_wheel_stretch stretch;
    unsigned pieces = 0;

    stand();
    drive(20U * (JP_FOUR_WHEEL_STRETCHES + 4U));
    TEST_ASSERT_EQUAL_UINT32(5, jp_four_wheel_robot_stretches_lost(&robot));
    while (jp_four_wheel_robot_take_stretch(&robot, &stretch)) {
        pieces++;
    }
    TEST_ASSERT_EQUAL_UINT(JP_FOUR_WHEEL_STRETCHES - 1U, pieces);
}

static void test_any_part_of_a_twist_has_its_range(void)
{
    jp_q24 numbers[3] = {0, 0, 0};

    stand();
    for (int i = 0; i < 3; i++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            numbers[i] = sign * JP_Q24(16);
            TEST_ASSERT_EQUAL_INT(
                JP_OK, jp_four_wheel_robot_drive(&robot, &(struct jp_twist){numbers[0], numbers[1], numbers[2]}));
            numbers[i] += sign;
            TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_robot_drive(
                                                       &robot, &(struct jp_twist){numbers[0], numbers[1], numbers[2]}));
            numbers[i] = 0;
        }
    }
}

/* On an arc it moves in the mean of its headings before and after. */
static void test_a_tick_moves_it_in_its_mean_heading(void)
{
    const struct jp_twist arc = {.x = JP_Q24(0.5), .turn_rate = JP_Q24(0.8)};
    struct jp_four_wheel_odometry before;

    stand();
    renew(&arc, 150);
    for (int i = 0; i < 20; i++) {
        before = telemetry.odometry;
        renew(&arc, 10);
        const int32_t dx = (int32_t)((telemetry.odometry.x - before.x) >> 8);
        const int32_t dy = (int32_t)((telemetry.odometry.y - before.y) >> 8);
        const jp_angle from = jp_phase_angle(before.heading);
        const jp_angle turned = jp_phase_angle(telemetry.odometry.heading) - from;

        TEST_ASSERT_INT32_WITHIN(DEGREES(0.1), 0, (int32_t)(jp_atan2(dy, dx) - from - turned / 2U));
        TEST_ASSERT_INT32_WITHIN(DEGREES(0.2), (int32_t)jp_angle_from_radians(JP_Q24(0.08)), (int32_t)turned);
    }
}

static void test_counts_may_jump_as_far_as_is_said(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        start();
        tick(JP_OK);
        for (int i = 0; i < 20; i++) {
            for (int k = 0; k < JP_WHEELS; k++) {
                sensors.count[k] += (uint32_t)(sign * (int32_t)config.limits.count_jump);
            }
            tick(JP_OK);
            TEST_ASSERT_EQUAL_UINT32(0, telemetry.dropped_frames);
        }
        sensors.count[2] += (uint32_t)(sign * (int32_t)(config.limits.count_jump + 1U));
        tick(JP_OK);
        TEST_ASSERT_EQUAL_UINT32(1, telemetry.dropped_frames);
    }
}

/* Orders that come again and again are driven on, longer than one lasts. */
static void test_orders_that_are_renewed_last(void)
{
    stand();
    renew(&ahead, 4 * config.twist_ticks);
    TEST_ASSERT_EQUAL_INT32(ahead.x, telemetry.reference.x);
}

/* What was told before it was switched off is not driven when it is switched on. */
static void test_orders_before_a_disable_are_forgotten(void)
{
    stand();
    renew(&ahead, 10);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_drive(&robot, &ahead));
    jp_four_wheel_robot_disable(&robot);
    tick(JP_OK);
    stand();
    tick(JP_OK);
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_STANDING, telemetry.state);
    TEST_ASSERT_EQUAL_INT32(0, telemetry.reference.x);
}

/* Sideways, the odometry is what the wheels rolled. */
static void test_sideways_it_gets_as_far_as_its_wheels(void)
{
    const struct jp_twist aside = {.y = JP_Q24(0.3)};

    stand();
    renew(&aside, 100);
    const int64_t before = telemetry.odometry.y;
    const uint32_t counted = sensors.count[0];

    renew(&aside, 300);
    const int64_t counts = (int32_t)(sensors.count[0] - counted);
    const int32_t way = (int32_t)(((telemetry.odometry.y - before) * 1000) >> 32);           /* mm */
    const int32_t rolled_way = (int32_t)((counts * config.count_speed / RATE * 1000) >> 32); /* mm */

    TEST_ASSERT_INT32_WITHIN(1, rolled_way < 0 ? -rolled_way : rolled_way, way);
    TEST_ASSERT_GREATER_THAN_INT32(800, way);
}

/* Up to 32 767 W. */
static void test_the_greatest_power(void)
{
    config = usual;
    config.limits.voltage_min = 1;
    config.limits.voltage_max = JP_Q16_ONE;
    config.limits.current = JP_Q16(32767);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_init(&robot, &config, &refused));
    config.limits.current++;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_four_wheel_robot_init(&robot, &config, &refused));
    TEST_ASSERT_EQUAL_STRING("limits.current", refused);
}

/* As far as it may, for as long as you like; a little farther only for some ticks. */
static void test_a_wheel_may_lag_behind_as_far_as_is_said(void)
{
    for (int i = 0; i < JP_WHEELS; i++) {
        const bool is_left = i == (int)JP_FRONT_LEFT || i == (int)JP_REAR_LEFT;

        for (int sign = -1; sign <= 1; sign += 2) {
            start();
            stand();
            sensors.angle[i] = sign * config.limits.angle_lag;
            for (uint32_t k = 0; k < 3U * config.limits.lag_ticks; k++) {
                tick(JP_OK);
            }
            TEST_ASSERT_EQUAL_HEX16(0, telemetry.faults);
            sensors.angle[i] += sign;
            for (uint32_t k = 0; k < 3U * config.limits.lag_ticks; k++) {
                tick(JP_OK);
            }
            TEST_ASSERT_EQUAL_HEX16(is_left ? JP_FAULT_STALLED_LEFT : JP_FAULT_STALLED_RIGHT, telemetry.faults);
        }
    }
}

/* About one of its wheels, which stands: it stands when the others do. */
static void test_one_wheel_that_stands_is_not_the_robot(void)
{
    static const struct jp_twist about = {-JP_Q24(0.11), JP_Q24(0.125), JP_Q24(0.5)};

    stand();
    renew(&about, 150);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_drive(&robot, &rest));
    drive(1);
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_DRIVING, telemetry.state);
    TEST_ASSERT_EQUAL_INT32(0, telemetry.wheels.speed[JP_REAR_RIGHT]);
    TEST_ASSERT_TRUE(telemetry.wheels.speed[JP_FRONT_LEFT] != 0);
    drive(100);
    TEST_ASSERT_EQUAL_INT(JP_FOUR_WHEEL_ROBOT_STANDING, telemetry.state);
}
