/* The learner of grounds: what legs over one class and over several teach, its forecasts, what it refuses. */
#include <joulepath/ground_learner.h>
#include <stddef.h>
#include <string.h>

#include "tests/target/random.h"
#include "unity.h"

enum { LAST = JP_GROUND_CLASSES - 1, FACTORS = JP_GROUND_FACTORS };

static struct jp_factor_learning learning;
static struct jp_ground_learner learner;
static struct jp_ground_change change;
static struct jp_forecast expected;
static uint32_t random_state;
static const char *refused;

/* J that a leg takes by each factor where it is 1, and besides. */
static int64_t parts[JP_GROUND_CLASSES][FACTORS];
static int64_t fixed;
/* Of the world. */
static jp_q16 truth[JP_GROUND_CLASSES][FACTORS];

void setUp(void)
{
    learning = jp_ground_learning;
    jp_ground_learner_start(&learner, &learning);
    change = (struct jp_ground_change){.by_factor = {{0}}};
    expected = (struct jp_forecast){0, JP_Q16(0.5)};
    random_state = 1;
    refused = NULL;
    memset(parts, 0, sizeof parts);
    fixed = JP_Q16(40);
    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        truth[k][JP_GROUND_ROLLING] = JP_Q16_ONE;
        truth[k][JP_GROUND_FRICTION] = JP_Q16_ONE;
    }
}

void tearDown(void)
{
}

static int32_t draw(int32_t low, int32_t high)
{
    return low + (int32_t)(((uint64_t)target_random(&random_state) * (uint32_t)(high - low)) >> 32);
}

static void draw_part(uint8_t ground)
{
    parts[ground][JP_GROUND_ROLLING] = draw(JP_Q16(5), JP_Q16(60));
    parts[ground][JP_GROUND_FRICTION] = draw(0, JP_Q16(40));
}

/* Linear in the factors: what is expected as learned so far, and what it changes by. */
static void expect_leg(void)
{
    int64_t energy = fixed;

    for (uint8_t k = 0; k < JP_GROUND_CLASSES; k++) {
        jp_q16 factor[FACTORS];

        jp_ground_learner_factors(&learner, k, factor);
        for (int j = 0; j < FACTORS; j++) {
            change.by_factor[k][j] = parts[k][j] * factor[j] / JP_Q16_ONE;
            energy += change.by_factor[k][j];
        }
    }
    expected.energy = (jp_q16)energy;
}

static jp_q16 true_energy(void)
{
    int64_t energy = fixed;

    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        for (int j = 0; j < FACTORS; j++) {
            energy += parts[k][j] * truth[k][j] / JP_Q16_ONE;
        }
    }
    return (jp_q16)energy;
}

static enum jp_learned learn(jp_q16 measured)
{
    enum jp_learned learned = JP_LEARNED;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ground_learner_update(&learner, &expected, &change, measured, &learned));
    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_learned_state_check(&learner.states[k], &refused));
    }
    return learned;
}

/* Legs over each class of a set of bits alone. */
static void drive(unsigned classes, unsigned legs)
{
    for (unsigned i = 0; i < legs; i++) {
        const uint8_t ground = (uint8_t)(i % JP_GROUND_CLASSES);

        memset(parts, 0, sizeof parts);
        if (((classes >> ground) & 1U) != 0U) {
            draw_part(ground);
        }
        expect_leg();
        (void)learn(true_energy());
    }
}

/* A share of what a part of the leg takes. */
static void shorten(uint8_t ground, jp_q16 share)
{
    for (int j = 0; j < FACTORS; j++) {
        parts[ground][j] = parts[ground][j] * share / JP_Q16_ONE;
    }
}

/* Legs from each class to the next, which they reach sooner or later. */
static void drive_across(unsigned legs)
{
    for (unsigned i = 0; i < legs; i++) {
        const uint8_t from = (uint8_t)(i % JP_GROUND_CLASSES);
        const uint8_t to = (uint8_t)((i + 1U) % JP_GROUND_CLASSES);
        const jp_q16 share = draw(0, JP_Q16_ONE);

        memset(parts, 0, sizeof parts);
        draw_part(from);
        draw_part(to);
        shorten(from, share);
        shorten(to, JP_Q16_ONE - share);
        expect_leg();
        (void)learn(true_energy());
    }
}

