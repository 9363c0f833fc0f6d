/* The learner of four steered wheels: its check, what it takes, its factors, its forecasts. */
#include <joulepath/four_wheel_learner.h>
#include <joulepath/tables.h>
#include <stddef.h>
#include <string.h>

#include "tests/target/random.h"
#include "unity.h"

enum { N = JP_FOUR_WHEEL_FACTORS, LEG_PIECES = 12 };

static const struct jp_factor_learning usual = {
    .deviation = {JP_Q16(0.25), JP_Q16(0.2), JP_Q16(0.15), JP_Q16(0.1)},
    .noise_relative = JP_Q16(0.005),
    .noise = JP_Q16(0.1),
    .spread = JP_Q16(1.5),
    .memory = 64,
    .identity = 12,
};

static const struct jp_four_wheel_energy_model model = {
    .wheelbase = JP_Q24(0.6),
    .track = JP_Q24(0.8),
    .weight = JP_Q16(900),
    .rolling = JP_Q24(0.04),
    .drag = JP_Q24(0.004),
    .cornering = JP_Q24(0.001),
    .inertia = JP_Q24(0.15),
    .turn_inertia = JP_Q24(0.02),
    .driving = JP_Q24(1.3),
    .braking = JP_Q24(0.7),
    .copper_driving = JP_Q16(3000),
    .copper_braking = JP_Q16(2000),
    .steering = JP_Q16(3),
    .contact = JP_Q24(0.03),
    .electronics_power = JP_Q16(10),
    .unit_exponent = 2,
};

static struct jp_factor_learning config;
static struct jp_four_wheel_learner learner;
static struct jp_four_wheel_piece leg[LEG_PIECES];
static uint32_t random_state;
static const char *refused;

void setUp(void)
{
    config = usual;
    jp_four_wheel_learner_start(&learner, &config, &model);
    random_state = 1;
    refused = NULL;
}

void tearDown(void)
{
}

/* ---- Check ---- */

static void test_the_table_passes_its_check(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_factor_learning_check(&jp_four_wheel_learning_patrol, &refused));
}

/* ---- Legs ---- */

static int32_t draw(int32_t low, int32_t high)
{
    return low + (int32_t)(((uint64_t)target_random(&random_state) * (uint32_t)(high - low)) >> 32);
}

/* Steady, up and down a little, with some steering. */
static void draw_leg(void)
{
    const int32_t kind = draw(0, 3);
    const struct jp_twist twist = {kind == 2 ? 0 : draw(JP_Q24(0.2), JP_Q24(0.7)), 0,
                                   kind == 0 ? 0 : draw(-JP_Q24(0.5), JP_Q24(0.5))};
    const jp_q16 travel = draw(0, JP_Q16(3));

    for (int i = 0; i < (int)LEG_PIECES; i++) {
        leg[i] = (struct jp_four_wheel_piece){
            twist, twist, draw(-JP_Q24(0.15), JP_Q24(0.15)), draw(-JP_Q24(0.1), JP_Q24(0.1)), travel, JP_Q16(0.5)};
    }
    leg[0].start = leg[0].end = (struct jp_twist){0, 0, 0};
    leg[0].travel = draw(0, JP_Q16(40));
}

static struct jp_four_wheel_drive drive_on(const struct jp_four_wheel_energy_model *of)
{
    struct jp_four_wheel_drive drive = {0};

    for (int i = 0; i < (int)LEG_PIECES; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_energy_add(of, &drive, &leg[i]));
    }
    return drive;
}

static enum jp_learned learn(jp_q16 measured)
{
    const struct jp_four_wheel_drive drive = drive_on(&learner.model);
    enum jp_learned learned = JP_LEARNED;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_learner_update(&learner, &drive, measured, &learned));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learned_state_check(&learner.state, &refused));
    return learned;
}

static void drive_as(const jp_q16 factor[N], unsigned legs)
{
    struct jp_four_wheel_energy_model robot;

    jp_four_wheel_energy_scale(&model, factor, &robot);
    for (unsigned i = 0; i < legs; i++) {
        draw_leg();
        (void)learn((jp_q16)drive_on(&robot).energy);
    }
}

static void expect_factors(const jp_q16 expected[N], jp_q16 tolerance)
{
    jp_q16 factor[N];

    jp_four_wheel_learner_factors(&learner, factor);
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
    jp_four_wheel_learner_deviations(&learner, deviation);
    for (int j = 0; j < (int)N; j++) {
        TEST_ASSERT_INT32_WITHIN(1, usual.deviation[j], deviation[j]);
    }
}

