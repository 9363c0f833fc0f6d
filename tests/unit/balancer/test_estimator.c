/* The estimator: configuration, start, exact counts across every wrap, tracking loops, levelling, bias. */
#include <joulepath/estimator.h>
#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "tests/support/config_check.h"
#include "unity.h"

#define TICKS_PER_SECOND 1000
#define GYRO_BIAS_MAX    JP_Q24(0.05)

static struct jp_estimator_config config;
static struct jp_estimator estimator;
static struct jp_sensors sensors;
static struct jp_motion_state state;

void setUp(void)
{
    config = jp_robot_courier24.estimator;
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE};
}

void tearDown(void)
{
}

static void start(void)
{
    jp_estimator_start(&estimator, &config, &sensors);
}

static void update(void)
{
    jp_estimator_update(&estimator, &config, &sensors, &state);
}

DEFINE_EXPECT_CONFIG(estimator)

static void test_checks_every_field_at_its_limits(void)
{
    expect_config(NULL);
    RANGE("estimator.", tick_rate, 100, 10000);
    RANGE("estimator.", wheel_per_count, 1, JP_PHASE_TURN);
    RANGE("estimator.", yaw_per_count, 1, JP_PHASE_TURN);
    RANGE("estimator.", tracking_gain, 1, JP_Q16_ONE);
    RANGE("estimator.", tracking_rate_gain, 1, JP_Q16(1000));
    AT_LEAST("estimator.", tilt_gain, 0);
    FIELD(tilt_gain, JP_Q31_MAX, NULL);
    AT_LEAST("estimator.", bias_gain, 0);
    FIELD(bias_gain, JP_Q31_MAX, NULL);
}

static void test_names_the_first_bad_field(void)
{
    config.tick_rate = 0;
    config.bias_gain = -1;
    expect_config("estimator.tick_rate");
}

static void test_starts_at_the_pitch_that_the_accelerometer_shows(void)
{
    /* Forward by 30°: gravity's reaction points backward in the body. */
    sensors.accel_x = -JP_Q24_ONE / 2;
    sensors.accel_z = JP_Q24(0.8660254037844386);
    start();
    update();
    TEST_ASSERT_INT32_WITHIN(2, JP_Q24(30.0 / 360.0), state.pitch);
    TEST_ASSERT_EQUAL_INT32(0, state.pitch_rate);
    TEST_ASSERT_EQUAL_UINT64(0, state.yaw);

    sensors.accel_x = INT32_MIN; /* its negation saturates */
    sensors.accel_z = 0;
    start();
    config.tilt_gain = 0;
    update();
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.25), state.pitch);
}

static void test_counts_become_wheel_angle_and_yaw(void)
{
    config = jp_robot_gao2018.estimator;
    start();
    sensors.encoder_left += 70;
    sensors.encoder_right += 100;
    update();
    TEST_ASSERT_EQUAL_UINT64(170U * config.wheel_per_count, estimator.wheel_encoder);
    TEST_ASSERT_EQUAL_UINT64(30U * config.yaw_per_count, estimator.yaw_encoder);
    /* With gains 1 and tick_rate the rate is the plain difference; a half step of the format times tick_rate. */
    TEST_ASSERT_INT32_WITHIN(500, (int32_t)((170U * config.wheel_per_count * TICKS_PER_SECOND) >> 32),
                             state.wheel_rate);
    TEST_ASSERT_INT32_WITHIN(500, (int32_t)((30U * config.yaw_per_count * TICKS_PER_SECOND) >> 32), state.yaw_rate);

    sensors.encoder_left -= 70;
    sensors.encoder_right -= 100;
    update();
    TEST_ASSERT_EQUAL_UINT64(0, estimator.wheel_encoder);
    TEST_ASSERT_EQUAL_UINT64(0, estimator.yaw_encoder);
    TEST_ASSERT_LESS_THAN_INT32(0, state.wheel_rate);
}

static uint32_t hash;

