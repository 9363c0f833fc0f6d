/* The learner of skid steer and differential drive: its check, what it takes, its factors, its forecasts. */
#include <joulepath/skid_learner.h>
#include <joulepath/tables.h>
#include <stddef.h>
#include <string.h>

#include "tests/support/config_check.h"
#include "tests/target/random.h"
#include "unity.h"

enum { N = JP_SKID_FACTORS, LEG_PIECES = 12 };

static const struct jp_skid_learning usual = {
    .factors =
        {
            .deviation = {JP_Q16(0.25), JP_Q16(0.2), JP_Q16(0.15), JP_Q16(0.1)},
            .noise_relative = JP_Q16(0.005),
            .noise = JP_Q16(0.1),
            .spread = JP_Q16(1.5),
            .memory = 64,
            .identity = 12,
        },
};

static const struct jp_skid_energy_model model = {
    .half_track = JP_Q24(0.5),
    .weight = JP_Q16(900),
    .rolling = JP_Q24(0.04),
    .friction = JP_Q24(0.7),
    .turning = JP_Q24(0.3),
    .yielding = JP_Q24(0.3),
    .scrub = JP_Q24(0.3),
    .easing = JP_Q24(1),
    .bank_easing = JP_Q24(1.5),
    .tilting = JP_Q24(0.4),
    .inertia = JP_Q24(0.15),
    .turn_inertia = JP_Q24(0.02),
    .driving = JP_Q24(1.3),
    .braking = JP_Q24(0.25),
    .copper_driving = JP_Q16(500),
    .copper_braking = JP_Q16(200),
    .electronics_power = JP_Q16(10),
    .unit_exponent = 2,
};

static struct jp_skid_learning config;
static struct jp_skid_learner learner;
static struct jp_skid_piece leg[LEG_PIECES];
static uint32_t random_state;
static const char *refused;

void setUp(void)
{
    config = usual;
    jp_skid_learner_start(&learner, &config, &model);
    random_state = 1;
    refused = NULL;
}

void tearDown(void)
{
}

/* ---- Check ---- */

DEFINE_EXPECT_CONFIG_OF(jp_skid_learning_check, usual)

static void test_check_names_each_field_at_both_limits(void)
{
    expect_config(NULL);
    RANGE("learning.", noise_slopes, 0, JP_Q16_ONE);
    FIELD(factors.spread, 0, "learning.spread");
    FIELD(factors.identity, 0, "learning.identity");
}

static void test_tables_pass_their_check(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_learning_check(&jp_skid_learning_zhang2018, &refused));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_learning_check(&jp_skid_learning_burger, &refused));
    TEST_ASSERT_TRUE(jp_skid_learning_zhang2018.factors.identity != jp_skid_learning_burger.factors.identity);
}

/* ---- Legs ---- */

static int32_t draw(int32_t low, int32_t high)
{
    return low + (int32_t)(((uint64_t)target_random(&random_state) * (uint32_t)(high - low)) >> 32);
}

/* Steady, up and down a little. */
static void draw_leg(void)
{
    const int32_t kind = draw(0, 3);
    const struct jp_motion motion = {kind == 2 ? 0 : draw(JP_Q24(0.2), JP_Q24(0.7)),
                                     kind == 0 ? 0 : draw(-JP_Q24(0.5), JP_Q24(0.5))};

    for (int i = 0; i < (int)LEG_PIECES; i++) {
        leg[i] = (struct jp_skid_piece){motion, motion, draw(-JP_Q24(0.15), JP_Q24(0.15)),
                                        draw(-JP_Q24(0.1), JP_Q24(0.1)), JP_Q16(0.5)};
    }
}

static struct jp_skid_drive drive_on(const struct jp_skid_energy_model *of)
{
    struct jp_skid_drive drive = {0};

    for (int i = 0; i < (int)LEG_PIECES; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(of, &drive, &leg[i]));
    }
    return drive;
}

static enum jp_learned learn(jp_q16 measured)
{
    const struct jp_skid_drive drive = drive_on(&learner.model);
    enum jp_learned learned = JP_LEARNED;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_learner_update(&learner, &drive, measured, &learned));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learned_state_check(&learner.state, &refused));
    return learned;
}

static void drive_as(const jp_q16 factor[N], unsigned legs)
{
    struct jp_skid_energy_model robot;

    jp_skid_energy_scale(&model, factor, &robot);
    for (unsigned i = 0; i < legs; i++) {
        draw_leg();
        (void)learn((jp_q16)drive_on(&robot).energy);
    }
}

