/* What the odometry knows and how well, against the formulas in double precision. */
#include "src/skid_steer/skid_arithmetic.h"
#include "tests/support/random.h"
#include "unity.h"

#define IN_Q16 65536.0
#define IN_Q24 16777216.0
#define IN_Q30 1073741824.0
#define IN_Q32 4294967296.0
#define TWO_PI 6.283185307179586

static struct jp_skid_odometry_config config;
static struct jp_skid_odometry odometry;
static struct jp_sensors sensors;
static struct jp_skid_estimate estimate;

static void start(void)
{
    jp_skid_odometry_start(&odometry, &config, &sensors);
}

void setUp(void)
{
    config = (struct jp_skid_odometry_config){
        .tick_rate = 200,
        .step_ticks = 8,
        .way_per_count = (int32_t)1 << 24,
        .turn_per_count = (int32_t)1 << 23,
        .ratio = JP_Q24(0.5),
        .ratio_deviation = JP_Q24(0.04),
        .scale_deviation = JP_Q24(0.06),
        .bias_deviation = JP_Q24(0.003),
        .bias_memory = 1000000,
        .gyro_noise = JP_Q24(0.0003),
        .way_noise = JP_Q24(0.005),
        .turn_noise = JP_Q24(0.03),
        .tilt_deviation = JP_Q24(0.1),
        .tilt_change = JP_Q24(0.08),
        .accel_noise = JP_Q24(0.005),
        .efficiency = JP_Q24(0.5),
        .way_deviation = JP_Q24(0.01),
        .way_drift = JP_Q24(0.25),
        .turn_drift = JP_Q24(0.375),
    };
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE};
    estimate = (struct jp_skid_estimate){.xx = 7, .xy = 7, .yy = 7, .grade_ahead = 7, .grade_left = 7};
    begin_random(23, 0);
    start();
}

void tearDown(void)
{
}

static void look(void)
{
    jp_skid_odometry_estimate(&odometry, &config, &estimate);
}

static double square(double x)
{
    return x * x;
}

/** Within 0.1 % of the greatest of its kind. */
static void expect_near(double expected, double actual, double greatest)
{
    const double error = expected < actual ? actual - expected : expected - actual;

    TEST_ASSERT_TRUE(greatest > 0);
    TEST_ASSERT_TRUE(error <= greatest / 1000);
}

/** Anything that a drive may have left. */
static void set_any(void)
{
    odometry.x = (int64_t)uniform(-200 * IN_Q32, 200 * IN_Q32);
    odometry.y = (int64_t)uniform(-200 * IN_Q32, 200 * IN_Q32);
    odometry.internal.gyro.bias_bias = (int32_t)uniform(0.05 * IN_Q30, 0.5 * IN_Q30);
    odometry.internal.gyro.ratio_ratio = (int32_t)uniform(0.01 * IN_Q30, IN_Q30);
    odometry.internal.past = (struct jp_skid_past){
        .way = (int32_t)uniform(0, 200 * IN_Q16),
        .turn = (int32_t)uniform(0, 100 * IN_Q16),
        .turned = (int32_t)uniform(-8 * IN_Q24, 8 * IN_Q24),
        .steps = (int32_t)uniform(1, 4000) * 256,
        .bias_x = (int32_t)uniform(-8e3 * 256, 8e3 * 256),
        .bias_y = (int32_t)uniform(-8e3 * 256, 8e3 * 256),
        .scale_x = (int32_t)uniform(-30 * IN_Q16, 30 * IN_Q16),
        .scale_y = (int32_t)uniform(-30 * IN_Q16, 30 * IN_Q16),
    };
}

/** Variance of the gyro's scale: its share of r stays as unknown as r is. */
static double scale_variance(void)
{
    const double share = square(0.06 * 0.5) / (square(0.06 * 0.5) + square(0.04));

    return square(0.06) * (1 - share * (1 - odometry.internal.gyro.ratio_ratio / IN_Q30));
}

/** Of the bias, turn² in a step of 0.04 s. */
static double bias_variance(void)
{
    return square(0.003 * 0.04) * odometry.internal.gyro.bias_bias / IN_Q30;
}

