/*
 * Forecasts of plans of skid steer and differential drive against what they take, before and after 20 legs of learning,
 * over robots and grounds that nobody has seen.
 *
 * prop_skid_plans [--count N] [--seed S] [--json FILE] [--verbose]
 * --count is the number of robots of each kind, at most 1 000; the bars of the figures are those of 500.
 */
#include <joulepath/tables.h>
#include <math.h>
#include <stdio.h>

#include "sim/base/parallel.h"
#include "tests/bench/statistics.h"
#include "tests/support/check.h"
#include "tests/support/decimal.h"
#include "tests/support/options.h"
#include "tests/support/skid_trial.h"

enum { KINDS = 2, ROBOTS_MAX = 1000 };

/* Of the figures. */
#define BEFORE_BAR 10.0
#define AFTER_BAR  1.5
#define INSIDE_MIN 93.0
#define INSIDE_MAX 97.0

/* Of few robots, as the suite drives them: shares of the energy, and of the robots. */
#define FEW_BEFORE 0.3
#define FEW_AFTER  0.03
#define FEW_INSIDE 0.5

static struct options options = {.count = 6, .seed = 2019};
static struct skid_kind kinds[KINDS];
static struct skid_trial trials[KINDS][ROBOTS_MAX];
static size_t robots;

void setUp(void)
{
    kinds[0] = (struct skid_kind){.energy = &jp_skid_energy_zhang2018, .learning = &jp_skid_learning_zhang2018};
    kinds[1] = (struct skid_kind){.energy = &jp_skid_energy_burger, .learning = &jp_skid_learning_burger};
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/zhang2018.cfg", &kinds[0].model));
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/burger.cfg", &kinds[1].model));
    robots = options.count < ROBOTS_MAX ? options.count : ROBOTS_MAX;
}

void tearDown(void)
{
}

static void make_trial(void *context, size_t index)
{
    const size_t kind = (size_t)((const struct skid_kind *)context - kinds);

    skid_trial_make(context, options.seed * 10000 + index, &trials[kind][index]);
}

static void show(const struct skid_trial *trial)
{
    const struct skid_variation *is = &trial->variation;

    (void)printf(
        "rolling %.3f is %.3f, friction %.3f is %.3f, weight %.3f is %.3f, electronics %.3f is %.3f, resistance "
        "%.3f: %+.2f %% before, %+.2f %% after (%+.2f deviations), %.2f m astray, %u changes\n",
        q16(trial->factor[JP_SKID_ROLLING]), is->rolling, q16(trial->factor[JP_SKID_FRICTION]), is->friction,
        q16(trial->factor[JP_SKID_WEIGHT]), is->mass, q16(trial->factor[JP_SKID_ELECTRONICS]), is->electronics,
        is->resistance, 100 * trial->untaught.error, 100 * trial->taught.error, trial->taught.error_deviations,
        trial->astray, (unsigned)trial->changes);
}

static struct skid_forecast forecast_of(const struct skid_trial *trial, bool is_taught)
{
    return is_taught ? trial->taught : trial->untaught;
}

/* Mean or worst over the robots. */
static double error_of(int kind, bool is_taught, bool is_worst)
{
    static double errors[ROBOTS_MAX];

    for (size_t i = 0; i < robots; i++) {
        errors[i] = fabs(forecast_of(&trials[kind][i], is_taught).error);
    }
    return is_worst ? greatest(errors, robots) : mean(errors, robots);
}

/* What is left of the error before learning with the best factor for all: how unlike the robots are. */
static double unlikeness(int kind)
{
    double least = INFINITY;

    for (int percent = 50; percent <= 200; percent++) {
        double sum = 0;
        for (size_t i = 0; i < robots; i++) {
            sum += fabs(percent / 100.0 * (1 + trials[kind][i].untaught.error) - 1);
        }
        least = fmin(least, sum / (double)robots);
    }
    return least;
}

/* Share of the robots whose plan is inside its interval. */
static double inside(int kind, bool is_taught)
{
    double count = 0;

    for (size_t i = 0; i < robots; i++) {
        count += fabs(forecast_of(&trials[kind][i], is_taught).error_deviations) <= SKID_TRIAL_INTERVAL;
    }
    return count / (double)robots;
}

static void check_plans(int kind)
{
    in_parallel(kinds[kind].model.name, make_trial, &kinds[kind], robots);
    for (size_t i = 0; i < robots; i++) {
        TEST_ASSERT_TRUE_MESSAGE(trials[kind][i].is_sound, "tipped, or refused by the core");
        if (options.verbose) {
            show(&trials[kind][i]);
        }
    }
    (void)printf(
        "%s: plans of %zu unseen robots: mean error %.2f %% before, of which the robots are unlike by %.2f %%; %.3f %% "
        "after %d legs, worst %.2f %%, inside the 95 %% interval %.1f %% before, %.1f %% after\n",
        kinds[kind].model.name, robots, 100 * error_of(kind, false, false), 100 * unlikeness(kind),
        100 * error_of(kind, true, false), SKID_TRIAL_LESSONS, 100 * error_of(kind, true, true),
        100 * inside(kind, false), 100 * inside(kind, true));
    check_below(error_of(kind, false, false), FEW_BEFORE, "plans, mean error before learning");
    check_below(error_of(kind, true, false), FEW_AFTER, "plans, mean error after learning");
    check_below(FEW_INSIDE, inside(kind, true), "plans outside of their intervals");
}

static void test_plans_of_unseen_robots_like_zhang2018(void)
{
    check_plans(0);
}

static void test_plans_of_unseen_robots_like_burger(void)
{
    check_plans(1);
}

static void add_figures(json_t *figures)
{
    for (int kind = 0; kind < KINDS; kind++) {
        const char *robot = kinds[kind].model.name;
        figures_add(figures, "make figures", 100 * error_of(kind, false, false), "%", at_most(BEFORE_BAR),
                    "forecast of a plan, %s, %zu unseen robots and grounds: error before learning, mean", robot,
                    robots);
        figures_add(figures, "make figures", 100 * unlikeness(kind), "%", no_bar,
                    "forecast of a plan, %s, %zu unseen robots and grounds: the same with the best factor for all",
                    robot, robots);
        figures_add(figures, "make figures", 100 * error_of(kind, true, false), "%", at_most(AFTER_BAR),
                    "forecast of a plan, %s, %zu unseen robots and grounds: error after %d legs, mean", robot, robots,
                    SKID_TRIAL_LESSONS);
        figures_add(figures, "make figures", 100 * error_of(kind, true, true), "%", no_bar,
                    "forecast of a plan, %s, %zu unseen robots and grounds: error after %d legs, worst", robot, robots,
                    SKID_TRIAL_LESSONS);
        figures_add(figures, "make figures", 100 * inside(kind, true), "%", at_least(INSIDE_MIN),
                    "forecast of a plan, %s, %zu unseen robots and grounds: inside the 95 %% interval", robot, robots);
        figures_add(figures, "make figures", 100 * inside(kind, true), "%", at_most(INSIDE_MAX),
                    "forecast of a plan, %s, %zu unseen robots and grounds: the same, not too many", robot, robots);
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
