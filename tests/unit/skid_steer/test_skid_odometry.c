/* Odometry of skid steer and differential drive: what it learns, what it takes out, and where its limits are. */
#include <joulepath/skid_odometry.h>
#include <stddef.h>

#include "tests/support/config_check.h"
#include "unity.h"

#define METRE  ((int64_t)1 << 32)
#define DEGREE ((int32_t)(JP_Q24_ONE / 360))

/* Round numbers: 200 ticks and 25 steps a second, 2⁻¹⁶ m and 2⁻¹⁷ turn a count. */
static const struct jp_skid_odometry_config usual = {
    .tick_rate = 200,
    .step_ticks = 8,
    .way_per_count = (int32_t)1 << 24,
    .turn_per_count = (int32_t)1 << 23,
    .ratio = JP_Q24(0.5),
    .ratio_deviation = JP_Q24(0.1),
    .scale_deviation = JP_Q24(0.01),
    .bias_deviation = JP_Q24(0.003),
    .bias_memory = 1000000,
    .gyro_noise = JP_Q24(0.0003),
    .way_noise = JP_Q24(0.005),
    .turn_noise = JP_Q24(0.03),
    .tilt_deviation = JP_Q24(0.1),
    .tilt_change = JP_Q24(0.08),
    .accel_noise = JP_Q24(0.005),
    .turn_slide_most = JP_Q24(4),
    .efficiency = JP_Q24(0.5),
    .way_deviation = JP_Q24(0.01),
    .way_drift = JP_Q24(0.01),
    .turn_drift = JP_Q24(0.02),
};

static struct jp_skid_odometry_config config;
static struct jp_skid_odometry odometry;
static struct jp_sensors sensors;

void setUp(void)
{
    config = usual;
    sensors = (struct jp_sensors){.encoder_left = UINT32_MAX - 100, .encoder_right = 7, .accel_z = JP_Q24_ONE};
    jp_skid_odometry_start(&odometry, &config, &sensors);
}

void tearDown(void)
{
}

DEFINE_EXPECT_CONFIG_OF(jp_skid_odometry_check, usual)

/* The ticks in which the parts of the last step are done; the wheels stay, and the next step has not come. */
static void settle(void)
{
    for (int tick = 0; tick < 5; tick++) {
        jp_skid_odometry_update(&odometry, &config, &sensors);
    }
    odometry.internal.ticks = 0;
}

/* Steps in which each side moves by so many counts a tick while the gyro reads a rate. */
static void drive(int32_t steps, int32_t left, int32_t right, jp_turns_per_s rate)
{
    sensors.yaw_rate = rate;
    for (int32_t tick = 0; tick < 8 * steps; tick++) {
        sensors.encoder_left += (uint32_t)left;
        sensors.encoder_right += (uint32_t)right;
        jp_skid_odometry_update(&odometry, &config, &sensors);
    }
    settle();
    odometry.internal.yaw_angle = 0;
    odometry.internal.pitch_angle = 0;
    odometry.internal.accel_sum = 0;
}

static int32_t heading_degrees_1000(void)
{
    return (int32_t)((int64_t)(odometry.heading >> 32) * 360000 / JP_Q24_ONE);
}

static void test_check_names_each_field(void)
{
    expect_config(NULL);
    RANGE("odometry.", tick_rate, 100, 10000);
    RANGE("odometry.", step_ticks, 6, 32);
    RANGE("odometry.", way_per_count, (int32_t)1 << 12, (int32_t)1 << 30);
    RANGE("odometry.", turn_per_count, (int32_t)1 << 12, (int32_t)1 << 30);
    RANGE("odometry.", ratio, JP_Q24(0.1), JP_Q24(1.5));
    RANGE("odometry.", ratio_deviation, JP_Q24(0.0001), JP_Q24(0.5));
    RANGE("odometry.", scale_deviation, 0, JP_Q24(0.1));
    RANGE("odometry.", bias_deviation, JP_Q24_ONE >> 16, JP_Q24(0.1));
    RANGE("odometry.", bias_memory, 1000, 100000000);
    RANGE("odometry.", gyro_noise, JP_Q24_ONE >> 20, JP_Q24(0.1));
    RANGE("odometry.", way_noise, JP_Q24_ONE >> 16, JP_Q24(0.1));
    RANGE("odometry.", turn_noise, JP_Q24(0.001), JP_Q24_ONE);
    RANGE("odometry.", tilt_deviation, JP_Q24(0.005), JP_Q24(0.5));
    RANGE("odometry.", tilt_change, JP_Q24(0.001), JP_Q24_ONE);
    RANGE("odometry.", accel_noise, JP_Q24(0.0005), JP_Q24(0.1));
    RANGE("odometry.", accel_offset, 0, JP_Q24(0.5));
    RANGE("odometry.", ratio_growth, 0, JP_Q24(16));
    RANGE("odometry.", creep, 0, JP_Q24_ONE);
    RANGE("odometry.", turn_creep_along, 0, JP_Q24(8));
    RANGE("odometry.", turn_creep_across, 0, JP_Q24(8));
    RANGE("odometry.", turn_shift_along, 0, JP_Q24(8));
    RANGE("odometry.", turn_shift_across, 0, JP_Q24(8));
    RANGE("odometry.", turn_slide_most, 0, JP_Q24(4));
    RANGE("odometry.", caster_drag, 0, JP_Q24(0.2));
    RANGE("odometry.", turn_force, 0, JP_Q24(2));
    RANGE("odometry.", force_per_ampere, 0, JP_Q24(16));
    RANGE("odometry.", efficiency, JP_Q24(0.1), JP_Q24_ONE);
    RANGE("odometry.", rolling, 0, JP_Q24(0.5));
    RANGE("odometry.", way_deviation, 0, JP_Q24(0.1));
    RANGE("odometry.", way_drift, 0, JP_Q24(0.5));
    RANGE("odometry.", turn_drift, 0, JP_Q24(0.5));
}

