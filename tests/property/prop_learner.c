/*
 * The learner against recursive least squares in double precision and information form, on random tables, robots and
 * segments, with outliers, changes and stands; what is never excited; P <= I and positive definite all the while.
 *
 * prop_learner [--count N] [--seed S]
 * --count is the number of updates of each test.
 */
#include <joulepath/learner.h>
#include <joulepath/tables.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/decimal.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

enum { N = JP_LEARNING_DIRECTIONS, SEQUENCE = 200 };

/* Of the filter's numbers: of x in its standard deviations, of P relative, of forecasts in theirs. */
#define X_BAR        0.03
#define P_BAR        0.01
#define FORECAST_BAR 0.01

/* An innovation, or an alarm, so near to its limit may fall on either side. */
#define NEAR 0.02

/* What the header promises. */
#define GATE       4.0
#define DRIFT      2.0
#define ALARM      28.5
#define INNOVATION 64
#define NOISE_MAX  256.0
#define NOISE_STEP 3.39
#define SETTLED    8U
#define LEAST_INFO (1.0 / 64)
#define NOISE_RATE (1.0 / 128)

#define P_MAX (1 + 1e-5)

typedef double vector[N];
typedef double matrix[N][N];

static struct options options = {.count = 100000, .seed = 1};

static const struct {
    const struct jp_energy_model *model;
    const struct jp_learning *learning;
} robots[] = {{&jp_energy_model_courier24, &jp_learning_courier24}, {&jp_energy_model_gao2018, &jp_learning_gao2018}};

void tearDown(void)
{
}

void setUp(void)
{
    begin_random(options.seed, 0);
}

/* ---- Matrices ---- */

static void invert(const matrix a, matrix inverse)
{
    double rows[N][2 * N];

    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            rows[i][j] = a[i][j];
            rows[i][N + j] = i == j;
        }
    }
    /* Positive definite: no pivoting needed. */
    for (int k = 0; k < N; k++) {
        for (int i = 0; i < N; i++) {
            const double factor = i == k ? 1 - 1 / rows[k][k] : rows[i][k] / rows[k][k];
            for (int j = 0; j < 2 * N; j++) {
                rows[i][j] -= factor * rows[k][j];
            }
        }
    }
    for (int i = 0; i < N; i++) {
        memcpy(inverse[i], &rows[i][N], sizeof inverse[i]);
    }
}

static void multiply(const matrix a, const matrix b, matrix product)
{
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            product[i][j] = 0;
            for (int k = 0; k < N; k++) {
                product[i][j] += a[i][k] * b[k][j];
            }
        }
    }
}

static void identity(matrix a)
{
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            a[i][j] = i == j;
        }
    }
}

static double quadratic(const matrix a, const vector v)
{
    double sum = 0;

    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            sum += v[i] * a[i][j] * v[j];
        }
    }
    return sum;
}

/* By Cholesky's factors. */
static bool is_positive_definite(const matrix a)
{
    matrix l = {{0}};

    for (int i = 0; i < N; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = a[i][j];
            for (int k = 0; k < j; k++) {
                sum -= l[i][k] * l[j][k];
            }
            if (i == j && !(sum > 0)) {
                return false;
            }
            l[i][j] = i == j ? sqrt(sum) : sum / l[j][j];
        }
    }
    return true;
}

static void covariance(const struct jp_learned_state *state, matrix p)
{
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            p[i][j] = 0;
            for (int k = 0; k < N; k++) {
                p[i][j] += state->s[i][k] * 0x1p-30 * (state->s[j][k] * 0x1p-30);
            }
        }
    }
}

static void expect_bounded(const struct jp_learned_state *state)
{
    matrix p, gap;

    covariance(state, p);
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            gap[i][j] = (i == j) * P_MAX - p[i][j];
        }
    }
    TEST_ASSERT_TRUE_MESSAGE(is_positive_definite(p), "P is not positive definite");
    TEST_ASSERT_TRUE_MESSAGE(is_positive_definite(gap), "P is not below I");
}

/* ---- The oracle: settled segments, so that the energy is the paper's formula ---- */

struct oracle {
    const struct jp_energy_model *model;
    const struct jp_learning *learning;
    vector x;
    matrix y; /* information, P⁻¹ */
    double scale;
    double alarm;
    unsigned since_change;
};

