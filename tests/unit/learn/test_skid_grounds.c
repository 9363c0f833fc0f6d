/* What a skid-steered robot knows of grounds: which leg teaches what, its models, its forecasts. */
#include <joulepath/skid_grounds.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "tests/target/random.h"
#include "unity.h"

static struct jp_skid_learner robot;
static struct jp_skid_grounds grounds;
static struct jp_skid_energy_model truth[JP_GROUND_CLASSES];
static struct jp_skid_ground_drive known;
static struct jp_skid_ground_drive driven;
static uint32_t random_state;

void setUp(void)
{
    jp_skid_learner_start(&robot, &jp_skid_learning_zhang2018, &jp_skid_energy_zhang2018);
    jp_skid_grounds_start(&grounds, &jp_ground_learning, &robot);
    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        truth[k] = jp_skid_energy_zhang2018;
    }
    known = (struct jp_skid_ground_drive){.on = {{.energy = 0}}};
    driven = known;
    random_state = 1;
}

void tearDown(void)
{
}

static int32_t draw(int32_t low, int32_t high)
{
    return low + (int32_t)(((uint64_t)target_random(&random_state) * (uint32_t)(high - low)) >> 32);
}

/* Of the leg, as known and as it is, straight on and then a turn. */
static void drive_on(uint8_t ground, jp_q16 seconds)
{
    const struct jp_skid_piece pieces[2] = {
        {{JP_Q24(0.5), 0}, {JP_Q24(0.5), 0}, 0, 0, seconds},
        {{0, JP_Q24(0.4)}, {0, JP_Q24(0.4)}, 0, 0, draw(JP_Q16(0.5), JP_Q16(4))},
    };

    for (unsigned i = 0; i < 2U; i++) {
        const struct jp_skid_energy_model *model = jp_skid_grounds_model(&grounds, &robot, ground);

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(model, &known.on[ground], &pieces[i]));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(&truth[ground], &driven.on[ground], &pieces[i]));
    }
}

static jp_q16 energy_of(const struct jp_skid_ground_drive *drive)
{
    struct jp_skid_drive total;

    jp_skid_ground_drive_total(drive, &total);
    return jp_saturate32(total.energy);
}

static enum jp_learned learn(void)
{
    enum jp_learned learned = JP_LEARNED;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_grounds_update(&grounds, &robot, &known, energy_of(&driven), &learned));
    known = (struct jp_skid_ground_drive){.on = {{.energy = 0}}};
    driven = known;
    return learned;
}

static void set_truth(uint8_t ground, jp_q16 rolling, jp_q16 friction)
{
    const jp_q16 factor[JP_SKID_FACTORS] = {rolling, friction, JP_Q16_ONE, JP_Q16_ONE};

    jp_skid_energy_scale(&jp_skid_energy_zhang2018, factor, &truth[ground]);
}

static void expect_factors(uint8_t ground, jp_q16 rolling, jp_q16 friction, jp_q16 within)
{
    jp_q16 factor[JP_GROUND_FACTORS];

    jp_ground_learner_factors(&grounds.learner, ground, factor);
    TEST_ASSERT_INT32_WITHIN(within, rolling, factor[JP_GROUND_ROLLING]);
    TEST_ASSERT_INT32_WITHIN(within, friction, factor[JP_GROUND_FRICTION]);
}

static void test_all_grounds_are_alike_at_first(void)
{
    for (uint8_t k = 0; k < JP_GROUND_CLASSES; k++) {
        TEST_ASSERT_EQUAL_MEMORY(&robot.model, jp_skid_grounds_model(&grounds, &robot, k), sizeof robot.model);
    }
    TEST_ASSERT_EQUAL_PTR(&robot.model, jp_skid_grounds_model(&grounds, &robot, JP_GROUND_CLASSES));
    TEST_ASSERT_EQUAL_PTR(&robot.model, jp_skid_grounds_model(NULL, &robot, 1));
}

static void test_legs_teach_the_ground_that_they_cross(void)
{
    set_truth(1, JP_Q16(2.5), JP_Q16(0.7));
    for (unsigned i = 0; i < 80U; i++) {
        drive_on(1, draw(JP_Q16(2), JP_Q16(20)));
        (void)learn();
    }
    expect_factors(1, JP_Q16(2.5), JP_Q16(0.7), JP_Q16(0.08));
    expect_factors(2, JP_Q16_ONE, JP_Q16_ONE, 0);
    TEST_ASSERT_EQUAL_UINT32(0, robot.state.version);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), truth[1].rolling, jp_skid_grounds_model(&grounds, &robot, 1)->rolling);
}

static void test_legs_on_class_0_teach_the_robot_and_all_models(void)
{
    set_truth(0, JP_Q16(1.3), JP_Q16_ONE);
    for (unsigned i = 0; i < 80U; i++) {
        drive_on(0, draw(JP_Q16(2), JP_Q16(20)));
        (void)learn();
    }
    TEST_ASSERT_EQUAL_UINT32(80, robot.state.version);
    TEST_ASSERT_EQUAL_UINT32(0, grounds.learner.states[1].version);
    TEST_ASSERT_EQUAL_INT32(robot.model.rolling, grounds.models[0].rolling);
    TEST_ASSERT_EQUAL_INT32(robot.model.rolling, grounds.models[1].rolling);
}

