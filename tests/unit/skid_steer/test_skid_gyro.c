/* The filter of the gyro against the formulas in double precision: what it begins with, a step of it, and what becomes
 * of the scale. */
#include "src/skid_steer/skid_arithmetic.h"
#include "src/skid_steer/skid_gyro.h"
#include "tests/support/random.h"
#include "unity.h"

#define IN_Q24 16777216.0
#define IN_Q30 1073741824.0
#define IN_Q32 4294967296.0
#define TWO_PI 6.283185307179586

static struct jp_skid_odometry_config config;
static struct jp_skid_gyro gyro;
static struct jp_skid_step step;

static void start(void)
{
    const struct jp_gyro_scale known = jp_skid_gyro_scale_by_file(&config);

    jp_skid_gyro_start(&gyro, &config, &known);
}

void setUp(void)
{
    config = (struct jp_skid_odometry_config){
        .tick_rate = 200,
        .step_ticks = 8,
        .turn_per_count = (int32_t)1 << 23,
        .ratio = JP_Q24(0.5),
        .ratio_deviation = JP_Q24(0.04),
        .scale_deviation = JP_Q24(0.06),
        .bias_deviation = JP_Q24(0.003),
        .bias_memory = 1000,
        .gyro_noise = JP_Q24(0.0003),
        .way_noise = JP_Q24(0.005),
        .turn_noise = JP_Q24(0.03125),
    };
    step = (struct jp_skid_step){0};
    begin_random(5, 0);
    start();
}

void tearDown(void)
{
}

static double size(double x)
{
    return x < 0 ? -x : x;
}

/** Within a share of what is expected, and one. */
static void expect_near(double expected, int64_t actual, double share)
{
    TEST_ASSERT_TRUE(size((double)actual - expected) <= size(expected) * share + 1);
}

/* Of a step of 0.04 s, 2⁻³² turn. */
#define UNIT (0.003 * 0.04 * IN_Q32)

static void test_the_deviations_at_the_start_are_the_files(void)
{
    const double of_scale = 0.06 * 0.5;

    expect_near(UNIT, gyro.bias_unit, 1e-5);
    TEST_ASSERT_INT32_WITHIN(2, JP_Q24(0.05), gyro.ratio_unit); /* √(0.04² + 0.03²) */
    expect_near(0.05 * IN_Q24 * 65536 / UNIT, gyro.ratio_weight, 1e-5);
    TEST_ASSERT_EQUAL_INT32((int32_t)(gyro.ratio_unit * 65536.0 / gyro.bias_unit), gyro.ratio_weight);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(2), gyro.ratio_reciprocal);
    expect_near(of_scale * of_scale / (0.05 * 0.05) * IN_Q30, gyro.scale_share, 1e-5);
    TEST_ASSERT_EQUAL_INT32(JP_SKID_ONE, gyro.bias_bias);
    TEST_ASSERT_EQUAL_INT32(0, gyro.bias_ratio);
    TEST_ASSERT_EQUAL_INT32(JP_SKID_ONE, gyro.ratio_ratio);
    TEST_ASSERT_EQUAL_INT32(JP_SKID_ONE / 2, gyro.ratio);
    TEST_ASSERT_EQUAL_INT32(JP_SKID_ONE / 2, gyro.ratio_start);
    TEST_ASSERT_EQUAL_INT32(JP_SKID_ONE, gyro.scale);
    TEST_ASSERT_EQUAL_INT32(0, gyro.bias);
}

/* All variances are over the square of the bias' in a step. */
static void test_variances_at_the_start_are_the_files(void)
{
    const double gyro_share = 0.0003 / 0.003;
    const double count_share = 32768.0 / UNIT; /* a count turns by 2⁻¹⁷ turn */
    const double way_share = 0.005 * IN_Q32 / UNIT;
    const double turn_share = 0.03125 * IN_Q32 / UNIT;

    expect_near(gyro_share * gyro_share / 8 * IN_Q30, gyro.gyro_variance, 0.002);
    expect_near(count_share * count_share / 6 * IN_Q30, gyro.count_variance, 1e-3);
    expect_near(way_share * way_share * 16384, gyro.way_variance, 0.002);
    /* Of a turn by one radian it is turn_noise². */
    expect_near(turn_share * turn_share / TWO_PI * IN_Q30 / IN_Q32, gyro.turn_variance, 0.01);
    expect_near(512, gyro.per_turn_noise, 1e-3);
    expect_near(IN_Q30 * 0.04 / 1000, gyro.bias_growth, 1e-4);
}