static void expect_factor(uint8_t ground, int factor, jp_q16 within)
{
    jp_q16 factors[FACTORS];

    jp_ground_learner_factors(&learner, ground, factors);
    TEST_ASSERT_INT32_WITHIN(within, truth[ground][factor], factors[factor]);
}

/* ---- Start ---- */

static void test_the_learning_passes_its_check(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_factor_learning_check(&jp_ground_learning, &refused));
}

static void test_nothing_is_learned_at_first(void)
{
    for (uint8_t k = 0; k < JP_GROUND_CLASSES; k++) {
        jp_q16 deviation[FACTORS];

        expect_factor(k, JP_GROUND_ROLLING, 0);
        expect_factor(k, JP_GROUND_FRICTION, 0);
        jp_ground_learner_deviations(&learner, k, deviation);
        TEST_ASSERT_INT32_WITHIN(16, k == 0U ? 0 : learning.deviation[JP_GROUND_ROLLING], deviation[JP_GROUND_ROLLING]);
        TEST_ASSERT_INT32_WITHIN(16, k == 0U ? 0 : learning.deviation[JP_GROUND_FRICTION],
                                 deviation[JP_GROUND_FRICTION]);
    }
}

static void test_no_such_class_is_as_class_0(void)
{
    jp_q16 factor[FACTORS];
    jp_q16 deviation[FACTORS];

    memset(learner.watches, 0x11, sizeof learner.watches); /* what lies beyond the last class */
    jp_ground_learner_factors(&learner, JP_GROUND_CLASSES, factor);
    jp_ground_learner_deviations(&learner, JP_GROUND_CLASSES, deviation);
    TEST_ASSERT_EQUAL_INT32(JP_Q16_ONE, factor[JP_GROUND_ROLLING]);
    TEST_ASSERT_EQUAL_INT32(0, deviation[JP_GROUND_FRICTION]);
}

/* ---- Learning ---- */

static void test_legs_on_one_class_teach_its_factors(void)
{
    truth[1][JP_GROUND_ROLLING] = JP_Q16(2.5);
    truth[1][JP_GROUND_FRICTION] = JP_Q16(0.7);
    truth[2][JP_GROUND_ROLLING] = JP_Q16(0.6);
    drive(6U, 60);
    expect_factor(1, JP_GROUND_ROLLING, JP_Q16(0.03));
    expect_factor(1, JP_GROUND_FRICTION, JP_Q16(0.05));
    expect_factor(2, JP_GROUND_ROLLING, JP_Q16(0.03));
    expect_factor(2, JP_GROUND_FRICTION, JP_Q16(0.05));
    expect_factor(3, JP_GROUND_ROLLING, 0);
    TEST_ASSERT_EQUAL_UINT32(0, learner.changes);
}

static void test_legs_over_several_classes_teach_each(void)
{
    truth[1][JP_GROUND_ROLLING] = JP_Q16(3);
    truth[2][JP_GROUND_ROLLING] = JP_Q16(1.5);
    truth[LAST][JP_GROUND_ROLLING] = JP_Q16(0.5);
    drive_across(300);
    expect_factor(1, JP_GROUND_ROLLING, JP_Q16(0.1));
    expect_factor(2, JP_GROUND_ROLLING, JP_Q16(0.1));
    expect_factor(LAST, JP_GROUND_ROLLING, JP_Q16(0.1));
}

/* They roll nowhere. */
static void test_turns_on_the_spot_teach_friction_alone(void)
{
    truth[1][JP_GROUND_FRICTION] = JP_Q16(1.6);
    for (unsigned i = 0; i < 40U; i++) {
        parts[1][JP_GROUND_FRICTION] = draw(JP_Q16(5), JP_Q16(40));
        expect_leg();
        (void)learn(true_energy());
    }
    expect_factor(1, JP_GROUND_FRICTION, JP_Q16(0.05));
    expect_factor(1, JP_GROUND_ROLLING, 0);
    expect_factor(2, JP_GROUND_FRICTION, 0);
}

static void test_deviations_shrink_where_it_has_been(void)
{
    jp_q16 been[FACTORS];
    jp_q16 elsewhere[FACTORS];

    drive(2U, 40);
    jp_ground_learner_deviations(&learner, 1, been);
    jp_ground_learner_deviations(&learner, 2, elsewhere);
    TEST_ASSERT_LESS_THAN_INT32(learning.deviation[JP_GROUND_ROLLING] / 10, been[JP_GROUND_ROLLING]);
    TEST_ASSERT_INT32_WITHIN(16, learning.deviation[JP_GROUND_ROLLING], elsewhere[JP_GROUND_ROLLING]);
}