struct expectation {
    double energy;
    vector f;
    double noise;
};

static void oracle_start(struct oracle *oracle, const struct jp_energy_model *model, const struct jp_learning *learning)
{
    *oracle = (struct oracle){.model = model, .learning = learning, .scale = 1};
    identity(oracle->y);
}

static struct expectation oracle_expect(const struct oracle *oracle, const struct jp_motion *before,
                                        const struct jp_segment_command *segment)
{
    const struct jp_energy_model *m = oracle->model;
    const double v0 = q24(before->speed), w0 = q24(before->turn_rate);
    const double v = q24(segment->motion.speed), w = q24(segment->motion.turn_rate);
    const double dv = v - v0, dw = w - w0, s = q24(segment->turn), t = q16(segment->duration);
    const double cv = q16(m->voltage_per_speed), cw = q16(m->voltage_per_turn_rate);
    const double l = cv * v0 - cw * w0, r = cv * v0 + cw * w0, rest = t - q16(m->settling_time);
    const double phi[JP_ENERGY_PARAMETERS] = {dv * dv,
                                              dw * dw,
                                              s * s,
                                              dv * dw,
                                              dv * s,
                                              dw * s,
                                              l * dv,
                                              l * dw,
                                              l * s,
                                              r * dv,
                                              r * dw,
                                              r * s,
                                              (l * l + r * r) / q16(m->motor_resistance),
                                              v * v * rest,
                                              w * w * rest};
    const struct jp_learning *learning = oracle->learning;
    struct expectation e = {.energy = q16(m->electronics_power) * t};

    for (int i = 0; i < JP_ENERGY_PARAMETERS; i++) {
        e.energy += q16(i < JP_ENERGY_TERMS ? m->a[i] : m->b[i - JP_ENERGY_TERMS]) * phi[i];
        for (int j = 0; j < N; j++) {
            e.f[j] += q16(learning->direction[i][j]) * phi[i];
        }
    }
    for (int j = 0; j < N; j++) {
        e.energy += e.f[j] * oracle->x[j];
    }
    e.noise = oracle->scale * hypot(q16(learning->noise), q16(learning->noise_relative) * e.energy);
    return e;
}

/* P ← q P q with q = I + (I − P)/(2 memory). */
static void oracle_forget(const struct oracle *oracle, matrix y)
{
    matrix p, q, qp;

    invert(oracle->y, p);
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            q[i][j] = (i == j) + ((i == j) - p[i][j]) / (2.0 * oracle->learning->memory);
        }
    }
    multiply(q, p, qp);
    multiply(qp, q, p);
    invert(p, y);
}

static void oracle_take(struct oracle *oracle, const vector h, double error)
{
    matrix p;

    oracle->since_change++;

    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            oracle->y[i][j] += h[i] * h[j];
        }
    }
    invert(oracle->y, p);
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            oracle->x[i] += p[i][j] * h[j] * error;
        }
    }
    for (int i = 0; i < N; i++) {
        oracle->x[i] = fmin(8, fmax(-8, oracle->x[i]));
    }
}

/* What should become of a measurement; *near: it may as well be something else. */
static enum jp_learned oracle_update(struct oracle *oracle, const struct expectation *e, double measured, bool *near)
{
    vector h;
    matrix y, p;
    double info = 0, noise = e->noise;

    *near = false;
    for (int j = 0; j < N; j++) {
        noise = fmax(noise, fabs(e->f[j]) / 1000);
    }
    for (int j = 0; j < N; j++) {
        h[j] = e->f[j] / noise;
        info += h[j] * h[j];
    }
    if (fabs(info / LEAST_INFO - 1) < NEAR) {
        *near = true;
    }
    if (info < LEAST_INFO) {
        return JP_LEARNED_NOTHING;
    }
    oracle_forget(oracle, y);
    invert(y, p);

    const double error = (measured - e->energy) / noise, variance = quadratic(p, h) + 1;
    const double z = error / sqrt(variance), square = fmin(z * z, GATE * GATE);