/* ---- Way ---- */

static void test_straight_ahead_and_back(void)
{
    drive(64, 256, 256, 0); /* 2 m, through the wrap of the left encoder */
    TEST_ASSERT_INT64_WITHIN(METRE / 10000, 2 * METRE, odometry.x);
    TEST_ASSERT_INT64_WITHIN(METRE / 10000, 0, odometry.y);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.78125), odometry.speed);
    drive(64, -256, -256, 0);
    TEST_ASSERT_INT64_WITHIN(METRE / 10000, 0, odometry.x);
    TEST_ASSERT_EQUAL_INT32(-JP_Q24(0.78125), odometry.speed);
}

static void test_nothing_happens_between_steps(void)
{
    sensors.encoder_left += 1000;
    sensors.encoder_right += 1000;
    for (int tick = 0; tick < 7; tick++) {
        jp_skid_odometry_update(&odometry, &config, &sensors);
        TEST_ASSERT_EQUAL_INT64(0, odometry.x);
    }
    for (int tick = 0; tick < 3; tick++) {
        jp_skid_odometry_update(&odometry, &config, &sensors);
    }
    TEST_ASSERT_INT64_WITHIN(2, 1000 * (METRE >> 16), odometry.x);
}

static void test_gyro_turns_the_heading(void)
{
    drive(25, 100, 428, JP_Q24(0.25)); /* a quarter turn, as the wheels have it with ratio ½ */
    TEST_ASSERT_INT32_WITHIN(400, 90000, heading_degrees_1000());
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.002), JP_Q24(0.25), odometry.turn_rate);
}

/* A circle of 1 000 steps, whose wheels turn as the ratio says: 2¹⁷ counts of (right − left) and ratio ½ are half a
 * turn. */
static void test_circle_closes(void)
{
    drive(512, 218, 282, JP_Q24(0.048828125)); /* 25 · 4 · 128 · 2⁻¹⁷ · ½ turn/s: a turn takes 512 steps */
    TEST_ASSERT_INT32_WITHIN(30, 0, (int32_t)((int64_t)(odometry.heading << 8) >> 40) * 360 / 65536);
    TEST_ASSERT_INT64_WITHIN(METRE / 1000, 0, odometry.x);
    TEST_ASSERT_INT64_WITHIN(METRE / 1000, 0, odometry.y);
}

static void test_step_is_limited(void)
{
    drive(1, 1 << 20, 1 << 20, 0); /* 64 m */
    TEST_ASSERT_INT64_WITHIN(4, METRE / 2, odometry.x);
    drive(1, -(1 << 28), -(1 << 28), 0);
    TEST_ASSERT_INT64_WITHIN(METRE / 100000, 0, odometry.x);
}

static void test_readings_at_their_ends_do_not_overflow(void)
{
    static const int32_t ends[] = {INT32_MIN, INT32_MAX, 0};

    for (int i = 0; i < 200; i++) {
        sensors.encoder_left += (uint32_t)ends[i % 3];
        sensors.encoder_right += (uint32_t)ends[i / 3 % 3];
        sensors.yaw_rate = ends[i / 4 % 3];
        sensors.pitch_rate = ends[i / 5 % 3];
        sensors.accel_x = ends[i / 7 % 3];
        jp_skid_odometry_update(&odometry, &config, &sensors);
    }
    TEST_ASSERT_TRUE(odometry.steering_ratio > 0);
}

/* ---- What is learned ---- */

static void test_stand_keeps_the_pose_and_shows_the_bias(void)
{
    drive(100, 0, 0, DEGREE);
    TEST_ASSERT_EQUAL_INT64(0, odometry.x);
    TEST_ASSERT_TRUE(odometry.heading == 0);
    drive(25, 300, 400, JP_Q24(0.076293945) + DEGREE);

    const struct jp_skid_odometry before = odometry;

    drive(100, 0, 0, DEGREE);
    TEST_ASSERT_INT64_WITHIN(METRE / 1000, before.x, odometry.x);
    TEST_ASSERT_INT64_WITHIN(METRE / 1000, before.y, odometry.y);
    TEST_ASSERT_INT64_WITHIN((int64_t)JP_PHASE_TURN / 10000, (int64_t)before.heading, (int64_t)odometry.heading);
    TEST_ASSERT_EQUAL_INT32(0, odometry.speed);
    TEST_ASSERT_INT32_WITHIN(DEGREE / 100, DEGREE, odometry.bias_rate);
    TEST_ASSERT_INT32_WITHIN(DEGREE / 100, 0, odometry.turn_rate);
}