static void mix(uint64_t value)
{
    hash = (hash ^ (uint32_t)value ^ (uint32_t)(value >> 32)) * 16777619U;
}

/** A drive with uneven speeds, both ways, from these counts. */
static uint32_t drive_hash(uint32_t left, uint32_t right)
{
    hash = 2166136261U;
    sensors = (struct jp_sensors){.encoder_left = left, .encoder_right = right, .accel_z = JP_Q24_ONE};
    start();
    for (int32_t i = 0; i < 2000; i++) {
        int32_t step = (i * 7919 % 401) - 150;

        sensors.encoder_left += (uint32_t)step;
        sensors.encoder_right += (uint32_t)(step + i % 13 - 5);
        sensors.pitch_rate = JP_Q24(0.01) * (i % 7 - 3);
        sensors.accel_x = JP_Q24(0.01) * (i % 5 - 2);
        update();
        mix(state.wheel);
        mix(state.yaw);
        mix((uint32_t)state.pitch);
        mix((uint32_t)state.wheel_rate);
        mix((uint32_t)state.yaw_rate);
        mix((uint32_t)state.pitch_rate);
    }
    return hash;
}

static void test_start_counts_do_not_matter_to_the_bit(void)
{
    uint32_t expected = drive_hash(0, 0);

    TEST_ASSERT_EQUAL_HEX32(expected, drive_hash(UINT32_MAX, UINT32_MAX - 17U));
    TEST_ASSERT_EQUAL_HEX32(expected, drive_hash(0x7FFFFFFFU, 0x80000000U));
    TEST_ASSERT_EQUAL_HEX32(expected, drive_hash(123456789U, 0xFFFF0000U));
}

static void test_encoder_phase_wraps_without_a_jump(void)
{
    config = jp_robot_gao2018.estimator;
    start();
    estimator.wheel_encoder = (jp_phase)0 - 50U * config.wheel_per_count;
    estimator.wheel.angle = estimator.wheel_encoder;
    for (int i = 0; i < 100; i++) {
        jp_phase before = state.wheel;

        sensors.encoder_left++;
        sensors.encoder_right++;
        update();
        if (i > 0) {
            TEST_ASSERT_UINT64_WITHIN(1U << 17, 2U * config.wheel_per_count, state.wheel - before);
        }
    }
    TEST_ASSERT_EQUAL_UINT64(150U * config.wheel_per_count, estimator.wheel_encoder);
    TEST_ASSERT_UINT64_WITHIN(1U << 17, 150U * config.wheel_per_count, state.wheel);
}

static void test_tracking_has_no_lag_at_steady_speed(void)
{
    start();
    for (int i = 0; i < 2000; i++) {
        sensors.encoder_left += 20;
        sensors.encoder_right += 30;
        update();
    }
    TEST_ASSERT_INT32_WITHIN(2000, (int32_t)((50U * config.wheel_per_count * TICKS_PER_SECOND) >> 32),
                             state.wheel_rate);
    TEST_ASSERT_INT32_WITHIN(2000, (int32_t)((10U * config.yaw_per_count * TICKS_PER_SECOND) >> 32), state.yaw_rate);
    TEST_ASSERT_INT32_WITHIN(100, 0, jp_phase_difference(state.wheel, estimator.wheel_encoder));
    TEST_ASSERT_INT32_WITHIN(100, 0, jp_phase_difference(state.yaw, estimator.yaw_encoder));
}

static void test_wheel_angle_in_the_world_holds_still_while_the_body_tilts(void)
{
    /* The body turns forward by 2⁻¹¹ turn a tick, 2 097 counts of 2⁻²² turn; the wheels stay: the encoders run back. */
    config = jp_robot_gao2018.estimator;
    start();
    sensors.pitch_rate = JP_Q24(0.5);
    for (int i = 0; i < 250; i++) {
        sensors.encoder_left -= (uint32_t)((i + 1) * 16777 / 8 - i * 16777 / 8);
        sensors.encoder_right = sensors.encoder_left;
        update();
    }
    TEST_ASSERT_INT32_WITHIN(20, JP_Q24(0.125), state.pitch);
    TEST_ASSERT_INT32_WITHIN(300, 0, jp_phase_difference(state.wheel, 0));
    TEST_ASSERT_INT32_WITHIN(2000, 0, state.wheel_rate);
}

