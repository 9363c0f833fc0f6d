/* Routes of short segments, driven on the plant: cruise and transients against straight chords, Bézier curves
 * and segments planned one after the other; the scenario of each robot, then random variants of it. Prints figures as
 * JSON, progress on stderr. */
#include <math.h>

#include "sim/base/parallel.h"
#include "sim/base/random.h"
#include "sim/missions/mission.h"
#include "tests/bench/figures.h"

#define COMMAND "make figures"

/* Of the variants: legs, m, and turns from leg to leg, rad, up to the sharpest of the scenario. */
#define VARIANTS     100
#define VARIANT_SEED 1
#define LEG_MIN      1.0
#define LEG_MAX      1.8
#define TURN_MAX     (M_PI / 2)

static void fail(const char *what)
{
    error_line("bench_short: %s", what);
    exit(1);
}

/* One route by every strategy. */

struct comparison {
    struct mission missions[MISSION_STRATEGIES];
};

static void drive(struct comparison *comparison, const struct scenario *scenario)
{
    for (int i = 0; i < MISSION_STRATEGIES; i++) {
        if (!mission_run(&comparison->missions[i], (enum mission_strategy)i, scenario, comparison->missions, NULL)) {
            mission_complain(&comparison->missions[i], scenario);
            fail(scenario->name);
        }
    }
}

static double energy(const struct comparison *comparison, enum mission_strategy strategy)
{
    return comparison->missions[strategy].total.measured_energy;
}

static double relative_percent(const struct comparison *comparison, enum mission_strategy strategy)
{
    return 100 * energy(comparison, strategy) / energy(comparison, MISSION_CRUISE);
}

/* What the robot said of the whole route before it started. */
static double forecast_error_percent(const struct comparison *comparison)
{
    return 100 * (comparison->missions[MISSION_CRUISE].forecast.energy / energy(comparison, MISSION_CRUISE) - 1);
}

/* The strategies that cruise and transients are compared with; the paper's figure is the bar of its robot in its
 * scenario.
 */
static const struct rival {
    enum mission_strategy strategy;
    const char *name;
    double paper; /* %; 0: it has none */
} rivals[] = {
    {MISSION_STRAIGHT_CRUISE, "straight chords", 102},
    {MISSION_BEZIER, "Bézier curve by curve", 107},
    {MISSION_BEZIER_ROUTE, "Bézier, whole route at once", 0},
    {MISSION_OPTIMAL, "optimal segments one after the other", 0},
};
#define RIVALS (sizeof rivals / sizeof rivals[0])

/* The scenario. */

static void print_against(json_t *figures, const struct comparison *comparison, const char *robot,
                          const struct rival *rival, bool is_paper)
{
    const double relative = relative_percent(comparison, rival->strategy);

    if (is_paper && rival->paper > 0) {
        figures_add(figures, COMMAND, relative, "%", at_least(rival->paper),
                    "short segments of %s, %s: relative to ours (paper: %g %%)", robot, rival->name, rival->paper);
    } else {
        figures_add(figures, COMMAND, relative, "%", no_bar, "short segments of %s, %s: relative to ours", robot,
                    rival->name);
    }
    figures_add(figures, COMMAND, comparison->missions[rival->strategy].total.duration, "s", no_bar,
                "short segments of %s, %s: time", robot, rival->name);
}

static void bench_scenario(json_t *figures, const struct scenario *scenario, bool is_paper)
{
    const char *robot = scenario->robot.name;
    struct comparison comparison;
    const struct mission *ours = &comparison.missions[MISSION_CRUISE];

    drive(&comparison, scenario);
    for (size_t i = 0; i < RIVALS; i++) {
        print_against(figures, &comparison, robot, &rivals[i], is_paper);
    }
    figures_add(figures, COMMAND, ours->total.measured_energy, "J", no_bar,
                "short segments of %s, cruise and transients: energy driven%s", robot,
                is_paper ? " (paper: 220.64 J)" : "");
    figures_add(figures, COMMAND, ours->total.duration, "s", no_bar,
                "short segments of %s, cruise and transients: time%s", robot, is_paper ? " (paper: 18.6 s)" : "");
    figures_add(figures, COMMAND, forecast_error_percent(&comparison), "%", no_bar,
                "short segments of %s, forecast before the start against what was driven", robot);
}