static void test_deviations_of_what_is_learned(void)
{
    for (int i = 0; i < 50; i++) {
        set_any();
        look();
        const struct jp_skid_past *past = &odometry.internal.past;
        const double by_bias = square(past->steps / 256.0) * bias_variance();
        const double by_scale = square(past->turned / IN_Q24) * scale_variance();
        const double of_ratio = square(0.05) * odometry.internal.gyro.ratio_ratio / IN_Q30;
        const double of_bias = bias_variance() / square(0.04);
        const double of_both = of_ratio + scale_variance() * square(0.5);
        const double of_heading = square(TWO_PI) * (by_bias + by_scale);

        expect_near(of_bias, square(estimate.gyro_bias_deviation / IN_Q24), of_bias);
        expect_near(of_both, square(estimate.steering_ratio_deviation / IN_Q24), of_both);
        expect_near(of_heading, square(estimate.heading_deviation / IN_Q24), of_heading);
    }
}

/* Of four causes that know nothing of each other: the walk, the wheels' size, the bias and the scale. */
static void test_covariance_of_the_position(void)
{
    for (int i = 0; i < 50; i++) {
        set_any();
        look();
        const struct jp_skid_past *past = &odometry.internal.past;
        const double walk = square(0.25) * past->way / IN_Q16 + square(0.375) * TWO_PI * past->turn / IN_Q16;
        const struct {
            double variance;
            double x;
            double y;
        } causes[] = {
            {square(0.01), (double)odometry.x / IN_Q32, (double)odometry.y / IN_Q32},
            {bias_variance(), TWO_PI * past->bias_x / 256, TWO_PI * past->bias_y / 256},
            {scale_variance(), TWO_PI * past->scale_x / IN_Q16, TWO_PI * past->scale_y / IN_Q16},
        };
        double xx = walk;
        double xy = 0;
        double yy = walk;

        for (unsigned cause = 0; cause < sizeof causes / sizeof *causes; cause++) {
            xx += causes[cause].variance * square(causes[cause].x);
            xy += causes[cause].variance * causes[cause].x * causes[cause].y;
            yy += causes[cause].variance * square(causes[cause].y);
        }
        expect_near(xx, (double)estimate.xx / IN_Q32, xx);
        expect_near(yy, (double)estimate.yy / IN_Q32, yy);
        expect_near(xy, (double)estimate.xy / IN_Q32, xx + yy);
    }
}

static void test_a_start_knows_where_it_is(void)
{
    look();
    TEST_ASSERT_EQUAL_INT64(0, estimate.xx);
    TEST_ASSERT_EQUAL_INT64(0, estimate.xy);
    TEST_ASSERT_EQUAL_INT64(0, estimate.yy);
    TEST_ASSERT_EQUAL_INT32(0, estimate.heading_deviation);
}

static void test_what_is_known_now(void)
{
    odometry.bias_rate = JP_Q24(0.001);
    odometry.steering_ratio = JP_Q24(0.45);
    odometry.internal.tilt.state[JP_SKID_TILT_AHEAD] = JP_Q24(0.1);
    odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = -JP_Q24(0.2);
    odometry.internal.step.way = -((int32_t)1 << 28);
    odometry.internal.step.forward = -((int32_t)7 << 25);
    look();
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.001), estimate.gyro_bias);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.45), estimate.steering_ratio);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.1), estimate.grade_ahead);
    TEST_ASSERT_EQUAL_INT32(-JP_Q24(0.2), estimate.grade_left);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.125), estimate.slip);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.01), estimate.slip_deviation);
}

/* ---- Scale ---- */

static void expect_deviation(int32_t deviation)
{
    struct jp_gyro_scale known;

    jp_skid_odometry_scale(&odometry, &config, &known);
    TEST_ASSERT_EQUAL_INT32(deviation, known.deviation);
}

/* From a gyro that is exact, of which nothing is to be learned, to the worst there may be. */
static void test_a_start_tells_the_scale_as_the_file_does(void)
{
    expect_deviation(JP_Q24(0.06) * 64);
    config.scale_deviation = 0;
    start();
    expect_deviation(0);
    config.scale_deviation = JP_Q24(0.1);
    start();
    expect_deviation(JP_GYRO_SCALE_DEVIATION_MAX);
}

/* Whatever it was told, it can be kept. */
static void test_a_scale_is_told_within_its_limits(void)
{
    jp_skid_odometry_know_scale(&odometry, &config, &(struct jp_gyro_scale){0, 2 * JP_GYRO_SCALE_DEVIATION_MAX});
    expect_deviation(JP_GYRO_SCALE_DEVIATION_MAX);
}