/* 6 m with a bias that was not known; the stand after it puts the heading right. */
static void test_what_a_stand_shows_was_true_before(void)
{
    config.way_noise = JP_Q24(0.1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    drive(100, 256, 256, DEGREE); /* 4 s: up to 4° wrong */
    TEST_ASSERT_TRUE(heading_degrees_1000() > 1500);
    TEST_ASSERT_TRUE(odometry.y > METRE / 20);
    drive(200, 0, 0, DEGREE);
    TEST_ASSERT_INT32_WITHIN(150, 0, heading_degrees_1000());
    TEST_ASSERT_INT64_WITHIN(METRE / 200, 0, odometry.y);
}

static void test_one_count_to_and_fro_is_a_stand(void)
{
    for (int i = 0; i < 8; i++) {
        drive(1, 0, 0, 0);
        sensors.encoder_left += i % 2 == 0 ? 1U : UINT32_MAX;
    }
    TEST_ASSERT_EQUAL_INT64(0, odometry.x);
    sensors.encoder_right += 2;
    drive(1, 0, 0, 0);
    TEST_ASSERT_INT64_WITHIN(2, METRE >> 17, odometry.x); /* the left one has come back */
}

/* Straight ways tell the bias too, only less. */
static void test_straight_way_shows_the_bias_less(void)
{
    drive(25, 256, 256, DEGREE);
    const int32_t by_way = odometry.bias_rate;
    const int32_t variance = odometry.internal.gyro.bias_bias;
    setUp();
    drive(25, 0, 0, DEGREE);
    TEST_ASSERT_TRUE(by_way > DEGREE / 20 && by_way < odometry.bias_rate);
    TEST_ASSERT_TRUE(odometry.internal.gyro.bias_bias < variance / 4);
}

static void test_turns_show_the_ratio(void)
{
    drive(100, 0, 0, 0);
    drive(100, -256, 256, JP_Q24(0.5)); /* ratio ½ would be 0.390625 turn/s */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.02), JP_Q24(0.64), odometry.steering_ratio);
    TEST_ASSERT_TRUE(odometry.internal.gyro.ratio_ratio < (1 << 30) / 8);
    drive(100, 256, -256, -JP_Q24(0.5));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.64), odometry.steering_ratio);
}

/* A ratio that is known leaves the difference to the gyro: its turns are corrected. */
static void test_known_ratio_corrects_the_scale(void)
{
    config.ratio_deviation = JP_Q24(0.0005);
    config.turn_noise = JP_Q24(0.001);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    drive(100, 0, 0, 0);
    drive(100, -256, 256, JP_Q24(0.39453125)); /* 1 % more than the wheels */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(0.5), odometry.steering_ratio);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(0.390625), odometry.turn_rate);
}

static void test_scale_that_is_exact_leaves_it_to_the_ratio(void)
{
    config.scale_deviation = 0;
    jp_skid_odometry_start(&odometry, &config, &sensors);
    drive(100, 0, 0, 0);
    drive(100, -256, 256, JP_Q24(0.39453125));
    TEST_ASSERT_INT32_WITHIN(2, JP_Q24(0.39453125) - odometry.bias_rate, odometry.turn_rate);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.002), JP_Q24(0.505), odometry.steering_ratio);
}

/* ---- Slopes ---- */

/* The accelerometer reads the grade that the robot stands on and drives up. */
static void climb(jp_q24 grade, int32_t steps)
{
    sensors.accel_x = grade;
    jp_skid_odometry_start(&odometry, &config, &sensors);
    drive(steps, 256, 256, 0);
}

static void test_map_sees_the_cosine_of_the_pitch(void)
{
    climb(JP_Q24(0.25), 64);
    TEST_ASSERT_INT64_WITHIN(METRE / 1000, 2 * METRE * 96875 / 100000, odometry.x); /* √(1 − 1/16) within 0.1 % */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(0.78125), odometry.speed);
}

static void test_treads_creep_uphill(void)
{
    config.creep = JP_Q24(0.1);
    climb(JP_Q24(0.0625), 64);
    TEST_ASSERT_INT64_WITHIN(METRE / 1000, 2 * METRE * 99181 / 100000,
                             odometry.x); /* 0.625 %, and 0.195 % for the map */
    climb(-JP_Q24(0.0625), 64);
    TEST_ASSERT_INT64_WITHIN(METRE / 1000, 2 * METRE * 100429 / 100000, odometry.x);
}

static void test_caster_drags_both_ways(void)
{
    config.creep = JP_Q24(0.5);
    config.caster_drag = JP_Q24(0.02);
    climb(0, 64);
    TEST_ASSERT_INT64_WITHIN(METRE / 10000, METRE * 198 / 100, odometry.x);
    drive(64, -256, -256, 0);
    TEST_ASSERT_INT64_WITHIN(METRE / 10000, 0, odometry.x);
}

/* A turn on the spot on a slope: what is ahead turns, so the grade to the left is seen. */
static void test_turn_shows_the_grade_to_the_left(void)
{
    const jp_q24 grade = JP_Q24(0.1);

    sensors.accel_x = 0;
    jp_skid_odometry_start(&odometry, &config, &sensors);
    for (int32_t step = 0; step < 50; step++) { /* from across the slope to straight up it */
        sensors.accel_x = (jp_q24)(((int64_t)grade * jp_sin((jp_angle)step * ((1U << 30) / 50U))) >> 31);
        drive(1, -82, 82, JP_Q24(0.125));
        if (step == 25) {
            TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.0707), odometry.internal.tilt.state[JP_SKID_TILT_LEFT]);
        }
    }
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.005), grade, odometry.internal.tilt.state[JP_SKID_TILT_AHEAD]);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), 0, odometry.internal.tilt.state[JP_SKID_TILT_LEFT]);
}

