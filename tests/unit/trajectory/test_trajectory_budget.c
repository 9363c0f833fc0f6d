/* Trajectories within a budget: what is refused, budgets that bind, that do not and that cannot be kept; figures that
 * overflow; searches that end early. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <joulepath/trajectory_budget.h>
#include <stddef.h>

#include "unity.h"

enum { LEGS = 2 };

static struct jp_trajectory_config robot;
static struct jp_energy_model model;
static struct jp_point targets[LEGS];
static struct jp_trajectory_leg legs[LEGS];
static struct jp_trajectory trajectory;
static struct jp_trajectory_budget_config config;
static struct jp_trajectory_budget budget;

/* Round a corner, up to 1 m/s. */
void setUp(void)
{
    robot = jp_robot_courier24.trajectory;
    model = jp_energy_model_courier24;
    targets[0] = (struct jp_point){JP_Q16(5), 0};
    targets[1] = (struct jp_point){JP_Q16(5), JP_Q16(5)};
    config = (struct jp_trajectory_budget_config){
        .task = {.config = &robot, .cruise = JP_Q24(1), .targets = targets, .count = LEGS},
        .model = &model,
        .kind = JP_BUDGET_SECONDS,
        .limit = JP_Q16(15),
        .legs = legs,
        .trajectory = &trajectory,
    };
    budget = (struct jp_trajectory_budget){.best = {0, 0, 0}};
}

void tearDown(void)
{
}

/* To its end, in as many slices as it may take. */
static enum jp_status search(void)
{
    unsigned slices = 0;
    enum jp_status status = jp_trajectory_budget_start(&budget, &config);

    TEST_ASSERT_EQUAL_INT(JP_OK, status);
    do {
        status = jp_trajectory_budget_work(&budget);
        slices++;
    } while (status == JP_WORKING);
    TEST_ASSERT_TRUE(slices <= JP_BUDGET_SLICES);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_trajectory_budget_work(&budget));
    return status;
}

static enum jp_status search_within(enum jp_budget_kind kind, jp_q16 limit)
{
    config.kind = kind;
    config.limit = limit;
    return search();
}

static jp_q16 duration(void)
{
    jp_q16 seconds = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_duration(&robot, &trajectory, &seconds));
    return seconds;
}

static jp_q16 energy(void)
{
    jp_q16 joules = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_energy(&robot, &model, &trajectory, &joules));
    return joules;
}

/* What is said of the trajectory is true of it. */
static void expect_true_figures(void)
{
    TEST_ASSERT_EQUAL_INT32(duration(), budget.best.seconds);
    TEST_ASSERT_EQUAL_INT32(energy(), budget.best.energy);
}

/* ---- What it refuses ---- */

#define REFUSED(member, value)                                                                                         \
    do {                                                                                                               \
        setUp();                                                                                                       \
        config.member = (value);                                                                                       \
        TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_budget_start(&budget, &config));                          \
    } while (0)

static void test_refuses_bad_arguments(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_budget_start(NULL, &config));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_budget_start(&budget, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_budget_work(NULL));
    REFUSED(model, NULL);
    REFUSED(legs, NULL);
    REFUSED(trajectory, NULL);
    REFUSED(limit, 0);
    REFUSED(limit, -1);
    REFUSED(kind, (enum jp_budget_kind)2);
    REFUSED(task.cruise, JP_Q24(0.01) - 1);
    REFUSED(task.cruise, JP_Q24(8) + 1);
}

static void test_works_only_on_what_was_begun(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_trajectory_budget_work(&budget));
}

/* ---- Time ---- */

static void test_a_time_that_does_takes_the_least_energy(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, search_within(JP_BUDGET_SECONDS, JP_Q16(1000)));
    expect_true_figures();
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.03), jp_cruise_speed(&model), budget.best.cruise);
}

static void test_less_time_takes_more_energy(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, search_within(JP_BUDGET_SECONDS, JP_Q16(1000)));

    const jp_q16 seconds = budget.best.seconds;
    const jp_q16 joules = budget.best.energy;

    for (int32_t tenths = 9; tenths >= 6; tenths--) {
        const jp_q16 limit = seconds / 10 * tenths;

        TEST_ASSERT_EQUAL_INT(JP_OK, search_within(JP_BUDGET_SECONDS, limit));
        expect_true_figures();
        TEST_ASSERT_LESS_OR_EQUAL_INT32(limit, budget.best.seconds);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), limit, budget.best.seconds);
        TEST_ASSERT_GREATER_THAN_INT32(joules, budget.best.energy);
    }
}

