/* Headings and speeds that are found: what is refused, what is saved, what is given and held, horizons, routes that go
 * on, routes that cannot be planned. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <joulepath/trajectory_optimiser.h>
#include <stddef.h>

#include "unity.h"

enum { LEGS = 5 };

static struct jp_trajectory_config robot;
static struct jp_point targets[LEGS];
static struct jp_passage given[LEGS];
static struct jp_passage passages[LEGS];
static struct jp_optimiser_place places[LEGS];
static struct jp_trajectory_leg legs[LEGS];
static struct jp_trajectory trajectory;
static struct jp_trajectory_optimiser_config config;
static struct jp_trajectory_optimiser optimiser;

/* Sharp turns to both sides. */
void setUp(void)
{
    static const struct jp_point zigzag[LEGS] = {
        {JP_Q16(2), 0}, {JP_Q16(2), JP_Q16(2)}, {JP_Q16(4), JP_Q16(3)}, {JP_Q16(3), JP_Q16(5)}, {0, JP_Q16(5)}};

    robot = jp_robot_courier24.trajectory;
    for (unsigned i = 0; i < LEGS; i++) {
        targets[i] = zigzag[i];
        given[i] = (struct jp_passage){.given = 0};
        passages[i] = (struct jp_passage){.given = 0x55, .heading = 1, .speed = 1};
    }
    config = (struct jp_trajectory_optimiser_config){
        .task = {.config = &robot,
                 .cruise = jp_cruise_speed(&jp_energy_model_courier24),
                 .targets = targets,
                 .count = LEGS},
        .model = &jp_energy_model_courier24,
        .passages = passages,
        .places = places,
        .place_count = LEGS,
    };
    optimiser = (struct jp_trajectory_optimiser){.rule = 0.0f};
}

void tearDown(void)
{
}

/* To its end, in as many slices as it may take. */
static enum jp_status search(void)
{
    unsigned slices = 0;
    enum jp_status status = jp_trajectory_optimiser_start(&optimiser, &config);

    TEST_ASSERT_EQUAL_INT(JP_OK, status);
    do {
        status = jp_trajectory_optimiser_work(&optimiser);
        slices++;
    } while (status == JP_WORKING);
    TEST_ASSERT_TRUE(slices <= (JP_OPTIMISER_EVALUATIONS + 1U) * LEGS);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_trajectory_optimiser_work(&optimiser));
    return status;
}

static void expect_given(unsigned index, unsigned bits)
{
    TEST_ASSERT_EQUAL_UINT32(bits, passages[index].given);
}

static void expect_nothing_given(void)
{
    for (unsigned i = 0; i < config.task.count; i++) {
        expect_given(i, 0);
    }
}

static jp_q16 energy_with(const struct jp_passage *with)
{
    struct jp_trajectory_task task = config.task;
    jp_q16 energy = 0;

    task.passages = with;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_by_rule(&task, legs, &trajectory));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_energy(&robot, config.model, &trajectory, &energy));
    return energy;
}

/* ---- What is refused ---- */

static void expect_refused(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_optimiser_start(&optimiser, &config));
    setUp();
}

static void test_configurations_that_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_optimiser_start(NULL, &config));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_optimiser_start(&optimiser, NULL));
    config.model = NULL;
    expect_refused();
    config.passages = NULL;
    expect_refused();
    config.places = NULL;
    expect_refused();
    config.place_count = 0;
    expect_refused();
    config.task.config = NULL;
    expect_refused();
    config.task.count = 0;
    expect_refused();
    config.held = LEGS + 1;
    expect_refused();
    config.goes_on = true;
    expect_refused();
}

static void test_work_without_a_search(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_optimiser_work(NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_trajectory_optimiser_work(&optimiser));
}

/* ---- What is found ---- */

static void test_less_energy_than_with_the_rules_own_passages(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    for (unsigned i = 0; i + 1 < LEGS; i++) {
        expect_given(i, (unsigned)JP_GIVEN_HEADING | (unsigned)JP_GIVEN_SPEED);
        TEST_ASSERT_TRUE(passages[i].speed < config.task.cruise);
    }
    expect_given(LEGS - 1, 0);

    const jp_q16 saved = energy_with(NULL) - energy_with(passages);

    TEST_ASSERT_TRUE(saved > JP_Q16(0.1));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.03), (int32_t)((optimiser.rule - optimiser.found) * 65536.0f), saved);
}

/* At the cruise of least energy a second costs what it takes: no other heading or speed of a passage takes less. */
static void expect_least(struct jp_passage *passage, jp_q16 least)
{
    const struct jp_passage found = *passage;

    for (int sign = -1; sign <= 1; sign += 2) {
        passage->heading = found.heading + (jp_angle)(sign * (int32_t)JP_ANGLE_DEGREES(4));
        TEST_ASSERT_GREATER_THAN_INT32(least - JP_Q16(0.01), energy_with(passages));
        *passage = found;
        passage->speed += sign * (found.speed / 12);
        TEST_ASSERT_GREATER_THAN_INT32(least - JP_Q16(0.01), energy_with(passages));
        *passage = found;
    }
}

static void test_passages_nearby_take_no_less(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    const jp_q16 least = energy_with(passages);

    for (unsigned i = 0; i + 1 < LEGS; i++) {
        expect_least(&passages[i], least);
    }
}

/* Evaluations of the whole route, where nothing limits the robot, and one plan. */
static void test_few_evaluations_do(void)
{
    unsigned slices = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_optimiser_start(&optimiser, &config));
    while (jp_trajectory_optimiser_work(&optimiser) == JP_WORKING) {
        slices++;
    }
    TEST_ASSERT_LESS_THAN_UINT32((5U + 1U) * LEGS, slices);
}