/* What is not known of the robot is not taken for the ground. */
static void test_what_may_be_the_robot_teaches_less(void)
{
    jp_q16 sure[FACTORS];
    jp_q16 unsure[FACTORS];

    truth[1][JP_GROUND_ROLLING] = JP_Q16(2);
    drive(2U, 5);
    jp_ground_learner_factors(&learner, 1, sure);
    jp_ground_learner_start(&learner, &learning);
    random_state = 1;
    expected.deviation = JP_Q16(100);
    drive(2U, 5);
    jp_ground_learner_factors(&learner, 1, unsure);
    TEST_ASSERT_GREATER_THAN_INT32(JP_Q16(1.8), sure[JP_GROUND_ROLLING]);
    TEST_ASSERT_LESS_THAN_INT32(JP_Q16(1.6), unsure[JP_GROUND_ROLLING]);
}

static void test_factors_stay_within_their_range(void)
{
    truth[1][JP_GROUND_ROLLING] = JP_Q16(9);
    truth[2][JP_GROUND_ROLLING] = 0;
    drive(6U, 120);
    truth[1][JP_GROUND_ROLLING] = JP_FACTOR_MAX;
    truth[2][JP_GROUND_ROLLING] = JP_FACTOR_MIN;
    expect_factor(1, JP_GROUND_ROLLING, JP_Q16(0.01));
    expect_factor(2, JP_GROUND_ROLLING, JP_Q16(0.1));
}

static void test_a_leg_on_class_0_teaches_nothing(void)
{
    const struct jp_ground_learner before = learner;

    draw_part(0);
    expect_leg();
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_NOTHING, learn(JP_Q16(1000)));
    TEST_ASSERT_EQUAL_MEMORY(&before.states, &learner.states, sizeof before.states);
}

static void test_one_leg_that_is_far_off_is_an_outlier(void)
{
    drive(2U, 60);
    draw_part(1);
    expect_leg();
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER, learn(true_energy() + JP_Q16(200)));
    TEST_ASSERT_EQUAL_UINT32(1, learner.outliers);
}

/* Rain: the class is learned anew. */
static void test_a_ground_that_changes_is_learned_anew(void)
{
    truth[1][JP_GROUND_ROLLING] = JP_Q16(1.2);
    drive(2U, 200);
    truth[1][JP_GROUND_ROLLING] = JP_Q16(3);
    drive(2U, 80);
    TEST_ASSERT_GREATER_THAN_UINT32(0, learner.changes);
    expect_factor(1, JP_GROUND_ROLLING, JP_Q16(0.1));
}

/* The news of one class is more than that of the other. */
static void test_of_several_classes_the_most_is_told(void)
{
    drive(2U, 60);
    memset(parts, 0, sizeof parts);
    draw_part(1);
    parts[2][JP_GROUND_ROLLING] = JP_Q16(0.001);
    expect_leg();
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER, learn(true_energy() + JP_Q16(200)));
}

/* Whichever of them comes first: the class whose noise is small has an outlier where the other learns. */
static void test_the_most_is_told_in_either_order(void)
{
    for (unsigned sure = 1; sure <= 2U; sure++) {
        setUp();
        drive(6U, 60);
        learner.states[sure].noise_scale = JP_Q16(0.25);
        learner.states[3U - sure].noise_scale = JP_Q16(8);
        memset(parts, 0, sizeof parts);
        parts[1][JP_GROUND_ROLLING] = JP_Q16(20);
        parts[2][JP_GROUND_ROLLING] = JP_Q16(20);
        expect_leg();
        TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER, learn(true_energy() + JP_Q16(20)));
        TEST_ASSERT_EQUAL_UINT32(1, learner.outliers);
    }
}

static void test_straight_legs_teach_rolling_alone(void)
{
    truth[1][JP_GROUND_ROLLING] = JP_Q16(2);
    for (unsigned i = 0; i < 40U; i++) {
        memset(parts, 0, sizeof parts);
        parts[1][JP_GROUND_ROLLING] = draw(JP_Q16(5), JP_Q16(60));
        expect_leg();
        TEST_ASSERT_EQUAL_INT(JP_LEARNED, learn(true_energy()));
    }
    expect_factor(1, JP_GROUND_ROLLING, JP_Q16(0.05));
    expect_factor(1, JP_GROUND_FRICTION, 0);
}