static void test_robot_slips_down_the_slope_as_it_turns(void)
{
    config.turn_creep_along = JP_Q24(0.5);
    config.turn_creep_across = JP_Q24(1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.1);
    drive(1, -164, 164, JP_Q24(0.125)); /* 0.0314 rad */
    TEST_ASSERT_INT64_WITHIN(METRE / 10000, -METRE * 314 / 100000, odometry.y);
    setUp();
    config.turn_creep_along = JP_Q24(0.5);
    sensors.accel_x = JP_Q24(0.1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    drive(1, -164, 164, JP_Q24(0.125));
    TEST_ASSERT_INT64_WITHIN(METRE / 10000, -METRE * 157 / 100000, odometry.x);
}

/* It turns about the axle uphill at most. */
static void test_slip_in_a_turn_is_limited(void)
{
    config.turn_creep_across = JP_Q24(1);
    config.turn_slide_most = JP_Q24(0.05);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.1);
    drive(1, -164, 164, JP_Q24(0.125)); /* 0.0314 rad */
    TEST_ASSERT_INT64_WITHIN(METRE / 10000, -METRE * 157 / 100000, odometry.y);
}

/* On a slope that would make it slide as far as it may if treads crept in proportion: they creep 2^(-1/4) of that. */
static void test_treads_yield_less_where_one_axle_holds(void)
{
    config.turn_creep_along = JP_Q24(0.5);
    config.turn_creep_across = JP_Q24(1);
    config.turn_slide_most = JP_Q24(0.1);
    sensors.accel_x = JP_Q24(0.1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.1);
    drive(1, -164, 164, JP_Q24(0.125)); /* 0.0314 rad */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(0.8409 * 0.6283185), -odometry.internal.slip.across);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(0.8409 * 0.3141593), odometry.internal.slip.along);
}

/* Beyond the end of what is known of it, and between its steps. */
static void test_share_that_treads_yield(void)
{
    static const struct {
        jp_q24 left;
        int32_t share; /* Q15 */
    } shares[] = {{JP_Q24(0.05), 32275}, {JP_Q24(0.0625), 31434}, {JP_Q24(0.3), 10889}, {JP_Q24(0.9), 8727}};

    config.turn_creep_across = JP_Q24(1);
    config.turn_slide_most = JP_Q24(0.1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    for (unsigned i = 0; i < sizeof shares / sizeof *shares; i++) {
        odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = shares[i].left;
        odometry.internal.tilt.variance[JP_SKID_TILT_LEFT] = 1;
        drive(1, -164, 164, JP_Q24(0.125));
        TEST_ASSERT_INT32_WITHIN(20, shares[i].share, odometry.internal.slip.yielding);
    }
}

/* A robot with one axle slides by its treads' creep alone. */
static void test_turn_that_may_not_slide_does_not(void)
{
    config.turn_creep_across = JP_Q24(1);
    config.turn_slide_most = 0;
    jp_skid_odometry_start(&odometry, &config, &sensors);
    odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.1);
    drive(1, -164, 164, JP_Q24(0.125));
    TEST_ASSERT_EQUAL_INT32(0, odometry.internal.step.sideways);
}

/* What rolls across a slope creeps down it, but for the part of the way that a turn holds: Kx |turn|/4 against κ |way|.
 */
static void test_turn_holds_what_rolls_across(void)
{
    config.creep = JP_Q24(0.1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.1);
    drive(1, 256, 256, 0);
    TEST_ASSERT_INT32_WITHIN((int32_t)(METRE / 100000), -(int32_t)(METRE / 32 / 100), odometry.internal.step.sideways);
    config.turn_creep_along = JP_Q24(0.1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.1);
    drive(1, 92, 420, JP_Q24(0.125)); /* 0.0314 rad: holds 0.785 of 3.125 mm; pushed outwards by 0.0626 g */
    TEST_ASSERT_INT32_WITHIN((int32_t)(METRE / 20000), -(int32_t)(METRE * 2340 / 1000000 * 1626 / 10000),
                             odometry.internal.step.sideways);
    config.turn_creep_along = JP_Q24(8);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.1);
    drive(1, 92, 420, JP_Q24(0.125));
    TEST_ASSERT_EQUAL_INT32(0, odometry.internal.step.sideways);
}

/* Wheels that speed up or brake are not believed to tell the grade, nor just after. */
static void test_grade_is_not_told_by_what_speeds_up(void)
{
    drive(100, 256, 256, 0);
    odometry.internal.tilt.variance[JP_SKID_TILT_AHEAD] = (int32_t)1 << 26;
    const struct jp_skid_odometry calm = odometry;

    sensors.accel_x = JP_Q24(0.1);
    drive(1, 256, 256, 0);
    const jp_q24 told = odometry.internal.tilt.state[JP_SKID_TILT_AHEAD];
    odometry = calm;
    sensors.encoder_left = odometry.internal.encoder[JP_SKID_LEFT];
    sensors.encoder_right = odometry.internal.encoder[JP_SKID_RIGHT];
    odometry.internal.tilt.unrest = JP_Q24(0.2);
    drive(1, 256, 256, 0);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.2) - JP_Q24(0.2) / 8, odometry.internal.tilt.unrest);
    TEST_ASSERT_TRUE(told > JP_Q24(0.03) && odometry.internal.tilt.state[JP_SKID_TILT_AHEAD] < told / 4);
    sensors.accel_x = 0;
    drive(1, 512, 512, 0); /* 19.5 m/s² */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(1.992), odometry.internal.tilt.unrest);
}