static void expect_factors(const jp_q16 expected[N], jp_q16 tolerance)
{
    jp_q16 factor[N];

    jp_skid_learner_factors(&learner, factor);
    for (int j = 0; j < (int)N; j++) {
        TEST_ASSERT_INT32_WITHIN(tolerance, expected[j], factor[j]);
    }
}

/* ---- Learning ---- */

static void test_nothing_is_learned_at_first(void)
{
    static const jp_q16 ones[N] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE};
    jp_q16 deviation[N];

    expect_factors(ones, 0);
    TEST_ASSERT_EQUAL_MEMORY(&model, &learner.model, sizeof model);
    jp_skid_learner_deviations(&learner, deviation);
    for (int j = 0; j < (int)N; j++) {
        TEST_ASSERT_INT32_WITHIN(1, usual.factors.deviation[j], deviation[j]);
    }
}

static void test_another_robot_is_learned(void)
{
    static const jp_q16 factor[N] = {JP_Q16(1.3), JP_Q16(0.8), JP_Q16(1.2), JP_Q16(0.9)};
    jp_q16 deviation[N];

    drive_as(factor, 100);
    expect_factors(factor, JP_Q16(0.02));
    TEST_ASSERT_EQUAL_UINT32(100, learner.state.version);
    jp_skid_learner_deviations(&learner, deviation);
    for (int j = 0; j < (int)N; j++) {
        TEST_ASSERT_TRUE(deviation[j] < usual.factors.deviation[j] / 4);
    }
}

static void test_the_learned_model_passes_its_check(void)
{
    static const jp_q16 factor[N] = {JP_Q16(0.7), JP_Q16(1.2), JP_Q16(0.9), JP_Q16(1.1)};

    drive_as(factor, 20);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_check(&learner.model, &refused));
}

static void test_standing_teaches_the_electronics(void)
{
    static const jp_q16 expected[N] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE, JP_Q16(1.1)};

    for (int i = 0; i < (int)LEG_PIECES; i++) {
        leg[i] = (struct jp_skid_piece){{0, 0}, {0, 0}, 0, 0, JP_Q16(10)};
    }
    for (int i = 0; i < 30; i++) {
        (void)learn(JP_Q16(11.0 * 10 * LEG_PIECES / 4));
    }
    expect_factors(expected, JP_Q16(0.01));
}

static void test_what_takes_nothing_teaches_nothing(void)
{
    const struct jp_skid_drive nothing = {0};
    enum jp_learned learned = JP_LEARNED;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_learner_update(&learner, &nothing, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_NOTHING, learned);
    TEST_ASSERT_EQUAL_UINT32(0, learner.state.version);
}

/* ---- Outliers and changes ---- */

static void test_outliers_and_changes_are_counted(void)
{
    static const jp_q16 ones[N] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE};
    static const jp_q16 rough[N] = {JP_Q16(1.5), JP_Q16_ONE, JP_Q16(1.3), JP_Q16_ONE};

    drive_as(ones, 40);
    TEST_ASSERT_EQUAL_UINT32(0, learner.outliers);
    draw_leg();
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER, learn(2 * (jp_q16)drive_on(&model).energy));
    TEST_ASSERT_EQUAL_UINT32(1, learner.outliers);
    TEST_ASSERT_EQUAL_UINT32(0, learner.changes);
    drive_as(rough, 200);
    TEST_ASSERT_TRUE(learner.changes >= 1U);
    expect_factors(rough, JP_Q16(0.06));
}

/* Legs that take hardly anything would have a factor beyond its bound; from there it comes back at once. */
static void test_x_stays_where_its_factor_is(void)
{
    const jp_q24 bound = jp_divide((int64_t)(JP_FACTOR_MIN - JP_Q16_ONE) * JP_Q24_ONE, config.factors.deviation[0]);

    for (int i = 0; i < 30; i++) {
        draw_leg();
        (void)learn(1);
        for (int j = 0; j < (int)N; j++) {
            const int64_t away = (int64_t)learner.state.x[j] * config.factors.deviation[j];

            TEST_ASSERT_TRUE(away >= (int64_t)(JP_FACTOR_MIN - JP_Q16_ONE - 1) * JP_Q24_ONE);
            TEST_ASSERT_TRUE(away <= (int64_t)(JP_FACTOR_MAX - JP_Q16_ONE + 1) * JP_Q24_ONE);
        }
    }
    TEST_ASSERT_INT32_WITHIN(2, bound, learner.state.x[0]);
}