static void test_pitch_stays_within_half_a_turn(void)
{
    config.tilt_gain = 0;
    config.bias_gain = 0;
    start();
    sensors.pitch_rate = JP_Q24(0.5);
    for (int i = 0; i < 1500; i++) {
        update();
    }
    TEST_ASSERT_INT32_WITHIN(100, JP_Q24(-0.25), state.pitch); /* three quarters of a turn forward */
    for (int i = 0; i < 500; i++) {
        update();
    }
    TEST_ASSERT_INT32_WITHIN(100, 0, state.pitch);
    for (int32_t turns = -5; turns <= 5; turns++) {
        estimator.pitch = (jp_phase)(int64_t)turns * JP_PHASE_TURN;
        sensors.pitch_rate = 0;
        update();
        TEST_ASSERT_EQUAL_INT32(0, state.pitch);
    }
}

static void test_levelling_draws_pitch_to_the_vertical(void)
{
    start();
    config.bias_gain = 0;
    estimator.pitch = JP_PHASE_TURN / 20; /* 18° of error */
    update();

    jp_q24 before = state.pitch;

    for (int i = 0; i < 2000; i++) {
        update();
        TEST_ASSERT_TRUE(state.pitch <= before);
        before = state.pitch;
    }
    /* Time constant 2 s: e⁻¹ of it is left. */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0005), JP_Q24(0.05 * 0.3679), state.pitch);
}

static void test_learns_the_bias_of_the_gyro(void)
{
    start();
    sensors.pitch_rate = JP_Q24(0.002);
    for (int32_t i = 0; i < 70 * TICKS_PER_SECOND; i++) {
        update();
    }
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0003), 0, state.pitch_rate);
    TEST_ASSERT_GREATER_THAN_INT64(0, estimator.gyro_bias);
}

static void test_learning_stops_at_a_broken_gyro(void)
{
    config.bias_gain = JP_Q31_MAX;
    sensors.accel_z = 0;
    sensors.accel_x = -JP_Q24_ONE * 100;
    start();
    estimator.pitch = 0;
    config.tilt_gain = 0;
    for (int i = 0; i < 20; i++) {
        update();
    }
    TEST_ASSERT_EQUAL_INT32(GYRO_BIAS_MAX, state.pitch_rate); /* −(−max) */
    sensors.accel_x = JP_Q24_ONE * 100;
    estimator.pitch = 0;
    for (int i = 0; i < 40; i++) {
        update();
    }
    TEST_ASSERT_EQUAL_INT32(-GYRO_BIAS_MAX, state.pitch_rate);
}

static void test_without_gains_the_accelerometer_is_not_heard(void)
{
    config = jp_robot_gao2018.estimator;
    start();
    sensors.accel_x = JP_Q24_ONE;
    for (int i = 0; i < 100; i++) {
        update();
    }
    TEST_ASSERT_EQUAL_INT32(0, state.pitch);
    TEST_ASSERT_EQUAL_INT64(0, estimator.gyro_bias);
}

static void test_extreme_readings_saturate(void)
{
    config.tracking_gain = JP_Q16_ONE;
    config.tracking_rate_gain = JP_Q16(1000);
    config.wheel_per_count = JP_PHASE_TURN;
    config.tilt_gain = JP_Q31_MAX;
    config.bias_gain = JP_Q31_MAX;
    start();
    sensors = (struct jp_sensors){.encoder_left = 0x40000000U,
                                  .encoder_right = 0x40000000U,
                                  .pitch_rate = INT32_MIN,
                                  .accel_x = INT32_MIN,
                                  .accel_z = INT32_MIN};
    for (int i = 0; i < 20; i++) {
        update();
        sensors.encoder_left = 0U - sensors.encoder_left * 3U;
        sensors.pitch_rate = sensors.pitch_rate == INT32_MIN ? INT32_MAX : INT32_MIN;
        sensors.accel_x = sensors.pitch_rate;
    }
    TEST_ASSERT_TRUE(state.pitch >= -JP_Q24_ONE / 2 && state.pitch <= JP_Q24_ONE / 2);
}

