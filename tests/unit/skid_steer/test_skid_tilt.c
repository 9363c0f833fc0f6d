/* The filter of the tilt against the formulas in double precision: what it begins with, a step of the way, a stand, and
 * what the accelerometer teaches. */
#include "src/skid_steer/skid_arithmetic.h"
#include "src/skid_steer/skid_tilt.h"
#include "tests/support/random.h"
#include "unity.h"

#define AHEAD  JP_SKID_TILT_AHEAD
#define LEFT   JP_SKID_TILT_LEFT
#define OFFSET JP_SKID_TILT_OFFSET
#define STATES JP_SKID_TILT_STATES

#define IN_Q24 16777216.0
#define IN_Q30 1073741824.0
#define IN_Q32 4294967296.0
#define TWO_PI 6.283185307179586

/* 3 · 10⁻⁵ of Q24: reciprocals have 16 bits. */
#define NEAR 500

static struct jp_skid_odometry_config config;
static struct jp_skid_tilt tilt;
static struct jp_skid_step step;

void setUp(void)
{
    config = (struct jp_skid_odometry_config){
        .tick_rate = 200,
        .step_ticks = 8,
        .tilt_deviation = JP_Q24(0.125),
        .tilt_change = JP_Q24(0.1),
        .accel_noise = JP_Q24(0.0125),
        .accel_offset = JP_Q24(0.03125),
    };
    step = (struct jp_skid_step){0};
    begin_random(11, 0);
    jp_skid_tilt_start(&tilt, &config, JP_Q24(0.25));
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

/* ---- Start ---- */

/* The grade as far as it may vary, the offset as the file has it: 1/4 of that. */
static void test_it_begins_on_the_grade_that_the_stand_reads(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.25), tilt.state[AHEAD]);
    TEST_ASSERT_EQUAL_INT32(0, tilt.state[LEFT]);
    TEST_ASSERT_EQUAL_INT32(0, tilt.state[OFFSET]);
    TEST_ASSERT_EQUAL_INT32(JP_SKID_ONE, tilt.variance[AHEAD]);
    TEST_ASSERT_EQUAL_INT32(JP_SKID_ONE, tilt.variance[LEFT]);
    TEST_ASSERT_EQUAL_INT32(JP_SKID_ONE / 16, tilt.variance[OFFSET]);
    TEST_ASSERT_EQUAL_INT32(0, tilt.grade_covariance);
    TEST_ASSERT_EQUAL_INT32(0, tilt.offset_covariance[AHEAD]);
    TEST_ASSERT_EQUAL_INT32(0, tilt.offset_covariance[LEFT]);
    TEST_ASSERT_EQUAL_INT32(0, tilt.pitch_bias);
    TEST_ASSERT_EQUAL_INT32(0, tilt.unrest);
}

/* An offset that is known has the least variance there is; none is less known than a grade. */
static void test_the_offset_has_a_variance_from_the_least_to_one(void)
{
    config.accel_offset = 0;
    jp_skid_tilt_start(&tilt, &config, 0);
    TEST_ASSERT_EQUAL_INT32(1, tilt.variance[OFFSET]);
    config.accel_offset = JP_Q24(0.5);
    jp_skid_tilt_start(&tilt, &config, 0);
    TEST_ASSERT_EQUAL_INT32(JP_SKID_ONE, tilt.variance[OFFSET]);
}

static void test_what_it_weighs_by_is_the_files(void)
{
    expect_near(0.01 * IN_Q30, tilt.accel_variance, 1e-3);  /* (0.0125/0.125)² */
    expect_near(0.64 * 16384, tilt.fading, 1e-2);           /* (0.1/0.125)² in a metre */
    TEST_ASSERT_EQUAL_INT32(8 * 32768, tilt.reciprocal);    /* 1/0.125 */
    expect_near(625 / 9.80665 * 256, tilt.acceleration, 0); /* of a step of 0.04 s */
}

/* ---- Way ---- */

/** States in g and covariances over tilt_deviation². */
struct filter {
    double state[STATES];
    double p[STATES][STATES];
};

static struct filter filter_now(void)
{
    const double ao = tilt.offset_covariance[AHEAD] / IN_Q30;
    const double lo = tilt.offset_covariance[LEFT] / IN_Q30;
    const double al = tilt.grade_covariance / IN_Q30;