    oracle->alarm = fmax(0, oracle->alarm + square - DRIFT);
    *near = *near || fabs(fabs(z) - GATE) < NEAR || fabs(oracle->alarm - ALARM) < 4 * NEAR;
    if (oracle->alarm > ALARM && oracle->since_change < SETTLED) {
        oracle->alarm = 0;
        oracle->scale = fmin(NOISE_MAX, oracle->scale * NOISE_STEP);
        identity(oracle->y);
        return JP_LEARNED_OUTLIER;
    }
    if (oracle->alarm > ALARM) {
        oracle->since_change = 0;
        identity(oracle->y);
        oracle->alarm = 0;
        oracle->scale = fmax(oracle->scale, 1);
        oracle_take(oracle, h, copysign(fmin(fabs(error), INNOVATION * sqrt(quadratic(oracle->y, h) + 1)), error));
        return JP_LEARNED_CHANGE;
    }
    memcpy(oracle->y, y, sizeof y);
    oracle->scale = fmin(NOISE_MAX, fmax(0.25, oracle->scale * (1 + (square - 1) / variance * NOISE_RATE)));
    oracle_take(oracle, h, copysign(fmin(fabs(error), GATE * sqrt(variance)), error));
    return fabs(z) > GATE ? JP_LEARNED_OUTLIER : JP_LEARNED;
}

/* ---- Against the oracle ---- */

static struct jp_segment_command random_segment(const struct jp_energy_model *model)
{
    const bool is_stand = uniform(0, 1) < 0.05;

    return (struct jp_segment_command){
        .motion = {is_stand ? 0 : (jp_q24)(uniform(0, 1) * JP_Q24_ONE),
                   is_stand ? 0 : (jp_q24)(uniform(-0.35, 0.35) * JP_Q24_ONE)},
        .turn = is_stand ? 0 : (jp_q24)(uniform(-1.4, 1.4) * JP_Q24_ONE),
        .duration = model->settling_time + (jp_q16)(uniform(0, 20) * JP_Q16_ONE),
    };
}

/* Like the robot's own table, with another scale of each direction and of the noise. */
static struct jp_learning random_learning(const struct jp_learning *like)
{
    struct jp_learning learning = *like;

    for (int j = 0; j < N; j++) {
        const double scale = uniform(0.5, 2);
        for (int i = 0; i < JP_ENERGY_PARAMETERS; i++) {
            learning.direction[i][j] = (jp_q16)(learning.direction[i][j] * scale);
        }
    }
    learning.noise = (jp_q16)(uniform(0.05, 1) * JP_Q16_ONE);
    learning.noise_relative = (jp_q16)(uniform(0.003, 0.02) * JP_Q16_ONE);
    learning.memory = (uint32_t)uniform(8, 1024);
    return learning;
}

static struct {
    double x, p, forecast; /* worst differences */
    unsigned long learned, nothing, outliers, changes, undecided;
} seen;

static void compare(const struct jp_learner *learner, const struct oracle *oracle)
{
    matrix p, exact;

    covariance(&learner->state, p);
    invert(oracle->y, exact);
    for (int i = 0; i < N; i++) {
        seen.x = fmax(seen.x, fabs(q24(learner->state.x[i]) - oracle->x[i]) / sqrt(exact[i][i]));
        for (int j = 0; j < N; j++) {
            seen.p = fmax(seen.p, fabs(p[i][j] - exact[i][j]) / sqrt(exact[i][i] * exact[j][j]));
        }
    }
}

static void compare_forecast(const struct jp_learner *learner, const struct oracle *oracle)
{
    struct jp_energy_start start = {.motion = {0, 0}};
    struct jp_forecast_sum sum = {0, {0}, 0};
    struct jp_forecast forecast;
    double energy = 0, variance = 0;
    vector f = {0};
    matrix p;

    for (int i = 0; i < 5; i++) {
        const struct jp_segment_command segment = random_segment(oracle->model);
        const struct expectation e = oracle_expect(oracle, &start.motion, &segment);

        energy += e.energy;
        variance += e.noise * e.noise;
        for (int j = 0; j < N; j++) {
            f[j] += e.f[j];
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_add(learner, &sum, &start, &segment));
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_total(learner, &sum, &forecast));
    invert(oracle->y, p);

    const double deviation = sqrt(variance + quadratic(p, f));

    seen.forecast = fmax(seen.forecast, fabs(q16(forecast.deviation) / deviation - 1));
    seen.forecast = fmax(seen.forecast, fabs(q16(forecast.energy) - energy) / deviation);
}