/* A gap in which the robot rolled on */

static void roll(uint32_t left, uint32_t right)
{
    sensors.encoder_left += left;
    sensors.encoder_right += right;
}

/* Rolls steadily, then over a gap; another estimator sees the gap, too. */
static void check_resume(uint32_t start_count, uint32_t left, uint32_t right, uint32_t gap)
{
    struct jp_estimator seeing;
    struct jp_motion_state seen;
    struct jp_motion_state resumed;

    setUp();
    roll(start_count, start_count);
    start();
    for (int32_t i = 0; i < 2000; i++) {
        roll(left, right);
        update();
    }
    seeing = estimator;
    for (uint32_t i = 0; i < gap; i++) {
        roll(left, right);
        jp_estimator_update(&seeing, &config, &sensors, &seen);
    }
    roll(left, right);
    jp_estimator_update(&seeing, &config, &sensors, &seen);
    jp_estimator_resume(&estimator, &config, &sensors, &resumed);
    TEST_ASSERT_EQUAL_UINT64(seeing.wheel_encoder, estimator.wheel_encoder);
    TEST_ASSERT_EQUAL_UINT64(seeing.yaw_encoder, estimator.yaw_encoder);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.002), 0, jp_phase_difference(seen.wheel, resumed.wheel));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.002), 0, jp_phase_difference(seen.yaw, resumed.yaw));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.15), seen.wheel_rate, resumed.wheel_rate);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.15), seen.yaw_rate, resumed.yaw_rate);
}

static void test_resuming_keeps_distance_heading_and_rates(void)
{
    check_resume(0, 20, 30, 0);
    check_resume(0, 20, 30, 40);
    check_resume(0, 0U - 15U, 25, 40);
    check_resume(0U - 2000U * 20U - 300U, 20, 30, 40); /* the counts wrap in the gap */
    check_resume(0, 0, 0, 1000);
}

static void test_resuming_keeps_pitch_and_the_gyros_bias(void)
{
    start();
    config.tilt_gain = 0;
    config.bias_gain = 0;
    estimator.pitch = JP_PHASE_TURN / 40;
    estimator.gyro_bias = (int64_t)JP_Q24(0.01) * ((int64_t)1 << 32);
    sensors.pitch_rate = JP_Q24(0.01);
    roll(500, 500);
    jp_estimator_resume(&estimator, &config, &sensors, &state);
    TEST_ASSERT_INT32_WITHIN(1, JP_Q24_ONE / 40, state.pitch);
    TEST_ASSERT_EQUAL_INT32(0, state.pitch_rate);
}

/* Nothing is learned from a level robot: only the limit acts. */
static void expect_limited(int64_t expected, int64_t bias)
{
    start();
    estimator.gyro_bias = bias;
    estimator.pitch = 0;
    config.bias_gain = 0;
    update();
    TEST_ASSERT_EQUAL_INT64(expected, estimator.gyro_bias);
}

static void test_the_bias_is_limited_to_the_bit(void)
{
    const int64_t most = (int64_t)GYRO_BIAS_MAX << 32;

    expect_limited(0, 0);
    expect_limited(most - 1, most - 1);
    expect_limited(most, most);
    expect_limited(most, most + 5);
    expect_limited(most, INT64_MAX);
    expect_limited(-most, -most);
    expect_limited(1 - most, 1 - most);
    expect_limited(5 - most, 5 - most);
    expect_limited(-most, -most - 1);
    expect_limited(-most, INT64_MIN);
}