static void test_a_bias_that_hardly_varies_has_a_least_unit(void)
{
    config.bias_deviation = 16 * 25 / 256 + 1; /* 2⁻²⁴ turn/s */
    start();
    TEST_ASSERT_EQUAL_INT32(20, gyro.bias_unit);
    config.bias_deviation = 1;
    start();
    TEST_ASSERT_EQUAL_INT32(16, gyro.bias_unit);
}

/* However slowly it wanders, its variance grows. */
static void test_a_bias_that_hardly_wanders_grows_unsure(void)
{
    config.bias_memory = 100000000;
    start();
    TEST_ASSERT_EQUAL_INT32(1, gyro.bias_growth);
}

/* It shows 1 + error of a turn. */
static void test_a_scale_that_is_known_is_where_it_begins(void)
{
    const struct jp_gyro_scale known = {JP_SKID_ONE / 16, JP_SKID_ONE / 64};

    jp_skid_gyro_start(&gyro, &config, &known);
    TEST_ASSERT_EQUAL_INT32(JP_SKID_ONE / 2 + JP_SKID_ONE / 32, gyro.ratio);
    TEST_ASSERT_EQUAL_INT32(gyro.ratio, gyro.ratio_start);
    TEST_ASSERT_EQUAL_INT32(JP_SKID_ONE - JP_SKID_ONE / 16 + JP_SKID_ONE / 256, gyro.scale);
    TEST_ASSERT_EQUAL_INT32(known.error, jp_skid_gyro_scale_error(&gyro));
    TEST_ASSERT_EQUAL_INT32(JP_Q24_ONE / 64, gyro.scale_deviation);
}

/* ---- A step ---- */

/** Bias in units of its deviation, ratio as it is, covariances in units. */
struct filter {
    double bias; /* 2⁻⁴⁰ turn */
    double ratio;
    double bb;
    double br;
    double rr;
};

static double lesser(double a, double b)
{
    return a < b ? a : b;
}

/** The Kalman filter of skid_odometry.h, from where the gyro is. */
static struct filter kalman(bool is_moving)
{
    struct filter f = {gyro.bias, gyro.ratio / IN_Q30, gyro.bias_bias / IN_Q30, gyro.bias_ratio / IN_Q30,
                       gyro.ratio_ratio / IN_Q30};
    const double turn = step.pushed_turn; /* 2⁻³² turn */
    const double unit = gyro.bias_unit;
    const double ratio_unit = gyro.ratio_unit / IN_Q24;
    const double shows = turn * ratio_unit / unit; /* of a deviation of the ratio, in deviations of the bias */
    const double h = shows < -32 ? -32 : lesser(shows, 32);
    const double unsure = lesser((16 + step.pushed / IN_Q24 * gyro.per_turn_noise) / 16, 16);
    const double wheels = lesser(gyro.turn_variance * size(step.wheel_turn) / IN_Q30, 1024) * unsure * unsure;
    const double noise = (double)gyro.gyro_variance / IN_Q30 + (is_moving ? (double)gyro.count_variance / IN_Q30 : 0) +
                         gyro.way_variance / 16384.0 * size(step.way) / IN_Q32 + wheels;

    f.bb = lesser(f.bb + gyro.bias_growth / IN_Q30, 1);
    f.rr = lesser(f.rr + size(turn) / IN_Q32 * 4 / 2048, 1);
    const double of_bias = f.bb + f.br * h;
    const double of_ratio = f.br + f.rr * h;
    const double variance = of_bias + of_ratio * h + noise;
    const double surprise = (step.gyro_turn - f.bias / 256 - turn * f.ratio) / unit;

    f.bias += surprise * of_bias / variance * unit * 256;
    f.ratio += surprise * of_ratio / variance * ratio_unit;
    f.bb -= of_bias * of_bias / variance;
    f.br -= of_bias * of_ratio / variance;
    f.rr -= of_ratio * of_ratio / variance;
    return f;
}

static void expect_step(bool is_moving)
{
    const struct filter f = kalman(is_moving);
    const int32_t before = gyro.bias;

    jp_skid_gyro_learn(&gyro, &step, is_moving);
    expect_near(f.bias - before, gyro.bias - before, 0.002);
    TEST_ASSERT_EQUAL_INT32(gyro.bias - before, gyro.bias_change);
    TEST_ASSERT_INT32_WITHIN(20000, (int32_t)(f.ratio * IN_Q30), gyro.ratio);
    TEST_ASSERT_INT32_WITHIN(40000, (int32_t)(lesser(f.bb, 1 - 1 / IN_Q30) * IN_Q30), gyro.bias_bias);
    TEST_ASSERT_INT32_WITHIN(40000, (int32_t)(f.br * IN_Q30), gyro.bias_ratio);
    TEST_ASSERT_INT32_WITHIN(40000, (int32_t)(f.rr * IN_Q30), gyro.ratio_ratio);
}