/* Load that moves to an axle behind, or to a side, moves what the robot turns about. */
static void test_load_moves_the_centre_of_a_turn(void)
{
    config.turn_shift_across = JP_Q24(0.5);
    sensors.accel_x = JP_Q24(0.1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    drive(1, -164, 164, JP_Q24(0.125));
    TEST_ASSERT_INT64_WITHIN(METRE / 10000, METRE * 157 / 100000, odometry.y);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    drive(1, 164, -164, -JP_Q24(0.125));
    TEST_ASSERT_INT64_WITHIN(METRE / 10000, -METRE * 157 / 100000, odometry.y);
    setUp();
    config.turn_shift_along = JP_Q24(0.5);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.1);
    drive(1, -164, 164, JP_Q24(0.125));
    TEST_ASSERT_INT64_WITHIN(METRE / 10000, METRE * 157 / 100000, odometry.x);
}

static void test_slide_of_the_slope(void)
{
    struct jp_path_slide slide;

    config.turn_creep_across = JP_Q24(1);
    config.turn_shift_across = JP_Q24(0.5);
    config.creep = JP_Q24(0.1);
    sensors.accel_x = JP_Q24(0.1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.2);
    jp_skid_odometry_slide(&odometry, &config, &slide);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.1), slide.ahead);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.2), slide.left);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q24(1), slide.by_turn);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.5), slide.by_left);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(4), slide.most);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.1), slide.by_way);
}

static void test_bend_pushes_outwards(void)
{
    config.creep = JP_Q24(0.5);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    drive(1, 256, 256, JP_Q24(0.125)); /* 0.78125 m/s · 0.785 rad/s = 0.0626 g */
    TEST_ASSERT_INT64_WITHIN(METRE / 20000, METRE / 32 * (1571 - 3130) / 100000, odometry.y);
}

static void test_stand_shows_the_bias_of_the_pitch_gyro(void)
{
    sensors.pitch_rate = DEGREE;
    drive(400, 0, 0, 0);
    TEST_ASSERT_INT32_WITHIN(300000, (int32_t)((int64_t)DEGREE * 65536 / 25), odometry.internal.tilt.pitch_bias);
    drive(25, 256, 256, 0); /* does not nod */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), 0, odometry.internal.tilt.state[JP_SKID_TILT_AHEAD]);
}

/* A robot that is tipped over by hand, with wheels that stand. */
static void test_bias_of_the_pitch_gyro_is_limited(void)
{
    sensors.pitch_rate = JP_Q24(100);
    drive(100, 0, 0, 0);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX / 2, odometry.internal.tilt.pitch_bias);
    sensors.pitch_rate = -JP_Q24(100);
    drive(100, 0, 0, 0);
    TEST_ASSERT_EQUAL_INT32(-(INT32_MAX / 2), odometry.internal.tilt.pitch_bias);
}

/* The grade is not what the robot's own acceleration is. */
static void test_acceleration_is_no_grade(void)
{
    for (int32_t step = 0; step < 20; step++) {
        sensors.accel_x = step == 0 ? 0 : JP_Q24(0.0778); /* 10 counts a tick more each step: 0.763 m/s² */
        drive(1, step * 10, step * 10, 0);
    }
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), 0, odometry.internal.tilt.state[JP_SKID_TILT_AHEAD]);
}

/* Standing says nothing of the grade to the left; what is known of it is forgotten on the way. */
static void test_grade_to_the_left_is_forgotten(void)
{
    odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.1);
    odometry.internal.tilt.variance[JP_SKID_TILT_LEFT] = 1 << 20;
    drive(64, 256, 256, 0);
    TEST_ASSERT_TRUE(odometry.internal.tilt.state[JP_SKID_TILT_LEFT] < JP_Q24(0.06));
    TEST_ASSERT_TRUE(odometry.internal.tilt.variance[JP_SKID_TILT_LEFT] > 1 << 28);
    drive(1, 1 << 20, 1 << 20, 0);
    drive(1, 1 << 20, 1 << 20, 0);
    TEST_ASSERT_TRUE(odometry.internal.tilt.variance[JP_SKID_TILT_LEFT] > (1 << 30) - (1 << 28));
}

static void test_grade_is_forgotten_at_once_where_it_changes_much(void)
{
    config.tilt_change = JP_Q24(1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.1);
    odometry.internal.tilt.variance[JP_SKID_TILT_LEFT] = 1 << 20;
    drive(1, 1024, 1024, 0);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.05), odometry.internal.tilt.state[JP_SKID_TILT_LEFT]);
    TEST_ASSERT_EQUAL_INT32(1 << 30, odometry.internal.tilt.variance[JP_SKID_TILT_LEFT]);
}

/* ---- Grip ---- */

/* A turn on the spot that takes a current of each side; 0.4 g by the file. */
static void skid(jp_q16 current, int32_t steps)
{
    config.turn_force = JP_Q24(0.4);
    config.force_per_ampere = JP_Q24(0.1);
    config.rolling = JP_Q24(0.04);
    config.turn_creep_along = JP_Q24(0.5);
    config.turn_creep_across = JP_Q24(1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    sensors.current_left = -current;
    sensors.current_right = current;
    drive(steps, -82, 82, JP_Q24(0.125));
}

/* Behind the gear of ½, 0.05 g/A a side less half of the rolling resistance: 2 (0.05 i − 0.02) g. */
static void test_currents_of_a_turn_tell_the_grip(void)
{
    skid(JP_Q16(4.4), 64);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.4), odometry.internal.slip.turn_force);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.2), JP_Q24(6.2832), odometry.internal.slip.creep_across);
    skid(JP_Q16(2.4), 64);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.2), odometry.internal.slip.turn_force);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.6), JP_Q24(12.566), odometry.internal.slip.creep_across);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.3), JP_Q24(6.2832), odometry.internal.slip.creep_along);
    skid(0, 64);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.4) / 8, odometry.internal.slip.turn_force);
    skid(JP_Q16(100), 64);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.4) * 2, odometry.internal.slip.turn_force);
}