/* ---- States ---- */

static void test_a_stored_state_goes_on(void)
{
    static const jp_q16 factor[N] = {JP_Q16(1.3), JP_Q16(0.8), JP_Q16(1.2), JP_Q16(0.9)};
    struct jp_learned_state state;
    struct jp_skid_energy_model learned;

    drive_as(factor, 20);
    state = learner.state;
    learned = learner.model;
    jp_skid_learner_start(&learner, &config, &model);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_learner_restore(&learner, &state, &refused));
    TEST_ASSERT_EQUAL_MEMORY(&state, &learner.state, sizeof state);
    TEST_ASSERT_EQUAL_MEMORY(&learned, &learner.model, sizeof learned);
}

static void test_a_state_of_another_learning_is_refused(void)
{
    struct jp_learned_state state = learner.state;

    state.identity++;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_skid_learner_restore(&learner, &state, &refused));
    TEST_ASSERT_EQUAL_STRING("state.identity", refused);
    state = learner.state;
    state.x[0] = JP_LEARNED_MAX + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_skid_learner_restore(&learner, &state, &refused));
    TEST_ASSERT_EQUAL_STRING("state.x", refused);
    TEST_ASSERT_EQUAL_INT32(0, learner.state.x[0]);
}

/* ---- Forecasts ---- */

static void test_a_forecast_is_the_sum_of_its_drives(void)
{
    struct jp_forecast_sum sum = {0, {0}, 0};
    struct jp_forecast forecast;
    int64_t energy = 0;

    for (int i = 0; i < 10; i++) {
        draw_leg();
        const struct jp_skid_drive drive = drive_on(&learner.model);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_forecast_add(&learner, &sum, &drive));
        energy += drive.energy;
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_forecast_total(&learner, &sum, &forecast));
    TEST_ASSERT_EQUAL_INT32((int32_t)energy, forecast.energy);
    TEST_ASSERT_TRUE(forecast.deviation > forecast.energy / 20);
}

/* 3, 4 and 12 J; x adds nothing. */
static void test_noise_is_of_three_parts(void)
{
    const struct jp_skid_drive drive = {.energy = JP_Q16(80), .slope_work = JP_Q16(120)};
    struct jp_forecast_sum sum = {0, {0}, 0};
    struct jp_forecast forecast;

    config.factors.noise = JP_Q16(3);
    config.factors.noise_relative = JP_Q16(0.05);
    config.noise_slopes = JP_Q16(0.1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_forecast_add(&learner, &sum, &drive));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_forecast_total(&learner, &sum, &forecast));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), JP_Q16(13), forecast.deviation);
}

static void test_what_does_not_fit_is_an_overflow(void)
{
    struct jp_skid_drive drive = {.energy = (int64_t)INT32_MAX + 1};
    struct jp_forecast_sum sum = {0, {0}, 0};
    enum jp_learned learned = JP_LEARNED;

    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_skid_learner_update(&learner, &drive, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_skid_forecast_add(&learner, &sum, &drive));
    drive = (struct jp_skid_drive){.change = {0, 0, (int64_t)INT32_MIN - 1, 0}};
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_skid_learner_update(&learner, &drive, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_skid_forecast_add(&learner, &sum, &drive));
    drive = (struct jp_skid_drive){.slope_work = (int64_t)INT32_MAX + 1};
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_skid_forecast_add(&learner, &sum, &drive));
    TEST_ASSERT_TRUE(sum.energy == 0);
    TEST_ASSERT_EQUAL_UINT32(0, learner.state.version);
}

static void test_null_is_an_argument(void)
{
    const struct jp_skid_drive drive = {0};
    struct jp_forecast_sum sum = {0, {0}, 0};
    struct jp_forecast forecast;
    enum jp_learned learned;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_learner_restore(NULL, &learner.state, &refused));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_learner_restore(&learner, NULL, &refused));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_learner_update(NULL, &drive, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_learner_update(&learner, NULL, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_learner_update(&learner, &drive, 0, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_forecast_add(NULL, &sum, &drive));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_forecast_add(&learner, NULL, &drive));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_forecast_add(&learner, &sum, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_forecast_total(NULL, &sum, &forecast));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_forecast_total(&learner, NULL, &forecast));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_forecast_total(&learner, &sum, NULL));
}