    return (struct filter){
        {tilt.state[AHEAD] / IN_Q24, tilt.state[LEFT] / IN_Q24, tilt.state[OFFSET] / IN_Q24},
        {{tilt.variance[AHEAD] / IN_Q30, al, ao},
         {al, tilt.variance[LEFT] / IN_Q30, lo},
         {ao, lo, tilt.variance[OFFSET] / IN_Q30}},
    };
}

/** Of any states, and any covariances that there can be: L Lᵀ. */
static void set_any(void)
{
    double l[STATES][STATES] = {{uniform(0.3, 0.8)}, {uniform(-0.4, 0.4), uniform(0.3, 0.7)}};
    double p[STATES][STATES] = {{0}};

    l[OFFSET][AHEAD] = uniform(-0.3, 0.3);
    l[OFFSET][LEFT] = uniform(-0.3, 0.3);
    l[OFFSET][OFFSET] = uniform(0.1, 0.4);
    for (unsigned i = 0; i < STATES; i++) {
        tilt.state[i] = (jp_q24)uniform(-0.4 * IN_Q24, 0.4 * IN_Q24);
        for (unsigned j = 0; j < STATES; j++) {
            for (unsigned k = 0; k < STATES; k++) {
                p[i][j] += l[i][k] * l[j][k] * IN_Q30;
            }
        }
        tilt.variance[i] = (int32_t)p[i][i];
    }
    tilt.grade_covariance = (int32_t)p[AHEAD][LEFT];
    tilt.offset_covariance[AHEAD] = (int32_t)p[OFFSET][AHEAD];
    tilt.offset_covariance[LEFT] = (int32_t)p[OFFSET][LEFT];
}

static void expect_filter(const struct filter *f)
{
    const struct filter now = filter_now();

    for (unsigned i = 0; i < STATES; i++) {
        TEST_ASSERT_INT32_WITHIN(NEAR, (int32_t)(f->state[i] * IN_Q24), (int32_t)(now.state[i] * IN_Q24));
        for (unsigned j = 0; j < STATES; j++) {
            TEST_ASSERT_INT32_WITHIN(NEAR, (int32_t)(f->p[i][j] * IN_Q24), (int32_t)(now.p[i][j] * IN_Q24));
        }
    }
}

/** P = M P Mᵀ and the states by M, where row `to` of M has the share `from` of another. */
static void shear(struct filter *f, unsigned to, unsigned from, double share)
{
    f->state[to] += share * f->state[from];
    for (unsigned i = 0; i < STATES; i++) {
        f->p[to][i] += share * f->p[from][i];
    }
    for (unsigned i = 0; i < STATES; i++) {
        f->p[i][to] += share * f->p[i][from];
    }
}

/** As the ground goes by: the grade to the left is forgotten, and varies as before in the end. */
static void forget(struct filter *f, double share)
{
    const double variance = f->p[LEFT][LEFT];

    f->state[LEFT] *= 1 - share / 2;
    for (unsigned i = 0; i < STATES; i++) {
        f->p[LEFT][i] *= 1 - share / 2;
        f->p[i][LEFT] *= 1 - share / 2;
    }
    f->p[LEFT][LEFT] = variance * (1 - share) + share;
    f->p[AHEAD][AHEAD] += share / 64;
}

/* ṗ = ω q − ψ̇, q̇ = −ω p, with the pitch rate without its bias. */
static void test_a_step_turns_the_grades_by_the_formulas(void)
{
    for (int i = 0; i < 100; i++) {
        set_any();
        tilt.pitch_bias = (int32_t)uniform(-2e8, 2e8);
        step.turn = (int32_t)uniform(-4e7, 4e7);
        step.way = (int32_t)uniform(-1e9, 1e9);
        step.gyro_pitch = (int32_t)uniform(-4e7, 4e7);
        struct filter f = filter_now();
        const double turn = step.turn / IN_Q32 * TWO_PI;
        const double nodded = (step.gyro_pitch - tilt.pitch_bias / 256.0) / IN_Q32 * TWO_PI;

        shear(&f, AHEAD, LEFT, turn);
        shear(&f, LEFT, AHEAD, -turn);
        forget(&f, size(step.way / IN_Q32) * tilt.fading / 16384);
        f.state[AHEAD] -= nodded;
        jp_skid_tilt_move(&tilt, &step);
        expect_filter(&f);
    }
}