/* On a slope that lets one axle hold the robot, it takes less force to turn it on the same ground: 0.8409 of 0.4 g. */
static void test_slope_is_not_taken_for_slippery_ground(void)
{
    skid(JP_Q16(4.4), 1);
    config.turn_slide_most = JP_Q24(0.1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    sensors.current_left = -JP_Q16(3.7636); /* 2 (0.05 i − 0.02) g = 0.33636 g */
    sensors.current_right = JP_Q16(3.7636);
    for (int step = 0; step < 64; step++) {
        odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.1);
        drive(1, -82, 82, JP_Q24(0.125));
    }
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.4), odometry.internal.slip.turn_force);
}

static void test_turn_to_the_right_tells_the_same(void)
{
    skid(JP_Q16(2.4), 1);
    sensors.current_left = JP_Q16(2.4);
    sensors.current_right = -JP_Q16(2.4);
    drive(64, 82, -82, -JP_Q24(0.125));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.2), odometry.internal.slip.turn_force);
}

/* A side that brakes has its gear's loss added: −1 A are −0.2 g. */
static void test_side_that_brakes_counts_with_the_loss_of_its_gear(void)
{
    skid(0, 1);
    odometry.internal.slip.turn_force = config.turn_force;
    sensors.current_left = -JP_Q16(1);
    sensors.current_right = JP_Q16(2.8);
    drive(64, 60, 224, JP_Q24(0.125)); /* 0.14 g − (−0.2 g), the rolling resistances are alike */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.34), odometry.internal.slip.turn_force);
}

static void test_straight_way_tells_nothing_of_the_grip(void)
{
    config.creep = JP_Q24(0.1);
    skid(JP_Q16(2.4), 64);
    const int32_t before = odometry.internal.slip.turn_force;
    sensors.current_left = 0;
    sensors.current_right = 0;
    drive(1, 256, 256, 0);
    const int32_t after = odometry.internal.slip.turn_force;
    drive(16, 256, 256, 0);
    TEST_ASSERT_TRUE(after <= before);
    TEST_ASSERT_EQUAL_INT32(after, odometry.internal.slip.turn_force);
}

/* The outer side carries the same force with more slip. */
static void test_bend_loses_way(void)
{
    config.creep = JP_Q24(0.1);
    config.turn_force = JP_Q24(0.5);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    drive(1, 128, 384, 0); /* sides ± 1/64 m of 1/32 m */
    TEST_ASSERT_INT32_WITHIN((int32_t)(METRE / 100000), (int32_t)(METRE / 32 - METRE / 64 / 20),
                             odometry.internal.step.forward);
    drive(1, -128, -384, 0);
    TEST_ASSERT_INT32_WITHIN((int32_t)(METRE / 100000), -(int32_t)(METRE / 32 - METRE / 64 / 20),
                             odometry.internal.step.forward);
    drive(1, -256, 256, 0);
    TEST_ASSERT_EQUAL_INT32(0, odometry.internal.step.forward);
}

/* A right turn by a force beyond all numbers: it slides as far to its left as it may. */
static void test_push_aside_saturates(void)
{
    config.turn_shift_across = JP_Q24(8);
    config.turn_slide_most = JP_Q24(0.5);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    odometry.internal.tilt.state[JP_SKID_TILT_OFFSET] = JP_Q24_ONE;
    sensors.accel_x = -JP_Q24(2);
    drive(1, 256, -256, -JP_Q24(0.25));
    TEST_ASSERT_EQUAL_INT32(odometry.internal.slip.most, odometry.internal.slip.across);
}

/* A robot that is pushed aside in its turns turns further by the same wheels. */
static void test_ratio_grows_as_the_robot_is_pushed_aside(void)
{
    config.ratio_growth = JP_Q24(1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    odometry.internal.slip.along = 0;
    odometry.internal.slip.across = JP_Q24(0.2); /* 4 % */
    drive(100, 0, 0, 0);
    config.turn_creep_across = JP_Q24(0.3183098861837907); /* 2 m/turn */
    config.turn_creep_along = 0;
    for (int step = 0; step < 100; step++) {
        odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.1);
        drive(1, -256, 256, JP_Q24(0.40625)); /* 4 % more than the ratio says */
    }
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.004), JP_Q24(0.5), odometry.steering_ratio);
}

/* The ratio is learned the less, the more pushes the robot. */
static void test_ratio_is_hardly_learned_while_the_robot_is_pushed(void)
{
    jp_skid_odometry_start(&odometry, &config, &sensors);
    drive(20, -256, 256, JP_Q24(0.5));
    const int32_t level = odometry.internal.gyro.ratio_ratio;

    config.ratio_growth = JP_Q24(1);
    config.turn_creep_along = JP_Q24(0.5);
    sensors.accel_x = JP_Q24(0.1); /* 0.314 m/turn: 0.099 */
    jp_skid_odometry_start(&odometry, &config, &sensors);
    drive(20, -256, 256, JP_Q24(0.5));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.03), JP_Q24(0.099), odometry.internal.step.pushed);
    TEST_ASSERT_TRUE(odometry.internal.gyro.ratio_ratio > 2 * level);
}