static void count(enum jp_learned learned)
{
    seen.learned += learned == JP_LEARNED;
    seen.nothing += learned == JP_LEARNED_NOTHING;
    seen.outliers += learned == JP_LEARNED_OUTLIER;
    seen.changes += learned == JP_LEARNED_CHANGE;
}

/* One robot that changes once, with some gross errors of measurement. */
static void run_sequence(void)
{
    const size_t robot = random_bits() % 2;
    const struct jp_learning learning = random_learning(robots[robot].learning);
    struct jp_learner learner;
    struct oracle oracle;
    struct oracle truth;
    struct jp_motion before = {0, 0};

    jp_learner_start(&learner, &learning, robots[robot].model, NULL);
    oracle_start(&oracle, robots[robot].model, &learning);
    oracle_start(&truth, robots[robot].model, &learning);
    for (int i = 0; i < SEQUENCE; i++) {
        if (i % (SEQUENCE / 2) == 0) {
            for (int j = 0; j < N; j++) {
                truth.x[j] = gaussian(1);
            }
        }

        const struct jp_energy_start start = {.motion = before};
        const struct jp_segment_command segment = random_segment(robots[robot].model);
        const struct expectation real = oracle_expect(&truth, &before, &segment);
        const double error = uniform(0, 1) < 0.01 ? uniform(-50, 50) : gaussian(1);
        const jp_q16 measured = (jp_q16)lround((real.energy + error * real.noise) * 65536);
        const struct expectation e = oracle_expect(&oracle, &before, &segment);
        enum jp_learned learned;
        bool near;

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_learner_update(&learner, &start, &segment, measured, &learned));

        const enum jp_learned expected = oracle_update(&oracle, &e, q16(measured), &near);

        expect_bounded(&learner.state);
        if (learned != expected) {
            TEST_ASSERT_TRUE_MESSAGE(near, "another decision than the oracle's");
            seen.undecided++;
            return;
        }
        count(learned);
        compare(&learner, &oracle);
        before = segment.motion;
    }
    compare_forecast(&learner, &oracle);
}

static void test_against_least_squares_in_information_form(void)
{
    for (unsigned long i = 0; i < options.count / SEQUENCE; i++) {
        run_sequence();
    }
    printf("worst: x %.4f deviations, P %.4f, forecast %.4f; learned %lu, nothing %lu, outliers %lu, changes %lu, "
           "undecided %lu\n",
           seen.x, seen.p, seen.forecast, seen.learned, seen.nothing, seen.outliers, seen.changes, seen.undecided);
    TEST_ASSERT_TRUE(seen.x <= X_BAR && seen.p <= P_BAR && seen.forecast <= FORECAST_BAR);
    TEST_ASSERT_TRUE(seen.outliers > 0 && seen.changes > 0 && seen.nothing > 0);
    TEST_ASSERT_TRUE(seen.undecided * 20 <= options.count / SEQUENCE);
}

/* ---- What is never excited ---- */

/* Segments of which the robot of the truth takes somewhat more or less than is expected. */
static void drive_often(struct jp_learner *learner, const struct oracle *truth,
                        const struct jp_segment_command *segment)
{
    const struct jp_energy_start start = {.motion = segment->motion};

    for (unsigned long i = 0; i < options.count; i++) {
        const struct expectation e = oracle_expect(truth, &segment->motion, segment);
        enum jp_learned learned;

        TEST_ASSERT_EQUAL_INT(
            JP_OK, jp_learner_update(learner, &start, segment,
                                     (jp_q16)lround((e.energy + 0.5 * e.noise * uniform(-1, 1)) * 65536), &learned));
        TEST_ASSERT_EQUAL_INT(JP_LEARNED, learned);
    }
    expect_bounded(&learner->state);
}

/* P = I but along a unit vector. */
static void expect_unsure_but_along(const matrix p, const vector unit)
{
    const double along = quadratic(p, unit);

    TEST_ASSERT_TRUE(along < 0.05);
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            const double expected = (i == j) - (1 - along) * unit[i] * unit[j];

            TEST_ASSERT_TRUE(fabs(p[i][j] - expected) < 1e-4);
        }
    }
}