static void test_without_grounds_every_leg_teaches_the_robot(void)
{
    enum jp_learned learned = JP_LEARNED_NOTHING;

    drive_on(1, JP_Q16(10));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_grounds_update(NULL, &robot, &known, energy_of(&driven), &learned));
    TEST_ASSERT_EQUAL_INT(JP_LEARNED, learned);
    TEST_ASSERT_EQUAL_UINT32(1, robot.state.version);
}

static void test_a_leg_over_two_grounds(void)
{
    set_truth(2, JP_Q16(2), JP_Q16_ONE);
    for (unsigned i = 0; i < 200U; i++) {
        drive_on(0, draw(JP_Q16(2), JP_Q16(10)));
        drive_on(2, draw(JP_Q16(2), JP_Q16(10)));
        (void)learn();
    }
    expect_factors(2, JP_Q16(2), JP_Q16_ONE, JP_Q16(0.12));
}

/* Nobody knows on which ground it was. */
static void test_a_leg_along_an_edge_teaches_nothing(void)
{
    drive_on(1, JP_Q16(10));
    known.at_edges = known.on[1].energy / 15;
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_NOTHING, learn());
    TEST_ASSERT_EQUAL_UINT32(0, grounds.learner.states[1].version);
    drive_on(1, JP_Q16(10));
    known.at_edges = known.on[1].energy / 17;
    TEST_ASSERT_EQUAL_INT(JP_LEARNED, learn());
}

/* One joule of sixteen may be taken at edges. */
static void test_a_sixteenth_at_edges_still_teaches(void)
{
    drive_on(1, JP_Q16(10));
    known.on[1].energy -= known.on[1].energy % 16;
    known.at_edges = known.on[1].energy / 16;
    TEST_ASSERT_EQUAL_INT(JP_LEARNED, learn());
    drive_on(1, JP_Q16(10));
    known.on[1].energy -= known.on[1].energy % 16;
    known.at_edges = known.on[1].energy / 16 + 1;
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_NOTHING, learn());
}

/* ---- Sums ---- */

static void test_a_part_of_a_drive_is_so_much_of_all_of_it(void)
{
    const struct jp_skid_drive drive = {.energy = 1200, .change = {-400, 800, 40, -4}, .slope_work = 2000};
    struct jp_skid_drive sum = {.energy = 1, .change = {1, 2, 3, 4}, .slope_work = 5};

    jp_skid_drive_add(&sum, &drive, 4);
    TEST_ASSERT_EQUAL_INT32(301, (int32_t)sum.energy);
    TEST_ASSERT_EQUAL_INT32(-99, (int32_t)sum.change[0]);
    TEST_ASSERT_EQUAL_INT32(202, (int32_t)sum.change[1]);
    TEST_ASSERT_EQUAL_INT32(13, (int32_t)sum.change[2]);
    TEST_ASSERT_EQUAL_INT32(3, (int32_t)sum.change[3]);
    TEST_ASSERT_EQUAL_INT32(505, (int32_t)sum.slope_work);
}

/* ---- Forecast ---- */

static void test_forecasts_are_wider_where_the_ground_is_not_known(void)
{
    struct jp_skid_ground_sum sum = {.robot = {.energy = 0}};
    struct jp_forecast without;
    struct jp_forecast with;

    drive_on(1, JP_Q16(20));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_grounds_forecast_add(&robot, &sum, &known));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_grounds_forecast_total(NULL, &robot, &sum, &without));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_grounds_forecast_total(&grounds, &robot, &sum, &with));
    TEST_ASSERT_EQUAL_INT32(energy_of(&known), with.energy);
    TEST_ASSERT_EQUAL_INT32(without.energy, with.energy);
    TEST_ASSERT_GREATER_THAN_INT32(2 * without.deviation, with.deviation);
}

/* ---- Refusals ---- */

static void test_refusals(void)
{
    struct jp_skid_ground_sum sum = {.robot = {.energy = 0}};
    enum jp_learned learned = JP_LEARNED_CHANGE;
    struct jp_forecast forecast;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_grounds_update(&grounds, NULL, &known, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_grounds_update(&grounds, &robot, NULL, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_grounds_update(&grounds, &robot, &known, 0, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_grounds_forecast_add(NULL, &sum, &known));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_grounds_forecast_add(&robot, NULL, &known));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_grounds_forecast_add(&robot, &sum, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_grounds_forecast_total(&grounds, NULL, &sum, &forecast));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_grounds_forecast_total(&grounds, &robot, NULL, &forecast));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_grounds_forecast_total(&grounds, &robot, &sum, NULL));
    known.on[1].energy = (int64_t)INT32_MAX + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_skid_grounds_update(&grounds, &robot, &known, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_skid_grounds_forecast_add(&robot, &sum, &known));
    sum.robot.energy = (int64_t)INT32_MAX + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_skid_grounds_forecast_total(&grounds, &robot, &sum, &forecast));
    known.on[1] = (struct jp_skid_drive){.energy = 1};
    known.on[1].change[JP_SKID_ROLLING] = JP_Q16(20000);
    known.on[2] = known.on[1];
    known.on[2].change[JP_SKID_ROLLING] = -JP_Q16(20000);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_grounds_update(&grounds, &robot, &known, 0, &learned));
}