/* ---- What is known ---- */

static struct jp_skid_estimate estimate(void)
{
    struct jp_skid_estimate known;

    jp_skid_odometry_estimate(&odometry, &config, &known);
    return known;
}

static void test_start_knows_what_the_configuration_says(void)
{
    const struct jp_skid_estimate known = estimate();

    TEST_ASSERT_EQUAL_INT32(0, known.gyro_bias);
    TEST_ASSERT_INT32_WITHIN(50, config.bias_deviation, known.gyro_bias_deviation);
    TEST_ASSERT_EQUAL_INT32(config.ratio, known.steering_ratio);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0005), config.ratio_deviation, known.steering_ratio_deviation);
    TEST_ASSERT_EQUAL_INT32(0, known.slip);
    TEST_ASSERT_EQUAL_INT32(config.way_deviation, known.slip_deviation);
    TEST_ASSERT_EQUAL_INT32(0, known.heading_deviation);
    TEST_ASSERT_EQUAL_INT64(0, known.xx);
    TEST_ASSERT_EQUAL_INT64(0, known.yy);
}

static void test_stand_makes_the_bias_known(void)
{
    drive(100, 0, 0, DEGREE);
    TEST_ASSERT_INT32_WITHIN(DEGREE / 100, DEGREE, estimate().gyro_bias);
    TEST_ASSERT_TRUE(estimate().gyro_bias_deviation < config.bias_deviation / 50);
}

/* 2 m straight on with a bias of 0.003 turn/s that nothing has told: 4 s · 0.075 rad along 2 m. */
static void test_unknown_bias_bends_the_way(void)
{
    config.way_noise = JP_Q24(0.1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    drive(100, 164, 164, 0);

    const struct jp_skid_estimate known = estimate();

    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.0754), known.heading_deviation);
    TEST_ASSERT_INT64_WITHIN(METRE / 1000, METRE * 59 / 10000, known.yy); /* (0.0754 · 2.002/2)² + 2 · 10⁻⁴ m² */
    TEST_ASSERT_INT64_WITHIN(METRE / 10000, METRE * 6 / 10000, known.xx); /* (2.002 · 0.01)² + 2 · 10⁻⁴ m² */
}

static void test_turns_leave_the_scale_unknown(void)
{
    drive(100, 0, 0, 0);
    drive(100, -256, 256, JP_Q24(0.390625)); /* 9.8 rad, of which 1 % is the gyro's */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.098), estimate().heading_deviation);
    TEST_ASSERT_TRUE(estimate().steering_ratio_deviation < config.ratio_deviation / 2);
    TEST_ASSERT_INT64_WITHIN(METRE / 1000, METRE * 39 / 10000, estimate().xx); /* 0.02² · 9.8 m² */
}

static void test_slip_is_a_share_of_the_way(void)
{
    config.creep = JP_Q24(0.1);
    climb(JP_Q24(0.1), 16);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(0.01), estimate().slip);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.005), JP_Q24(0.1), estimate().grade_ahead);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), 0, estimate().grade_left);
}

static void test_deviations_saturate(void)
{
    odometry.x = INT64_MAX;
    odometry.y = INT64_MIN;
    odometry.internal.past.bias_x = INT32_MAX;
    odometry.internal.past.bias_y = INT32_MIN;
    odometry.internal.past.scale_x = INT32_MAX;
    odometry.internal.past.turned = INT32_MAX;
    odometry.internal.past.turn = INT32_MAX;
    odometry.internal.past.way = INT32_MAX;
    odometry.internal.past.steps = 1 << 25;
    TEST_ASSERT_TRUE(estimate().xx > 0);
    TEST_ASSERT_TRUE(estimate().yy > 0);
    TEST_ASSERT_TRUE(estimate().heading_deviation > 0);
}

static void start_with(jp_q24 accel_noise, jp_q24 tilt_deviation)
{
    config.accel_noise = accel_noise;
    config.tilt_deviation = tilt_deviation;
    jp_skid_odometry_start(&odometry, &config, &sensors);
}

/* What is quieter or louder than the filters can add up counts as the quietest or the loudest. */
static void test_noise_beyond_the_filters_is_limited(void)
{
    start_with(1, JP_Q24(0.5));
    TEST_ASSERT_EQUAL_INT32((int32_t)1 << 16, odometry.internal.tilt.accel_variance);
    start_with(JP_Q24(0.5), JP_Q24(0.001));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, odometry.internal.tilt.accel_variance);
}

static void test_a_bias_that_is_known_to_the_bit_has_a_deviation(void)
{
    config.bias_deviation = 1;
    jp_skid_odometry_start(&odometry, &config, &sensors);
    TEST_ASSERT_EQUAL_INT32(16, odometry.internal.gyro.bias_unit);
    TEST_ASSERT_TRUE(estimate().gyro_bias_deviation >= 0);
}

/* As a flipped bit of the memory would leave it: the next step goes on. */
static void test_a_part_that_is_none_does_nothing(void)
{
    odometry.internal.next = (enum jp_skid_odometry_part)99;
    jp_skid_odometry_update(&odometry, &config, &sensors);
    TEST_ASSERT_EQUAL_INT(JP_SKID_ADD_UP, odometry.internal.next);
}