/* Straight on at one speed for ever: one direction of x is learned, three stay as they were, and what is expected of
   other segments is as unsure as at first, and no worse. */
static void test_what_is_not_excited_stays_as_unsure_as_at_first(void)
{
    const struct jp_segment_command straight = {{JP_Q24(0.7), 0}, 0, JP_Q16(10)};
    const struct jp_segment_command turn = {{JP_Q24(0.2), JP_Q24(0.3)}, JP_Q24(1), JP_Q16(5)};
    const struct jp_energy_model *model = &jp_energy_model_courier24;
    struct oracle truth;
    struct jp_learner learner;
    matrix p;

    jp_learner_start(&learner, &jp_learning_courier24, model, NULL);
    oracle_start(&truth, model, &jp_learning_courier24);
    for (int j = 0; j < N; j++) {
        truth.x[j] = gaussian(1);
    }
    drive_often(&learner, &truth, &straight);
    covariance(&learner.state, p);

    struct oracle known;
    vector unit;
    oracle_start(&known, model, &jp_learning_courier24);
    const struct expectation e = oracle_expect(&known, &straight.motion, &straight);
    const double length = sqrt(quadratic((const matrix){{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}, e.f));
    for (int j = 0; j < N; j++) {
        unit[j] = e.f[j] / length;
    }
    expect_unsure_but_along(p, unit);

    /* x is the truth along f and nothing across it; so the forecast of the straight is right, of a turn honest. */
    double truth_along = 0;
    for (int j = 0; j < N; j++) {
        truth_along += unit[j] * truth.x[j];
        known.x[j] = q24(learner.state.x[j]);
    }
    for (int j = 0; j < N; j++) {
        TEST_ASSERT_TRUE(fabs(known.x[j] - truth_along * unit[j]) < 0.1);
    }
    const struct expectation now = oracle_expect(&known, &straight.motion, &straight);
    const struct expectation real = oracle_expect(&truth, &straight.motion, &straight);
    TEST_ASSERT_TRUE(fabs(now.energy - real.energy) < 0.3 * real.noise);
    const struct expectation turned = oracle_expect(&known, &straight.motion, &turn);
    const struct expectation really = oracle_expect(&truth, &straight.motion, &turn);
    const double deviation = sqrt(turned.noise * turned.noise + quadratic(p, turned.f));
    TEST_ASSERT_TRUE(fabs(turned.energy - really.energy) < 4 * deviation);

    double all = 0, told = 0;
    for (int j = 0; j < N; j++) {
        all += turned.f[j] * turned.f[j];
        told += turned.f[j] * unit[j];
    }
    TEST_ASSERT_TRUE(quadratic(p, turned.f) > 0.999 * all - told * told);
}

/* ---- Anything at all ---- */

static void test_any_measurement_leaves_a_state_in_its_ranges(void)
{
    struct jp_energy_start start = {.motion = {0, 0}};
    struct jp_learner learner;
    const char *field = NULL;

    jp_learner_start(&learner, &jp_learning_courier24, &jp_energy_model_courier24, &jp_horizon_courier24);
    for (unsigned long i = 0; i < options.count; i++) {
        struct jp_segment_command segment = random_segment(&jp_energy_model_courier24);
        struct jp_energy_model model;
        enum jp_learned learned;
        jp_q16 energy;

        segment.duration = (jp_q16)(uniform(0.5, 10) * JP_Q16_ONE);

        const struct jp_energy_start before = start;

        TEST_ASSERT_EQUAL_INT(
            JP_OK, jp_energy_forecast(learner.built_in, learner.horizon, &before, &segment, &energy, &start));

        const jp_q16 measured =
            random_bits() % 4 == 0 ? (jp_q16)(random_bits() >> 32) : (jp_q16)(energy * uniform(0.9, 1.1));

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_learner_update(&learner, &before, &segment, measured, &learned));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_learned_state_check(&learner.state, &field));
        jp_learner_model(&learner, &model);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_energy_model_check(&model, &field));
        expect_bounded(&learner.state);
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
