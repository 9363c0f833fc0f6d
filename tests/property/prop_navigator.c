/*
 * The navigator in closed loop on dense maps on which not everything is that is in the world: it touches nothing, and
 * arrives if and only if the goal can be reached; with little memory it may say instead that it is too little.
 *
 * prop_navigator [--count N] [--seed S]
 */
#include "tests/support/navigate_trial.h"
#include "tests/support/options.h"

#define VIEW        25 /* cells */
#define SHORT_VIEW  10
#define AMPLE_BLOCK ((size_t)4 << 20)
#define SMALL_BLOCK ((size_t)80 << 10)

/** The bar of a forecast without learning. */
#define FORECAST_ERROR_MAX 0.1

static struct options options = {.count = 24, .seed = 70001};
static struct navigate_robot courier;
static struct navigate_robot burger;
static struct navigate_robot rover; /* on hills */

void setUp(void)
{
}

void tearDown(void)
{
}

static void complain(uint64_t seed, const struct navigate_trial *trial)
{
    (void)printf("seed %llu: %s, %s; reachable %d, touched %d, drift %.3f m\n", (unsigned long long)seed,
                 navigation_state_name(trial->result.state), navigation_reason_name(trial->result.reason),
                 trial->is_reachable, trial->result.is_touched, trial->result.drift_m);
}

static double metres_per_cell(const struct navigate_robot *robot)
{
    return round(robot->lattice->resolution / 65.536) / 1000;
}

/* Returns how often it was planned anew. */
static unsigned expect_right(const struct navigate_robot *robot, int view)
{
    const double view_m = view * metres_per_cell(robot);
    unsigned arrived = 0;
    unsigned replans = 0;
    unsigned wrong = 0;

    for (uint64_t seed = options.seed; seed < options.seed + options.count; seed++) {
        struct navigate_trial trial;

        TEST_ASSERT_TRUE(navigate_trial_run(&trial, robot, seed, view_m, AMPLE_BLOCK));
        arrived += trial.result.state == JP_NAVIGATOR_ARRIVED;
        replans += trial.result.replans;
        if (!trial.is_right) {
            complain(seed, &trial);
            wrong++;
        }
    }
    (void)printf("%lu drives from seed %llu, sight of %g m: %u arrived, planned anew %u times\n", options.count,
                 options.seed, view_m, arrived, replans);
    TEST_ASSERT_EQUAL_UINT(0, wrong);
    TEST_ASSERT_TRUE(arrived > 0);
    return replans;
}

static void test_arrives_and_touches_nothing(void)
{
    TEST_ASSERT_TRUE(expect_right(&courier, VIEW) > 0);
}

static void test_with_short_sight(void)
{
    TEST_ASSERT_TRUE(expect_right(&courier, SHORT_VIEW) > 0);
}

static void test_differential_drive(void)
{
    (void)expect_right(&burger, SHORT_VIEW);
}

/* By one course; it waits and plans besides. */
static double forecast_error(const struct navigate_trial *trial)
{
    return fabs(trial->result.joules / trial->result.forecast_joules - 1);
}

/* The forecast knows what the ground rises by: of learning there is none before the first leg. */
static void test_forecasts_over_hills(void)
{
    unsigned drives = 0;
    double sum = 0;

    for (uint64_t seed = options.seed; seed < options.seed + options.count; seed++) {
        struct navigate_trial trial;

        TEST_ASSERT_TRUE(navigate_trial_run(&trial, &rover, seed, VIEW * metres_per_cell(&rover), AMPLE_BLOCK));
        TEST_ASSERT_FALSE(trial.result.is_touched);
        if (trial.result.state == JP_NAVIGATOR_ARRIVED && trial.result.replans == 0 && trial.result.length_m > 1) {
            drives++;
            sum += forecast_error(&trial);
        }
    }
    (void)printf("%u drives by one course over hills: error of the forecast, mean %.2f %%\n", drives,
                 100 * sum / drives);
    TEST_ASSERT_TRUE(drives > 0 && sum < FORECAST_ERROR_MAX * drives);
}

static void test_with_little_memory(void)
{
    unsigned arrived = 0;

    for (uint64_t seed = options.seed; seed < options.seed + options.count; seed++) {
        struct navigate_trial trial;

        TEST_ASSERT_TRUE(navigate_trial_run(&trial, &courier, seed, VIEW * metres_per_cell(&courier), SMALL_BLOCK));
        if (!trial.is_right && trial.result.reason != JP_NAVIGATOR_MEMORY) {
            complain(seed, &trial);
            TEST_FAIL_MESSAGE("neither right nor short of memory");
        }
        TEST_ASSERT_FALSE(trial.result.is_touched);
        arrived += trial.result.state == JP_NAVIGATOR_ARRIVED;
    }
    TEST_ASSERT_TRUE(arrived > 0);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    UNITY_BEGIN();
    TEST_ASSERT_TRUE(navigate_robot_load(&courier, "courier24"));
    TEST_ASSERT_TRUE(navigate_robot_load(&burger, "burger"));
    TEST_ASSERT_TRUE(navigate_robot_load(&rover, "zhang2018"));
    run_tests();
    return UNITY_END();
}
