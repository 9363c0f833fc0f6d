/* How well the energy of chained segments is forecast when the start of each is itself forecast, never measured:
 * forward and back for random durations, both definitions of energy; and forward for fixed durations, beside the
 * paper's formula. Driven on the simulated robots with the firmware's code. A segment in which a voltage was limited is
 * not counted: no linear model knows it. Prints figures as JSON, progress on stderr. */
#include <math.h>
#include <stdlib.h>

#include "sim/base/parallel.h"
#include "tests/bench/figures.h"
#include "tests/support/chain.h"

#define COMMAND "make figures"

enum {
    CHAINS = 100,
    CHAINS_OF_FIXED = 25,
    SEGMENTS = 40,
    SEED = 2002,
    FIXED_DURATIONS = 5,
};

/* Of a segment's energy, electronics included. */
#define MEAN_BAR       0.3 /* % */
#define PERCENTILE_BAR 2.0 /* % */
#define PERCENTILE     0.99

/* A robot that stood so long knows its gyro's bias and keeps it over power-off (hal/storage/parameters.h). */
static const double standing = 60; /* s */

static const double shortest = 0.5; /* s */
static const double longest = 12;   /* s */
static const double fixed_durations[FIXED_DURATIONS] = {10, 6, 4, 2.5, 1.5};

/** Without modes: the paper's formula, also below Ts. */
static const struct jp_horizon settled = {.duration_min = JP_Q16(0.5)};

struct chain {
    struct chain_record records[SEGMENTS];
    size_t driven;
};

struct campaign {
    const struct robot_entry *entry;
    struct robot_file file;
    struct chain_ranges ranges;
    bool bias_known;   /**< when switched on */
    int64_t gyro_bias; /**< 2⁻⁵⁶ turn/s */
    struct chain chains[CHAINS];
    size_t chain_count;
};

static void fail(const char *what)
{
    error_line("bench_horizon: %s", what);
    exit(1);
}

static void drive_chain(void *context, size_t index)
{
    struct campaign *campaign = context;
    struct chain *chain = &campaign->chains[index];
    struct random random;
    struct rig rig;

    if (!rig_init(&rig, campaign->entry, &campaign->file, 2 * (SEED + index))) {
        fail("the robot was refused");
    }
    jp_robot_know_gyro_bias(&rig.robot, campaign->bias_known ? campaign->gyro_bias : 0);
    random_init(&random, 2 * (SEED + index) + 1);
    chain_draw(chain->records, SEGMENTS, &campaign->file, &campaign->ranges, &random);
    chain->driven = chain_run(&rig, chain->records, SEGMENTS, NULL);
}

static int64_t learned_gyro_bias(const struct campaign *campaign)
{
    struct rig rig;

    if (!rig_init(&rig, campaign->entry, &campaign->file, SEED)) {
        fail("the robot was refused");
    }
    rig_release(&rig, 0);
    while ((double)rig.world.tick < standing * campaign->file.control.rate_hz) {
        rig_tick(&rig);
    }
    return rig.robot.internal.estimator.gyro_bias;
}

static void drive(struct campaign *campaign, size_t chains, double backward, double low, double high)
{
    campaign->chain_count = chains;
    campaign->ranges = (struct chain_ranges){.backward_share = backward,
                                             .speed_share = 1,
                                             .turn_rate_share = 1,
                                             .turn_share = 1,
                                             .shortest = low,
                                             .longest = high};
    in_parallel(campaign->file.name, drive_chain, campaign, chains);
}

/* ---- Errors ---- */

struct errors {
    double relative[CHAINS * SEGMENTS]; /* % */
    size_t count;
};

/** One definition of energy, and how it is forecast. */
struct forecast {
    enum energy_kind kind;
    const struct jp_energy_model *model;
    const struct jp_horizon *horizon;
};

static void add_chain(struct errors *errors, const struct forecast *forecast, const struct chain *chain, double rate_hz)
{
    struct jp_energy_start start = {.motion = {0, 0}};

    for (size_t i = 0; i < chain->driven && chain->records[i].end == CHAIN_DRIVEN; i++) {
        const struct chain_record *record = &chain->records[i];
        const double seconds = record->commanded_ticks / rate_hz;
        const struct jp_segment_command command = experiment_command(&record->command, seconds);
        const double measured = forecast->kind == ENERGY_BATTERY ? record->battery : record->model;
        jp_q16 energy;

        if (jp_energy_forecast(forecast->model, forecast->horizon, &start, &command, &energy, &start) != JP_OK) {
            fail("a forecast was refused");
        }
        if (record->saturated_ticks == 0) {
            errors->relative[errors->count++] = 100 * fabs((double)energy / JP_Q16_ONE / measured - 1);
        }
    }
}

