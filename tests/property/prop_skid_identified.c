/*
 * The identified energy models and what is learned with them against the plants of skid steer and differential drive:
 * random motions on slopes that no identification has seen, and plans of robots and on grounds that nobody has seen.
 *
 * prop_skid_identified [--count N] [--seed S] [--json FILE] [--verbose]
 * --count is the number of motions of each robot; a tenth of it are the robots. bench_skid_energy drives 500.
 */
#include <joulepath/tables.h>
#include <math.h>
#include <stdio.h>

#include "tests/support/check.h"
#include "tests/support/decimal.h"
#include "tests/support/options.h"
#include "tests/support/skid_trial.h"

enum { KINDS = 2, COUNT = 200 };

#define SETTLE_SECONDS 5.0
#define HOLD_SECONDS   2.0

/* Of what a motion takes, or a tenth of the mean where less. */
#define SMALL_SHARE 0.1
#define MOTION_BAR  0.03

/* Of plans, mean over few robots: the bars of the bench are 10 and 1.5 %. */
#define BEFORE_BAR 0.2
#define AFTER_BAR  0.02

static struct options options = {.count = COUNT, .seed = 77};
static struct skid_kind kinds[KINDS];
static double mean_error[KINDS];
static double worst_error[KINDS];

void setUp(void)
{
    kinds[0] = (struct skid_kind){.energy = &jp_skid_energy_zhang2018, .learning = &jp_skid_learning_zhang2018};
    kinds[1] = (struct skid_kind){.energy = &jp_skid_energy_burger, .learning = &jp_skid_learning_burger};
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/zhang2018.cfg", &kinds[0].model));
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/burger.cfg", &kinds[1].model));
}

void tearDown(void)
{
}

/* ---- Motions ---- */

/* What a motion took and what the model says, J. */
struct outcome {
    double driven;
    double expected;
};

static struct outcome drive_motion(const struct skid_kind *kind, struct random *random)
{
    const double degrees = random_uniform(random, 0, kind->model.limits.slope_deg);
    const struct skid_slope slope = skid_slope_towards(degrees, random_uniform(random, -M_PI, M_PI));
    const struct planar_pose pose = {0, 0, 0};
    struct skid_leg leg = skid_random_leg(&kind->model, random);
    struct skid_trial trial = {.is_sound = true};
    struct skid_trial_run run = {.kind = kind, .trial = &trial};
    struct skid_piece pieces[SKID_LEG_PIECES_MAX];

    run.ground = skid_ground_slope(&slope);
    skid_drive_start(&run.drive, &kind->model, &run.ground, &pose, 1);
    skid_route_start(&run.route, &kind->model, &run.ground, &pose);
    leg.seconds = SETTLE_SECONDS;
    (void)skid_trial_drive(&run, pieces, skid_route_add(&run.route, &leg, pieces));
    leg.seconds = HOLD_SECONDS;
    const size_t count = skid_route_add(&run.route, &leg, pieces);
    const struct jp_skid_drive expected = skid_trial_expected(&run, kind->energy, pieces, count);
    const double driven = skid_trial_drive(&run, pieces, count);

    TEST_ASSERT_TRUE(trial.is_sound && !run.drive.world.plant.tipped);
    return (struct outcome){driven, ldexp((double)expected.energy, kind->energy->unit_exponent - 16)};
}

static void check_motions(int number)
{
    static struct outcome outcomes[COUNT];
    const unsigned long count = options.count < COUNT ? options.count : COUNT;
    struct random random;
    double mean = 0;

    random_init(&random, options.seed);
    for (unsigned long i = 0; i < count; i++) {
        outcomes[i] = drive_motion(&kinds[number], &random);
        mean += outcomes[i].driven / (double)count;
    }
    for (unsigned long i = 0; i < count; i++) {
        const double error =
            fabs(outcomes[i].expected - outcomes[i].driven) / fmax(outcomes[i].driven, SMALL_SHARE * mean);
        mean_error[number] += error / (double)count;
        worst_error[number] = fmax(worst_error[number], error);
    }
    (void)printf("%s: %lu unseen motions: mean error %.2f %%, worst %.2f %%\n", kinds[number].model.name, count,
                 100 * mean_error[number], 100 * worst_error[number]);
    check_below(mean_error[number], MOTION_BAR, "unseen motions, mean error");
}

static void test_unseen_motions_of_zhang2018(void)
{
    check_motions(0);
}

static void test_unseen_motions_of_burger(void)
{
    check_motions(1);
}

/* ---- Plans ---- */

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

static void check_plans(const struct skid_kind *kind)
{
    const unsigned long robots = options.count / 10 + 1;
    double before = 0;
    double after = 0;
    unsigned long inside = 0;

    for (unsigned long i = 0; i < robots; i++) {
        struct skid_trial trial;
        skid_trial_make(kind, options.seed * 1000 + i, &trial);
        TEST_ASSERT_TRUE(trial.is_sound);
        if (options.verbose) {
            show(&trial);
        }
        before += fabs(trial.untaught.error) / (double)robots;
        after += fabs(trial.taught.error) / (double)robots;
        inside += fabs(trial.taught.error_deviations) <= SKID_TRIAL_INTERVAL;
    }
    (void)printf("%s: plans of %lu unseen robots: mean error %.2f %% before, %.2f %% after %d legs, %lu inside\n",
                 kind->model.name, robots, 100 * before, 100 * after, SKID_TRIAL_LESSONS, inside);
    check_below(before, BEFORE_BAR, "plans, mean error before learning");
    check_below(after, AFTER_BAR, "plans, mean error after learning");
    TEST_ASSERT_TRUE_MESSAGE(4 * inside >= 3 * robots, "forecasts are too sure");
}

static void test_plans_of_unseen_robots_like_zhang2018(void)
{
    check_plans(&kinds[0]);
}

static void test_plans_of_unseen_robots_like_burger(void)
{
    check_plans(&kinds[1]);
}

static void add_figures(json_t *figures)
{
    for (int number = 0; number < KINDS; number++) {
        figures_add(figures, "make figures", 100 * mean_error[number], "%", no_bar,
                    "identified energy model, %s, %lu unseen motions on slopes: error, mean", kinds[number].model.name,
                    options.count);
        figures_add(figures, "make figures", 100 * worst_error[number], "%", no_bar,
                    "identified energy model, %s, %lu unseen motions on slopes: error, worst", kinds[number].model.name,
                    options.count);
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