/* Variants. */

struct variants {
    const struct scenario *scenario;
    struct comparison all[VARIANTS];
};

static void draw(struct scenario *scenario, uint64_t seed)
{
    struct random random;
    double heading = 0;

    random_init(&random, seed);
    for (size_t i = 1; i < scenario->waypoint_count; i++) {
        const double length = random_uniform(&random, LEG_MIN, LEG_MAX);
        const struct bezier_point *before = &scenario->waypoints[i - 1];

        heading += random_uniform(&random, -TURN_MAX, TURN_MAX);
        scenario->waypoints[i] =
            (struct bezier_point){before->x + length * cos(heading), before->y + length * sin(heading)};
    }
}

static void drive_variant(void *context, size_t index)
{
    struct variants *variants = context;
    struct scenario scenario = *variants->scenario;

    draw(&scenario, VARIANT_SEED + index);
    drive(&variants->all[index], &scenario);
}

static void print_rival(json_t *figures, const struct variants *variants, const struct rival *rival)
{
    const char *robot = variants->scenario->robot.name;
    double sum = 0;
    unsigned more = 0;

    for (size_t i = 0; i < VARIANTS; i++) {
        const double relative = relative_percent(&variants->all[i], rival->strategy);

        sum += relative;
        more += relative > 100 ? 1 : 0;
    }
    figures_add(figures, COMMAND, sum / VARIANTS, "%", no_bar,
                "short segments of %s, mean of %d random routes, %s: relative to ours", robot, VARIANTS, rival->name);
    figures_add(figures, COMMAND, more, "", no_bar, "short segments of %s, of %d random routes, %s: more than ours",
                robot, VARIANTS, rival->name);
}

static void print_forecasts(json_t *figures, const struct variants *variants)
{
    double sum = 0;
    double worst = 0;

    for (size_t i = 0; i < VARIANTS; i++) {
        const double error = fabs(forecast_error_percent(&variants->all[i]));

        sum += error;
        worst = fmax(worst, error);
    }
    figures_add(figures, COMMAND, sum / VARIANTS, "%", no_bar,
                "short segments of %s, forecast before the start against what was driven, mean of %d random routes",
                variants->scenario->robot.name, VARIANTS);
    figures_add(figures, COMMAND, worst, "%", no_bar,
                "short segments of %s, forecast before the start against what was driven, worst of %d random routes",
                variants->scenario->robot.name, VARIANTS);
}

static void bench_variants(json_t *figures, const struct scenario *scenario)
{
    static struct variants variants;

    variants.scenario = scenario;
    in_parallel(scenario->name, drive_variant, &variants, VARIANTS);
    for (size_t i = 0; i < RIVALS; i++) {
        print_rival(figures, &variants, &rivals[i]);
    }
    print_forecasts(figures, &variants);
}

int main(void)
{
    static const struct {
        const char *path;
        bool is_paper;
    } scenarios[] = {{"sim/scenarios/gao2018_short.cfg", true}, {"sim/scenarios/courier24_short.cfg", false}};
    json_t *figures = json_array();

    for (size_t i = 0; i < sizeof scenarios / sizeof scenarios[0]; i++) {
        struct scenario scenario;

        if (!scenario_load(scenarios[i].path, &scenario)) {
            return 1;
        }
        bench_scenario(figures, &scenario, scenarios[i].is_paper);
        bench_variants(figures, &scenario);
    }
    figures_print(figures);
    return 0;
}