/* ---- Forecast ---- */

static void test_what_is_not_known_of_a_ground_widens_a_forecast(void)
{
    struct jp_forecast forecast = {JP_Q16(100), JP_Q16(3)};

    change.by_factor[1][JP_GROUND_ROLLING] = JP_Q16(4);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ground_learner_widen(&learner, &change, &forecast));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(5), forecast.deviation);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(100), forecast.energy);
}

static void test_changes_of_legs_add_up(void)
{
    struct jp_ground_change sum = {.by_factor = {{0}}};
    struct jp_forecast forecast = {0, 0};

    change.by_factor[0][JP_GROUND_ROLLING] = JP_Q16(1000);
    change.by_factor[2][JP_GROUND_FRICTION] = JP_Q16(3);
    jp_ground_change_add(&sum, &change);
    jp_ground_change_add(&sum, &change);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ground_learner_widen(&learner, &sum, &forecast));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(3), forecast.deviation); /* 6 J by a factor of 1 ± ½ */
}

static void test_a_forecast_that_has_no_format(void)
{
    struct jp_forecast forecast = {0, JP_Q16(1)};

    change.by_factor[1][JP_GROUND_ROLLING] = (int64_t)JP_Q16(8192) + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_ground_learner_widen(&learner, &change, &forecast));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, forecast.deviation);
    change.by_factor[1][JP_GROUND_ROLLING] = -(int64_t)JP_Q16(8192);
    forecast.deviation = JP_Q16(32000);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_ground_learner_widen(&learner, &change, &forecast));
    change.by_factor[1][JP_GROUND_ROLLING] = -(int64_t)JP_Q16(8192) - 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_ground_learner_widen(&learner, &change, &forecast));
    change.by_factor[2][JP_GROUND_FRICTION] = INT64_MIN;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_ground_learner_widen(&learner, &change, &forecast));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, forecast.deviation);
}

/* ---- Storing ---- */

static void test_a_stored_state_goes_on(void)
{
    struct jp_learned_state stored;

    truth[2][JP_GROUND_ROLLING] = JP_Q16(2);
    drive(4U, 40);
    stored = learner.states[2];
    jp_ground_learner_start(&learner, &learning);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ground_learner_restore(&learner, 2, &stored, &refused));
    expect_factor(2, JP_GROUND_ROLLING, JP_Q16(0.05));
}

static void test_what_is_not_restored(void)
{
    struct jp_learned_state stored = learner.states[1];

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ground_learner_restore(NULL, 1, &stored, &refused));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ground_learner_restore(&learner, 0, &stored, &refused));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ground_learner_restore(&learner, JP_GROUND_CLASSES, &stored, &refused));
    stored.identity++;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_ground_learner_restore(&learner, 1, &stored, &refused));
    TEST_ASSERT_EQUAL_STRING("state.identity", refused);
}

/* ---- Refusals ---- */

static void test_refusals(void)
{
    enum jp_learned learned = JP_LEARNED_CHANGE;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ground_learner_update(NULL, &expected, &change, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ground_learner_update(&learner, NULL, &change, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ground_learner_update(&learner, &expected, NULL, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ground_learner_update(&learner, &expected, &change, 0, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ground_learner_widen(NULL, &change, &expected));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ground_learner_widen(&learner, NULL, &expected));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ground_learner_widen(&learner, &change, NULL));
    change.by_factor[LAST][JP_GROUND_FRICTION] = (int64_t)INT32_MAX + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_ground_learner_update(&learner, &expected, &change, 0, &learned));
    change.by_factor[LAST][JP_GROUND_FRICTION] = -(int64_t)INT32_MAX - 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_ground_learner_update(&learner, &expected, &change, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_CHANGE, learned);
}

/* No noise is too large for its format. */
static void test_the_largest_noise(void)
{
    expected = (struct jp_forecast){INT32_MAX, INT32_MAX};
    change.by_factor[1][JP_GROUND_ROLLING] = INT32_MAX;
    TEST_ASSERT_NOT_EQUAL(JP_LEARNED_CHANGE, learn(0));
}