static void test_a_stand_teaches_the_bias_by_the_formulas(void)
{
    for (int i = 0; i < 40; i++) {
        step.gyro_turn = (int32_t)uniform(-200000, 900000);
        expect_step(false);
    }
}

/* Wheels that move by nothing have counts that come and go. */
static void test_counts_make_a_motion_less_sure(void)
{
    for (int i = 0; i < 40; i++) {
        step.gyro_turn = (int32_t)uniform(-200000, 900000);
        expect_step(true);
    }
}

/* Turns that show the ratio by up to 32 deviations of the bias, and what is beyond. */
static void test_long_turns_teach_by_the_formulas(void)
{
    for (int i = 1; i <= 40; i++) {
        start();
        step.wheel_turn = (int32_t)(i * UNIT / 0.05) * (i % 2 == 0 ? 1 : -1);
        step.pushed_turn = step.wheel_turn;
        step.gyro_turn = step.pushed_turn / 2 + (int32_t)uniform(-400000, 400000);
        expect_step(true);
    }
}

/* What is louder than 128 deviations counts as that. */
static void test_noise_beyond_the_filter_is_limited(void)
{
    gyro.count_variance = (int64_t)1 << 50;
    step.gyro_turn = (int32_t)1 << 24;
    jp_skid_gyro_learn(&gyro, &step, true);
    TEST_ASSERT_INT32_WITHIN(16, (1 << 24) / 512, gyro.bias_change);
}

static void test_steps_teach_by_the_formulas(void)
{
    for (int i = 0; i < 150; i++) {
        if (i % 50 == 0) {
            start();
        }
        step.wheel_turn = (int32_t)uniform(-2e7, 2e7);
        step.pushed_turn = step.wheel_turn + (int32_t)uniform(-1e6, 1e6);
        step.gyro_turn = step.pushed_turn / 2 + (int32_t)uniform(-400000, 400000);
        step.way = (int32_t)uniform(-2e8, 2e8);
        step.pushed = i % 3 == 0 ? 0 : i % 3 == 1 ? JP_Q24(0.125) : JP_Q24(1);
        expect_step(true);
    }
}

/* What the wheels have told is forgotten within 512 turns. */
static void test_the_ratio_grows_unsure_again(void)
{
    gyro.ratio_ratio = JP_SKID_ONE / 8;
    gyro.gyro_variance = (int64_t)1 << 47; /* which teaches nothing */
    step.pushed_turn = (int32_t)1 << 30;
    jp_skid_gyro_learn(&gyro, &step, true);
    TEST_ASSERT_INT32_WITHIN(300000, JP_SKID_ONE / 8 + JP_SKID_ONE / 2048, gyro.ratio_ratio);
}

static void test_a_ratio_is_never_too_small(void)
{
    gyro.ratio = JP_SKID_ONE / 16 + 1000;
    step.pushed_turn = 20000000;
    step.gyro_turn = -20000000;
    jp_skid_gyro_learn(&gyro, &step, true);
    TEST_ASSERT_EQUAL_INT32(JP_SKID_ONE / 16, gyro.ratio);
}

/* ---- Scale ---- */

/* γ0 and its share of what the ratio has changed by; the rest is the wheels'. */
static void test_the_scale_takes_its_share_of_what_was_learned(void)
{
    const double share = 0.36;

    gyro.ratio += gyro.ratio / 10;
    const int32_t error = jp_skid_gyro_scale_error(&gyro);

    expect_near(0.1 * share * IN_Q30, error, 1e-5);
    const jp_q24 ratio = jp_skid_gyro_rescale(&gyro);
    const double scale = 1 - 0.1 * share + 0.1 * share * 0.1 * share;

    expect_near(scale * IN_Q30, gyro.scale, 1e-6);
    TEST_ASSERT_EQUAL_INT32(gyro.scale - JP_SKID_ONE, gyro.scale_change);
    expect_near(0.55 * scale * IN_Q24, ratio, 1e-6);
    (void)jp_skid_gyro_rescale(&gyro);
    TEST_ASSERT_EQUAL_INT32(0, gyro.scale_change);
}

static void test_the_scale_has_limits(void)
{
    gyro.scale_share = JP_SKID_ONE;
    gyro.ratio = 3 * (JP_SKID_ONE / 4);
    TEST_ASSERT_EQUAL_INT32(JP_GYRO_SCALE_MAX, jp_skid_gyro_scale_error(&gyro));
    gyro.ratio = JP_SKID_ONE / 16;
    TEST_ASSERT_EQUAL_INT32(-JP_GYRO_SCALE_MAX, jp_skid_gyro_scale_error(&gyro));
}