static void collect(struct errors *errors, const struct campaign *campaign, const struct forecast *forecast)
{
    errors->count = 0;
    for (size_t i = 0; i < campaign->chain_count; i++) {
        add_chain(errors, forecast, &campaign->chains[i], campaign->file.control.rate_hz);
    }
}

static double mean(const struct errors *errors)
{
    double sum = 0;

    for (size_t i = 0; i < errors->count; i++) {
        sum += errors->relative[i];
    }
    return sum / (double)errors->count;
}

static int ascending(const void *a, const void *b)
{
    const double left = *(const double *)a;
    const double right = *(const double *)b;

    return (left > right) - (left < right);
}

/** The error that a share of all does not exceed; sorts them. */
static double percentile(struct errors *errors, double share)
{
    qsort(errors->relative, errors->count, sizeof errors->relative[0], ascending);
    return errors->relative[(size_t)ceil(share * (double)errors->count) - 1];
}

/* ---- Figures ---- */

static void add_definition(json_t *figures, const struct campaign *campaign, const struct forecast *forecast,
                           const char *title)
{
    static struct errors errors;
    const char *robot = campaign->entry->name;
    const bool known = campaign->bias_known;

    if (forecast->model == NULL || forecast->horizon == NULL) {
        fail("a robot has no table: run make identify and make horizon");
    }
    collect(&errors, campaign, forecast);
    figures_add(figures, COMMAND, mean(&errors), "%", known ? at_most(MEAN_BAR) : no_bar,
                "segments forward and back, %s, %s%s: mean error of %zu of %g…%g s", robot, title,
                known ? "" : ", gyro bias not known yet", errors.count, shortest, longest);
    figures_add(figures, COMMAND, percentile(&errors, PERCENTILE), "%", known ? at_most(PERCENTILE_BAR) : no_bar,
                "segments forward and back, %s, %s%s: error of 99 %% of them at most", robot, title,
                known ? "" : ", gyro bias not known yet");
}

static void bench_random(json_t *figures, struct campaign *campaign)
{
    const struct robot_entry *entry = campaign->entry;
    const struct forecast motors = {ENERGY_MOTOR, entry->energy, entry->horizon};
    const struct forecast battery = {ENERGY_BATTERY, entry->energy_battery, entry->horizon_battery};

    drive(campaign, CHAINS, 1, shortest, longest);
    add_definition(figures, campaign, &motors, "motors");
    add_definition(figures, campaign, &battery, "battery");
}

static void bench_fixed(json_t *figures, struct campaign *campaign, double seconds)
{
    const struct robot_entry *entry = campaign->entry;
    static struct errors errors;

    drive(campaign, CHAINS_OF_FIXED, 0, seconds, seconds);
    collect(&errors, campaign, &(struct forecast){ENERGY_MOTOR, entry->energy, entry->horizon});
    figures_add(figures, COMMAND, mean(&errors), "%", no_bar, "segments of %g s, %s: mean error", seconds, entry->name);
    collect(&errors, campaign, &(struct forecast){ENERGY_MOTOR, entry->energy, &settled});
    figures_add(figures, COMMAND, mean(&errors), "%", no_bar, "segments of %g s, %s: mean error of the paper's model",
                seconds, entry->name);
}

int main(void)
{
    static const char *const names[] = {"gao2018", "courier24"};
    static struct campaign campaign;
    json_t *figures = json_array();

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char path[64];

        (void)snprintf(path, sizeof path, "sim/robots/%s.cfg", names[i]);
        campaign.entry = rig_find_robot(names[i]);
        if (campaign.entry == NULL || !robot_file_load(path, &campaign.file)) {
            return ERROR_EXIT;
        }
        campaign.gyro_bias = learned_gyro_bias(&campaign);
        campaign.bias_known = false;
        if (campaign.file.gyro.bias_dps != 0) {
            bench_random(figures, &campaign);
        }
        campaign.bias_known = true;
        bench_random(figures, &campaign);
        for (int k = 0; k < FIXED_DURATIONS; k++) {
            bench_fixed(figures, &campaign, fixed_durations[k]);
        }
    }
    figures_print(figures);
    return 0;
}
