/*
 * The patrol robot's forecasts against what it drives: to and fro between two places of a warehouse with pallets that
 * the map does not show. It learns on 20 legs; what the legs of the next 10 minutes take is then forecast, and driven.
 *
 * prop_patrol_energy [--count N] [--seed S] [--json FILE]
 * --count is the number of warehouses.
 */
#include <math.h>
#include <stdio.h>

#include "sim/missions/patrol_mission.h"
#include "tests/support/check.h"
#include "tests/support/options.h"

#define LESSONS      20
#define PATROL_S     600.0
#define LEGS_MAX     120
#define LIMIT_S      3600.0
#define FORECAST_BAR 0.015

static struct options options = {.count = 2, .seed = 1001};
static struct four_wheel_file robot;

/* Legs after the lessons. */
struct round {
    size_t legs;
    double seconds;
    double planned;
    double forecast;
    double driven;
};

static double mean_missed;
static double worst_missed;
static double mean_planned;

void setUp(void)
{
    TEST_ASSERT_TRUE(four_wheel_file_load("sim/robots/patrol.cfg", &robot));
}

void tearDown(void)
{
}

static void keep(void *context, const struct patrol_leg *leg)
{
    struct round *const round = context;

    round->legs++;
    if (round->legs > LESSONS && round->seconds < PATROL_S) {
        round->seconds += leg->seconds;
        round->planned += leg->planned;
        round->forecast += leg->forecast;
        round->driven += leg->driven;
    }
}

static struct round drive(uint64_t seed)
{
    struct round round = {0};
    struct patrol_scene scene;
    struct patrol_result result;

    patrol_scene_make(PATROL_WAREHOUSE, seed, &scene);
    scene.limit_s = LIMIT_S;
    const struct jp_plane_pose places[] = {scene.start, scene.goal};
    const struct patrol_task task = {.robot = &robot,
                                     .scene = &scene,
                                     .method = PATROL_IMPROVED,
                                     .seed = seed,
                                     .faults = {.jump_at = -1},
                                     .round = places,
                                     .round_count = 2,
                                     .legs_learned = LESSONS,
                                     .legs_max = LEGS_MAX,
                                     .keep_leg = keep,
                                     .context = &round};

    TEST_ASSERT_TRUE(patrol_mission_run(&task, &result));
    patrol_scene_free(&scene);
    return round;
}

static void test_ten_minutes_are_forecast(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        const struct round round = drive(options.seed + i);
        const double missed = fabs(round.forecast / round.driven - 1);

        TEST_ASSERT_TRUE_MESSAGE(round.seconds >= PATROL_S, "the patrol came to no end");
        mean_missed += missed / (double)options.count;
        mean_planned += fabs(round.planned / round.driven - 1) / (double)options.count;
        worst_missed = fmax(worst_missed, missed);
        (void)printf("warehouse %llu: %.0f s: planned %.0f J, forecast %.0f J, driven %.0f J: missed by %.2f %%\n",
                     (unsigned long long)options.seed + i, round.seconds, round.planned, round.forecast, round.driven,
                     100 * missed);
    }
    check_below(mean_missed, FORECAST_BAR, "10 minutes, forecast after 20 legs, mean error");
}

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", 100 * mean_planned, "%", no_bar,
                "patrol robot, 10 minutes in %lu warehouses: error of the plan, mean", options.count);
    figures_add(figures, "make figures", 100 * mean_missed, "%", at_most(100 * FORECAST_BAR),
                "patrol robot, 10 minutes in %lu warehouses: error of the forecast after 20 legs, mean", options.count);
    figures_add(figures, "make figures", 100 * worst_missed, "%", no_bar,
                "patrol robot, 10 minutes in %lu warehouses: error of the forecast after 20 legs, worst",
                options.count);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