/* Half a metre of ground that changes by its deviation in less. */
static void test_ground_that_changes_fast_is_forgotten_whole(void)
{
    tilt.fading = 16384 * 4;
    tilt.state[LEFT] = JP_Q24(0.25);
    tilt.variance[LEFT] = JP_SKID_ONE / 4;
    step.way = INT32_MAX;
    jp_skid_tilt_move(&tilt, &step);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.125), tilt.state[LEFT]);
    TEST_ASSERT_EQUAL_INT32(JP_SKID_ONE, tilt.variance[LEFT]);
}

/* ---- Stand ---- */

/* The bias takes 1/64 of what is new in a step. */
static void test_a_stand_shows_the_bias_of_the_pitch_gyro(void)
{
    double bias = 0;

    for (int i = 0; i < 200; i++) {
        step.gyro_pitch = (int32_t)uniform(-100000, 300000);
        bias += (step.gyro_pitch * 256.0 - bias) / 64;
        jp_skid_tilt_stand(&tilt, &step);
        TEST_ASSERT_INT32_WITHIN(64, (int32_t)bias, tilt.pitch_bias);
    }
}

/* A robot that is tipped over shows more than a bias. */
static void test_the_bias_of_the_pitch_gyro_is_limited(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        step.gyro_pitch = sign * INT32_MAX;
        for (int i = 0; i < 10; i++) {
            jp_skid_tilt_stand(&tilt, &step);
        }
        TEST_ASSERT_EQUAL_INT32(sign * JP_SKID_PITCH_BIAS_MAX, tilt.pitch_bias);
    }
}

/* ---- Accelerometer ---- */

static double greater(double a, double b)
{
    return a > b ? a : b;
}

/** The Kalman filter of what is measured: the grade ahead, the offset, and how the robot speeds up, g. */
static struct filter kalman(double accelerated, double unrest)
{
    struct filter f = filter_now();
    const double doubt = unrest / 0.125;
    double of[STATES];

    for (unsigned i = 0; i < STATES; i++) {
        of[i] = f.p[i][AHEAD] + f.p[i][OFFSET];
    }
    const double variance = of[AHEAD] + of[OFFSET] + tilt.accel_variance / IN_Q30 + doubt * doubt;
    const double surprise = step.force / IN_Q24 - f.state[AHEAD] - f.state[OFFSET] - accelerated;

    for (unsigned i = 0; i < STATES; i++) {
        f.state[i] += surprise * of[i] / variance;
        for (unsigned j = 0; j < STATES; j++) {
            f.p[i][j] -= of[i] * of[j] / variance;
        }
    }
    return f;
}

/* What speeds up or has just done so tells less; the doubt fades by 1/8 in a step. */
static void test_the_accelerometer_teaches_by_the_formulas(void)
{
    double unrest = 0;

    for (int i = 0; i < 200; i++) {
        set_any();
        step.forward_before = (int32_t)uniform(-2e8, 2e8);
        step.forward = step.forward_before + (int32_t)(i % 20 == 0 ? uniform(-1e8, 1e8) : uniform(-1e6, 1e6));
        step.force = (jp_q24)uniform(-0.5 * IN_Q24, 0.5 * IN_Q24);
        const double accelerated = (step.forward - step.forward_before) / IN_Q32 * 625 / 9.80665;

        unrest = greater(size(accelerated), unrest * 7 / 8);
        const struct filter f = kalman(accelerated, unrest);

        jp_skid_tilt_learn(&tilt, &step);
        TEST_ASSERT_INT32_WITHIN(1000, (int32_t)(unrest * IN_Q24), tilt.unrest);
        expect_filter(&f);
    }
}

/* Wherever the readings are, grades and offset stay sines. */
static void test_grades_are_limited_to_one(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        for (int i = 0; i < 100; i++) {
            step.force = sign * JP_Q24(2);
            jp_skid_tilt_learn(&tilt, &step);
        }
        TEST_ASSERT_EQUAL_INT32(sign * JP_Q24_ONE, tilt.state[AHEAD]);
    }
}
