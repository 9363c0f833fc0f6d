/*
 * The identified energy models against the plants of skid steer and differential drive: random motions on slopes that
 * no identification has seen.
 *
 * prop_skid_identified [--count N] [--seed S] [--json FILE]
 * --count is the number of motions of each robot, at most 200.
 */
#include <joulepath/tables.h>
#include <math.h>
#include <stdio.h>

#include "tests/support/check.h"
#include "tests/support/options.h"
#include "tests/support/skid_trial.h"

enum { KINDS = 2, COUNT_MAX = 200 };

#define SETTLE_SECONDS 5.0
#define HOLD_SECONDS   2.0

/* Of what a motion takes, or a tenth of the mean where less. */
#define SMALL_SHARE 0.1
#define MOTION_BAR  0.03

static struct options options = {.count = 60, .seed = 77};
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

/* What a motion took and what the model says, J. */
struct outcome {
    double driven;
    double expected;
};

static double add_leg(struct skid_trial_run *run, const struct skid_leg *leg, struct jp_skid_drive *expected)
{
    struct skid_piece pieces[SKID_LEG_PIECES_MAX];
    const size_t count = skid_route_add(&run->route, leg, pieces);

    skid_trial_expect(run, run->kind->energy, pieces, count, expected);
    return skid_trial_drive(run, pieces, count);
}

/* Before and after a turn on the spot the robot drives: what it slid downhill it climbs then. */
static struct outcome drive_motion(const struct skid_kind *kind, struct random *random)
{
    const double degrees = random_uniform(random, 0, kind->model.limits.slope_deg);
    const struct skid_slope slope = skid_slope_towards(degrees, random_uniform(random, -M_PI, M_PI));
    const struct planar_pose pose = {0, 0, 0};
    struct skid_leg leg = skid_random_leg(&kind->model, random);
    struct skid_trial trial = {.is_sound = true};
    struct skid_trial_run run = {.kind = kind, .trial = &trial};
    struct jp_skid_drive before = {.energy = 0};
    struct jp_skid_drive expected = {.energy = 0};
    double driven = 0;
    struct skid_leg settle = leg;

    run.ground = skid_ground_slope(&slope);
    skid_drive_start(&run.drive, &kind->model, &run.ground, &pose, 1);
    skid_route_start(&run.route, &kind->model, &run.ground, &pose);
    while (settle.speed == 0) {
        settle = skid_random_leg(&kind->model, random);
    }
    settle.seconds = SETTLE_SECONDS;
    (void)add_leg(&run, &settle, &before);
    leg.seconds = HOLD_SECONDS;
    driven = add_leg(&run, &leg, &expected);
    if (leg.speed == 0) {
        driven += add_leg(&run, &settle, &expected);
    }
    TEST_ASSERT_TRUE(trial.is_sound && !run.drive.world.plant.tipped);
    return (struct outcome){driven, ldexp((double)expected.energy, kind->energy->unit_exponent - 16)};
}

static void check_motions(int number)
{
    static struct outcome outcomes[COUNT_MAX];
    const unsigned long count = options.count < COUNT_MAX ? options.count : COUNT_MAX;
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