static void test_too_little_time_is_infeasible_and_says_how_much_is_needed(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, search_within(JP_BUDGET_SECONDS, JP_Q16(3)));
    expect_true_figures();
    TEST_ASSERT_EQUAL_INT32(config.task.cruise, budget.best.cruise);

    const jp_q16 needed = budget.best.seconds;

    TEST_ASSERT_EQUAL_INT(JP_OK, search_within(JP_BUDGET_SECONDS, needed));
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, search_within(JP_BUDGET_SECONDS, needed - 1));
}

/* ---- Energy ---- */

static void test_more_energy_takes_less_time(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, search_within(JP_BUDGET_SECONDS, JP_Q16(1000)));

    const jp_q16 joules = budget.best.energy;
    jp_q16 seconds = budget.best.seconds;

    for (int32_t more = 1; more <= 3; more++) {
        const jp_q16 limit = joules / 20 * (20 + more);

        TEST_ASSERT_EQUAL_INT(JP_OK, search_within(JP_BUDGET_JOULES, limit));
        expect_true_figures();
        TEST_ASSERT_LESS_OR_EQUAL_INT32(limit, budget.best.energy);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.1), limit, budget.best.energy);
        TEST_ASSERT_LESS_THAN_INT32(seconds, budget.best.seconds);
        seconds = budget.best.seconds;
    }
}

static void test_energy_enough_takes_the_greatest_cruise(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, search_within(JP_BUDGET_JOULES, JP_Q16(30000)));
    expect_true_figures();
    TEST_ASSERT_EQUAL_INT32(config.task.cruise, budget.best.cruise);
}

static void test_too_little_energy_is_infeasible_and_says_how_much_is_needed(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, search_within(JP_BUDGET_SECONDS, JP_Q16(1000)));

    const jp_q16 least = budget.best.energy;

    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, search_within(JP_BUDGET_JOULES, JP_Q16(10)));
    expect_true_figures();
    TEST_ASSERT_EQUAL_INT32(least, budget.best.energy);
}

/* ---- The greatest cruise ---- */

static void test_the_greatest_cruise_may_be_below_the_best(void)
{
    config.task.cruise = JP_Q24(0.2);
    TEST_ASSERT_EQUAL_INT(JP_OK, search_within(JP_BUDGET_SECONDS, JP_Q16(1000)));
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.2), budget.best.cruise);
}

static void test_the_least_cruise_there_is(void)
{
    config.task.cruise = JP_Q24(0.01);
    TEST_ASSERT_EQUAL_INT(JP_OK, search_within(JP_BUDGET_SECONDS, JP_Q16(2000)));
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.01), budget.best.cruise);
}

/* At half of it no voltage is left to turn with. */
static void test_a_greatest_cruise_that_cannot_be_driven(void)
{
    config.task.cruise = JP_Q24(8);
    TEST_ASSERT_EQUAL_INT(JP_OK, search_within(JP_BUDGET_JOULES, JP_Q16(30000)));
    expect_true_figures();
    TEST_ASSERT_LESS_THAN_INT32(JP_Q24(4), budget.best.cruise);
}

/* ---- Routes that cannot be planned ---- */

static void test_no_trajectory_at_any_cruise(void)
{
    robot.voltage = 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, search());
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, budget.best.seconds);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, budget.best.energy);
}

static void test_what_the_rule_refuses_ends_the_search(void)
{
    targets[1] = targets[0];
    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, search());
    config.task.targets = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, search());
}

/* ---- Overflow ---- */

/* A thousand times the energy, of which no speed has so little that it fits. */
static void test_energy_beyond_its_format(void)
{
    model.motor_resistance = 4;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, search_within(JP_BUDGET_JOULES, JP_Q16(32000)));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, budget.best.energy);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, search_within(JP_BUDGET_JOULES, INT32_MAX));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, search_within(JP_BUDGET_SECONDS, JP_Q16(15)));
}

static void test_time_beyond_its_format(void)
{
    config.task.cruise = JP_Q24(0.01);
    targets[0].x = JP_Q16(400);
    targets[1] = (struct jp_point){JP_Q16(400), JP_Q16(400)};
    model.electronics_power = 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, search_within(JP_BUDGET_SECONDS, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, budget.best.seconds);
}