/* Where a second costs more, waypoints are passed faster, by the cruise. */
static void test_a_price_of_time(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, search());

    const jp_q24 before = passages[1].speed;

    config.task.cruise = config.task.cruise * 3 / 2;
    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    TEST_ASSERT_TRUE(passages[1].speed > before + before / 4);
}

static void test_what_is_given_stays(void)
{
    given[0] = (struct jp_passage){.given = JP_GIVEN_HEADING, .heading = JP_ANGLE_DEGREES(30)};
    given[1] = (struct jp_passage){.given = JP_GIVEN_SPEED, .speed = JP_Q24(0.3)};
    given[2] = (struct jp_passage){.given = (unsigned)JP_GIVEN_HEADING | (unsigned)JP_GIVEN_SPEED,
                                   .heading = JP_ANGLE_DEGREES(80),
                                   .speed = JP_Q24(0.35)};
    config.task.passages = given;
    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    TEST_ASSERT_EQUAL_UINT32(given[0].heading, passages[0].heading);
    TEST_ASSERT_EQUAL_INT32(given[1].speed, passages[1].speed);
    TEST_ASSERT_EQUAL_UINT32(given[2].heading, passages[2].heading);
    TEST_ASSERT_EQUAL_INT32(given[2].speed, passages[2].speed);
    for (unsigned i = 0; i + 1 < LEGS; i++) {
        expect_given(i, (unsigned)JP_GIVEN_HEADING | (unsigned)JP_GIVEN_SPEED);
    }
    TEST_ASSERT_TRUE(energy_with(passages) < energy_with(given));
}

static void test_one_leg_has_nothing_to_find(void)
{
    config.task.count = 1;
    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    expect_nothing_given();
    TEST_ASSERT_EQUAL_INT32((int32_t)(optimiser.rule * 1e3f), (int32_t)(optimiser.found * 1e3f));
}

static void test_a_straight_row_is_driven_by_the_rule(void)
{
    for (unsigned i = 0; i < LEGS; i++) {
        targets[i] = (struct jp_point){JP_Q16(2) * (jp_q16)(i + 1U), 0};
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), energy_with(NULL), energy_with(passages));
}

static void test_turning_back(void)
{
    targets[1] = (struct jp_point){JP_Q16(-2), 0};
    config.task.count = 2;
    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    TEST_ASSERT_TRUE(energy_with(passages) <= energy_with(NULL));
}

static void test_a_start_in_fast_motion(void)
{
    config.task.motion = (struct jp_travel_state){.speed = JP_Q24(1.5), .turn_rate = JP_Q24(0.1)};
    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    TEST_ASSERT_TRUE(energy_with(passages) < energy_with(NULL));
}

/* ---- Horizons ---- */

static void test_a_route_beyond_the_memory(void)
{
    config.place_count = 3;
    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    expect_given(0, (unsigned)JP_GIVEN_HEADING | (unsigned)JP_GIVEN_SPEED);
    for (unsigned i = 1; i < LEGS; i++) {
        expect_given(i, 0);
    }
    TEST_ASSERT_TRUE(energy_with(passages) < energy_with(NULL));
}

/* Anew from the first waypoint, from which the robot has planned to the second and the third. */
static void test_a_horizon_that_recedes(void)
{
    struct jp_passage before[LEGS];

    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    for (unsigned i = 0; i < LEGS; i++) {
        before[i] = passages[i];
    }
    passages[3].given = 0;
    config.task.start = targets[0];
    config.task.heading = before[0].heading;
    config.task.motion = (struct jp_travel_state){.speed = before[0].speed, .turn_rate = JP_Q24(0.2)};
    config.task.targets = &targets[1];
    config.task.count = LEGS - 1U;
    config.passages = &passages[1];
    config.goes_on = true;
    config.held = 2;
    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    TEST_ASSERT_EQUAL_MEMORY(&before[1], &passages[1], 2 * sizeof before[0]);
    TEST_ASSERT_INT32_WITHIN(JP_ANGLE_DEGREES(1), (int32_t)before[3].heading, (int32_t)passages[3].heading);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.005), before[3].speed, passages[3].speed);
}

static void test_all_that_is_held(void)
{
    for (unsigned i = 0; i < LEGS; i++) {
        passages[i] = given[i];
    }
    config.held = LEGS;
    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    expect_nothing_given();
}

/* ---- Limits ---- */

/* A robot that is too weak for headings at the pace of its legs passes as the rule has it, at another speed. */
static void test_headings_that_would_slow_a_leg_down(void)
{
    robot.voltage = JP_Q16(3.3);
    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    for (unsigned i = 0; i + 1 < LEGS; i++) {
        expect_given(i, (unsigned)JP_GIVEN_SPEED);
    }
    TEST_ASSERT_TRUE(energy_with(passages) < energy_with(NULL));
}

static void expect_failure(enum jp_status status)
{
    TEST_ASSERT_EQUAL_INT(status, search());
    expect_nothing_given();
}

static void test_what_the_rule_refuses(void)
{
    targets[2] = targets[1];
    expect_failure(JP_ERR_ZERO_LENGTH);
    setUp();
    config.task.cruise = 0;
    expect_failure(JP_ERR_ARGUMENT);
    setUp();
    config.task.targets = NULL;
    expect_failure(JP_ERR_ARGUMENT);
    setUp();
    robot.voltage = 1;
    expect_failure(JP_ERR_INFEASIBLE);
}

static void test_a_leg_that_is_hardly_there(void)
{
    targets[1] = (struct jp_point){JP_Q16(2), JP_Q16(0.02)};
    TEST_ASSERT_EQUAL_INT(JP_OK, search());
    TEST_ASSERT_TRUE(energy_with(passages) <= energy_with(NULL));
}