static void test_another_robot_is_learned(void)
{
    static const jp_q16 factor[N] = {JP_Q16(1.3), JP_Q16(0.8), JP_Q16(1.2), JP_Q16(0.9)};
    jp_q16 deviation[N];

    drive_as(factor, 100);
    expect_factors(factor, JP_Q16(0.02));
    TEST_ASSERT_EQUAL_UINT32(100, learner.state.version);
    jp_four_wheel_learner_deviations(&learner, deviation);
    for (int j = 0; j < (int)N; j++) {
        TEST_ASSERT_TRUE(deviation[j] < usual.deviation[j] / 4);
    }
}

static void test_the_learned_model_passes_its_check(void)
{
    static const jp_q16 factor[N] = {JP_Q16(0.7), JP_Q16(1.2), JP_Q16(0.9), JP_Q16(1.1)};

    drive_as(factor, 20);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_energy_check(&learner.model, &refused));
}

static void test_standing_teaches_the_electronics(void)
{
    static const jp_q16 expected[N] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE, JP_Q16(1.1)};

    for (int i = 0; i < (int)LEG_PIECES; i++) {
        leg[i] = (struct jp_four_wheel_piece){{0, 0, 0}, {0, 0, 0}, 0, 0, 0, JP_Q16(10)};
    }
    for (int i = 0; i < 30; i++) {
        (void)learn(JP_Q16(11.0 * 10 * LEG_PIECES / 4));
    }
    expect_factors(expected, JP_Q16(0.01));
}

static void test_what_takes_nothing_teaches_nothing(void)
{
    const struct jp_four_wheel_drive nothing = {0};
    enum jp_learned learned = JP_LEARNED;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_learner_update(&learner, &nothing, 0, &learned));
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
    drive_as(rough, 60);
    TEST_ASSERT_TRUE(learner.changes >= 1U);
    expect_factors(rough, JP_Q16(0.06));
}

/* ---- States ---- */

static void test_a_stored_state_goes_on(void)
{
    static const jp_q16 factor[N] = {JP_Q16(1.3), JP_Q16(0.8), JP_Q16(1.2), JP_Q16(0.9)};
    struct jp_learned_state state;
    struct jp_four_wheel_energy_model learned;

    drive_as(factor, 20);
    state = learner.state;
    learned = learner.model;
    jp_four_wheel_learner_start(&learner, &config, &model);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_learner_restore(&learner, &state, &refused));
    TEST_ASSERT_EQUAL_MEMORY(&state, &learner.state, sizeof state);
    TEST_ASSERT_EQUAL_MEMORY(&learned, &learner.model, sizeof learned);
}

static void test_a_state_of_another_learning_is_refused(void)
{
    struct jp_learned_state state = learner.state;

    state.identity++;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_four_wheel_learner_restore(&learner, &state, &refused));
    TEST_ASSERT_EQUAL_STRING("state.identity", refused);
    state = learner.state;
    state.x[0] = JP_LEARNED_MAX + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_four_wheel_learner_restore(&learner, &state, &refused));
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
        const struct jp_four_wheel_drive drive = drive_on(&learner.model);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_forecast_add(&learner, &sum, &drive));
        energy += drive.energy;
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_forecast_total(&learner, &sum, &forecast));
    TEST_ASSERT_EQUAL_INT32((int32_t)energy, forecast.energy);
    TEST_ASSERT_TRUE(forecast.deviation > forecast.energy / 20);
}

static void test_what_does_not_fit_is_an_overflow(void)
{
    struct jp_four_wheel_drive drive = {.energy = (int64_t)INT32_MAX + 1};
    struct jp_forecast_sum sum = {0, {0}, 0};
    enum jp_learned learned = JP_LEARNED;

    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_four_wheel_learner_update(&learner, &drive, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_four_wheel_forecast_add(&learner, &sum, &drive));
    drive = (struct jp_four_wheel_drive){.change = {0, 0, (int64_t)INT32_MIN - 1, 0}};
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_four_wheel_learner_update(&learner, &drive, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_four_wheel_forecast_add(&learner, &sum, &drive));
    TEST_ASSERT_TRUE(sum.energy == 0);
    TEST_ASSERT_EQUAL_UINT32(0, learner.state.version);
}

static void test_null_is_an_argument(void)
{
    const struct jp_four_wheel_drive drive = {0};
    struct jp_forecast_sum sum = {0, {0}, 0};
    struct jp_forecast forecast;
    enum jp_learned learned;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_learner_restore(NULL, &learner.state, &refused));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_learner_restore(&learner, NULL, &refused));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_learner_update(NULL, &drive, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_learner_update(&learner, NULL, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_learner_update(&learner, &drive, 0, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_forecast_add(NULL, &sum, &drive));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_forecast_add(&learner, NULL, &drive));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_forecast_add(&learner, &sum, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_forecast_total(NULL, &sum, &forecast));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_forecast_total(&learner, NULL, &forecast));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_forecast_total(&learner, &sum, NULL));
}