/* What it drove after a bias of which it knows nothing: no square exceeds 64 bits. */
static void test_a_heading_that_nothing_is_known_of_saturates(void)
{
    config.tick_rate = 100;
    config.step_ticks = 32;
    config.bias_deviation = JP_Q24(0.1);
    config.scale_deviation = JP_Q24(0.1);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    odometry.internal.past.steps = (int32_t)1 << 25;
    odometry.internal.past.turned = INT32_MIN;
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, estimate().heading_deviation);
    TEST_ASSERT_TRUE(estimate().steering_ratio_deviation > 0);
}

/* ---- The gyro's scale, from drive to drive ---- */

#define Q30_PERCENT 10737418

static const struct jp_gyro_scale nothing;

static struct jp_gyro_scale scale(void)
{
    struct jp_gyro_scale known;

    jp_skid_odometry_scale(&odometry, &config, &known);
    return known;
}

static void expect_scale(double percent, double deviation_percent)
{
    const struct jp_gyro_scale known = scale();

    TEST_ASSERT_INT32_WITHIN(Q30_PERCENT / 20, (int32_t)(percent * Q30_PERCENT), known.error);
    TEST_ASSERT_INT32_WITHIN(Q30_PERCENT / 20, (int32_t)(deviation_percent * Q30_PERCENT), known.deviation);
}

/** A drive that begins with what is known, and turns on the spot: of the turn by the file's ratio the gyro shows so
 * many percent more. */
static void turn_with(const struct jp_gyro_scale *known, double percent)
{
    config.turn_noise = JP_Q24(0.003);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    jp_skid_odometry_know_scale(&odometry, &config, known);
    drive(100, 0, 0, 0);
    drive(600, -256, 256, (jp_turns_per_s)(JP_Q24(0.390625) * (1 + percent / 100)));
}

static void test_a_start_knows_of_the_scale_what_the_configuration_says(void)
{
    expect_scale(0, 1);
    config.scale_deviation = 0;
    jp_skid_odometry_start(&odometry, &config, &sensors);
    expect_scale(0, 0);
}

/* Wheels that are known as well as the gyro: half of what turns show is the one's, half the other's. */
static void test_a_drive_shares_what_it_finds_between_gyro_and_wheels(void)
{
    config.ratio_deviation = JP_Q24(0.005);
    turn_with(&nothing, 1.0);
    expect_scale(0.5, 0.707);
}

static void test_wheels_that_are_known_leave_the_gyro_all_of_it(void)
{
    config.ratio_deviation = JP_Q24(0.0001);
    turn_with(&nothing, 1.0);
    expect_scale(1.0, 0.1); /* the turns themselves vary */
}

static void test_what_a_drive_has_found_of_the_scale_is_where_the_next_one_begins(void)
{
    struct jp_gyro_scale known;

    config.ratio_deviation = JP_Q24(0.0001);
    turn_with(&nothing, 1.0);
    known = scale();
    jp_skid_odometry_start(&odometry, &config, &sensors);
    jp_skid_odometry_know_scale(&odometry, &config, &known);
    expect_scale(1.0, 0.1); /* the turns themselves vary */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0002), JP_Q24(0.5), odometry.steering_ratio);

    /* The first turn is told right. */
    drive(100, 0, 0, 0);
    const int32_t before = heading_degrees_1000();

    drive(8, -256, 256, (jp_turns_per_s)(JP_Q24(0.390625) * 1.01));
    TEST_ASSERT_INT32_WITHIN(25, 45000, heading_degrees_1000() - before);
}

/* The error of the file's ratio is that of all drives: many of them know no more of the scale than a long one. */
static void test_many_drives_are_not_surer_than_the_wheels_let_them_be(void)
{
    config.ratio_deviation = JP_Q24(0.005);
    for (unsigned i = 0; i < 20; i++) {
        const struct jp_gyro_scale known = scale();

        turn_with(&known, 1.0);
    }
    TEST_ASSERT_INT32_WITHIN(Q30_PERCENT / 20, (int32_t)(0.707 * Q30_PERCENT), scale().deviation);
}

/* Grounds change and gyros do not: of a ratio that is another than the file's, what is known of the gyro is kept. */
static void test_another_ground_hardly_changes_a_scale_that_is_known(void)
{
    const struct jp_gyro_scale known = {Q30_PERCENT, Q30_PERCENT / 10};

    config.ratio_deviation = JP_Q24(0.05);
    turn_with(&known, 100 * (1.01 * 0.8 - 1)); /* 20 % less than the wheels say */
    TEST_ASSERT_INT32_WITHIN(Q30_PERCENT / 50, Q30_PERCENT, scale().error);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.005), JP_Q24(0.4), odometry.steering_ratio);
}

static void test_scales_at_their_limits_are_taken(void)
{
    const struct jp_gyro_scale most = {JP_GYRO_SCALE_MAX, JP_GYRO_SCALE_DEVIATION_MAX};
    const struct jp_gyro_scale least = {-JP_GYRO_SCALE_MAX, 1};

    jp_skid_odometry_know_scale(&odometry, &config, &most);
    drive(100, -256, 256, JP_Q24(0.5));
    TEST_ASSERT_TRUE(scale().error <= JP_GYRO_SCALE_MAX);
    jp_skid_odometry_know_scale(&odometry, &config, &least);
    drive(100, -256, 256, JP_Q24(-0.5));
    TEST_ASSERT_TRUE(scale().error >= -JP_GYRO_SCALE_MAX);
    TEST_ASSERT_TRUE(scale().deviation > 0);
}
