/* Forecasts of plans against what they take, before and after 20 legs of learning, over robots and grounds that nobody
 * has seen. */
#include <joulepath/tables.h>
#include <math.h>

#include "tests/bench/figures.h"
#include "tests/bench/parallel.h"
#include "tests/bench/statistics.h"
#include "tests/support/skid_trial.h"

#define COMMAND "make figures"

#define ROBOTS 500
#define SEED   20190000U

#define BEFORE_BAR 10.0
#define AFTER_BAR  1.5
#define INSIDE_MIN 93.0
#define INSIDE_MAX 97.0

struct bench {
    struct skid_kind kind;
    struct skid_trial trials[ROBOTS];
};

static void drive_one(void *context, size_t index)
{
    struct bench *bench = context;

    skid_trial_make(&bench->kind, SEED + index, &bench->trials[index]);
}

static struct skid_forecast of(const struct skid_trial *trial, bool is_taught)
{
    return is_taught ? trial->taught : trial->untaught;
}

/* %, mean or worst over the robots. */
static double error_of(const struct bench *bench, bool is_taught, bool is_worst)
{
    double errors[ROBOTS];

    for (size_t i = 0; i < ROBOTS; i++) {
        errors[i] = 100 * fabs(of(&bench->trials[i], is_taught).error);
    }
    return is_worst ? greatest(errors, ROBOTS) : mean(errors, ROBOTS);
}

/* % of the robots whose plan is inside its interval. */
static double inside(const struct bench *bench, bool is_taught)
{
    double count = 0;

    for (size_t i = 0; i < ROBOTS; i++) {
        count += fabs(of(&bench->trials[i], is_taught).error_deviations) <= SKID_TRIAL_INTERVAL;
    }
    return 100 * count / ROBOTS;
}

static double unsound(const struct bench *bench)
{
    double count = 0;

    for (size_t i = 0; i < ROBOTS; i++) {
        count += !bench->trials[i].is_sound;
    }
    return count;
}

static void add_figures(json_t *figures, const struct bench *bench)
{
    const char *robot = bench->kind.model.name;

    figures_add(figures, COMMAND, error_of(bench, false, false), "%", at_most(BEFORE_BAR),
                "forecast of a plan, %s, %d unseen robots and grounds: error before learning, mean", robot, ROBOTS);
    figures_add(figures, COMMAND, error_of(bench, true, false), "%", at_most(AFTER_BAR),
                "forecast of a plan, %s, %d unseen robots and grounds: error after %d legs, mean", robot, ROBOTS,
                SKID_TRIAL_LESSONS);
    figures_add(figures, COMMAND, error_of(bench, true, true), "%", no_bar,
                "forecast of a plan, %s, %d unseen robots and grounds: error after %d legs, worst", robot, ROBOTS,
                SKID_TRIAL_LESSONS);
    figures_add(figures, COMMAND, inside(bench, false), "%", no_bar,
                "forecast of a plan, %s, %d unseen robots and grounds: inside the 95 %% interval before learning",
                robot, ROBOTS);
    figures_add(figures, COMMAND, inside(bench, true), "%", at_least(INSIDE_MIN),
                "forecast of a plan, %s, %d unseen robots and grounds: inside the 95 %% interval after %d legs", robot,
                ROBOTS, SKID_TRIAL_LESSONS);
    figures_add(figures, COMMAND, inside(bench, true), "%", at_most(INSIDE_MAX),
                "forecast of a plan, %s, %d unseen robots and grounds: the same, not too many", robot, ROBOTS);
    figures_add(figures, COMMAND, unsound(bench), "", equal_to(0),
                "forecast of a plan, %s, %d unseen robots and grounds: tipped, or refused by the core", robot, ROBOTS);
}

int main(void)
{
    static const struct {
        const char *path;
        const struct jp_skid_energy_model *energy;
        const struct jp_skid_learning *learning;
    } kinds[] = {{"sim/robots/zhang2018.cfg", &jp_skid_energy_zhang2018, &jp_skid_learning_zhang2018},
                 {"sim/robots/burger.cfg", &jp_skid_energy_burger, &jp_skid_learning_burger}};
    static struct bench bench;
    json_t *figures = json_array();

    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        bench.kind = (struct skid_kind){.energy = kinds[i].energy, .learning = kinds[i].learning};
        if (!skid_robot_load(kinds[i].path, &bench.kind.model)) {
            return 1;
        }
        in_parallel(bench.kind.model.name, drive_one, &bench, ROBOTS);
        add_figures(figures, &bench);
    }
    figures_print(figures);
    return 0;
}
