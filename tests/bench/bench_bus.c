/* Random missions over a faulty bus, many at once in this process, or a few against an ECU elsewhere:
 *
 *   bench_bus                      the campaign: 10 000 missions; figures as JSON, tables on stderr
 *   bench_bus --bus can:vcan0      50 of them on that bus, in lockstep with jp-ecu --robot courier24, compared bit for
 * bit
 *
 * --count N and --seed S choose others. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/linux/can_open.h"
#include "sim/balancer/rig.h"
#include "sim/base/parallel.h"
#include "sim/base/progress.h"
#include "tests/bench/figures.h"
#include "tests/support/bus_trial.h"

#define ROBOT_NAME "courier24"
#define ROBOT_FILE "sim/robots/courier24.cfg"

#define CAMPAIGN 10000U
#define SAMPLE   50U

struct campaign {
    const struct robot_entry *entry;
    struct robot_file file;
    struct bus_trial *trials;
    size_t count;
};

static void fail(const char *what)
{
    (void)fprintf(stderr, "bench_bus: %s\n", what);
    exit(2);
}

static bool is_good(const struct bus_trial *trial)
{
    return trial->end == BUS_TRIAL_DONE || trial->excused;
}

/* Driving them. */

static void run_trial(void *context, size_t index)
{
    struct campaign *campaign = context;

    if (!bus_trial_run(&campaign->trials[index], campaign->entry, &campaign->file)) {
        exit(2);
    }
}

/** Returns how many runs on the bus were the same to the bit as in this process. */
static size_t run_on_bus(struct campaign *campaign, const char *name)
{
    struct jp_can_link link;
    char error[256];
    size_t equal = 0;

    if (!jp_can_link_open(&link, name, error, sizeof error)) {
        fail(error);
    }
    for (size_t i = 0; i < campaign->count; i++) {
        struct bus_trial here = campaign->trials[i];

        if (!bus_trial_run(&here, campaign->entry, &campaign->file)) {
            exit(2);
        }
        bus_trial_run_on(&campaign->trials[i], &campaign->file, &link);
        campaign->trials[i].excused = here.excused && campaign->trials[i].end == here.end;
        equal += campaign->trials[i].fingerprint == here.fingerprint ? 1 : 0;
        progress_show(name, i + 1, campaign->count);
    }
    progress_end();
    link.close(link.port.context);
    return equal;
}

/* The tables. */

static void print_bad(const struct bus_trial *trial)
{
    (void)fprintf(stderr, "seed %" PRIu64 ": %s, %.1f s, faults %#x:", trial->seed, bus_trial_end_name(trial->end),
                  trial->ticks / 1000.0, trial->robot_faults);
    for (size_t i = 0; i < trial->fault_count; i++) {
        (void)fprintf(stderr, " %s %" PRIu64 "-%" PRIu64, bus_fault_name(trial->faults[i].kind), trial->faults[i].from,
                      trial->faults[i].until);
    }
    (void)fprintf(stderr, "\n");
}

static bool has(const struct bus_trial *trial, enum bus_fault_kind kind)
{
    for (size_t i = 0; i < trial->fault_count; i++) {
        if (trial->faults[i].kind == kind) {
            return true;
        }
    }
    return false;
}

static void print_kind(const struct campaign *campaign, enum bus_fault_kind kind)
{
    size_t alone = 0;
    size_t combined = 0;
    size_t excused = 0;
    size_t bad = 0;
    double pitch = 0;

    for (size_t i = 0; i < campaign->count; i++) {
        const struct bus_trial *trial = &campaign->trials[i];

        if (!has(trial, kind)) {
            continue;
        }
        alone += trial->fault_count == 1;
        combined += trial->fault_count > 1;
        excused += trial->excused;
        bad += !is_good(trial);
        if (!trial->excused && trial->peak_pitch_deg > pitch) {
            pitch = trial->peak_pitch_deg;
        }
    }
    if (alone + combined == 0) {
        return;
    }
    (void)fprintf(stderr, "%-16s %8zu %9zu %12zu %8zu %12.1f\n", bus_fault_name(kind), alone, combined, excused, bad,
                  pitch);
}

static void print_tables(const struct campaign *campaign)
{
    (void)fprintf(stderr, "%-16s %8s %9s %12s %8s %12s\n", "fault", "alone", "combined", "sensor fell", "bad",
                  "peak pitch, °");
    for (int kind = 0; kind < BUS_FAULT_KINDS; kind++) {
        print_kind(campaign, (enum bus_fault_kind)kind);
    }
    for (size_t i = 0; i < campaign->count; i++) {
        if (!is_good(&campaign->trials[i])) {
            print_bad(&campaign->trials[i]);
        }
    }
}

/* The figures. */

static size_t count_end(const struct campaign *campaign, enum bus_trial_end end)
{
    size_t count = 0;

    for (size_t i = 0; i < campaign->count; i++) {
        count += campaign->trials[i].end == end && !campaign->trials[i].excused;
    }
    return count;
}

static void campaign_figures(const struct campaign *campaign)
{
    static const char command[] = "build/bench/bench_bus";
    json_t *figures = json_array();
    double seconds = 0;
    double metres = 0;
    size_t excused = 0;

    for (size_t i = 0; i < campaign->count; i++) {
        const struct bus_trial *trial = &campaign->trials[i];

        seconds = trial->stop_seconds > seconds ? trial->stop_seconds : seconds;
        metres = trial->stop_metres > metres ? trial->stop_metres : metres;
        excused += trial->excused;
    }
    figures_add(figures, command, (double)campaign->count, "", at_least(CAMPAIGN),
                "faulty bus: random missions, in process");
    figures_add(figures, command, (double)count_end(campaign, BUS_TRIAL_FELL), "", equal_to(0),
                "faulty bus: falls that the sensors' faults alone do not make");
    figures_add(figures, command, (double)excused, "", no_bar, "faulty bus: missions that a frozen sensor alone ends");
    figures_add(figures, command, (double)count_end(campaign, BUS_TRIAL_MOVED), "", equal_to(0),
                "faulty bus: missions with motion but without a command");
    figures_add(figures, command, (double)count_end(campaign, BUS_TRIAL_ASTRAY), "", equal_to(0),
                "faulty bus: ended elsewhere than commanded");
    figures_add(figures, command, (double)count_end(campaign, BUS_TRIAL_LATE), "", equal_to(0),
                "faulty bus: not finished once the bus was well");
    figures_add(figures, command, seconds, "s", at_most(BUS_TRIAL_STOP_MAX),
                "faulty bus: longest stop, from the last command to the stand");
    figures_add(figures, command, metres, "m", no_bar, "faulty bus: way of the longest stop");
    figures_print(figures);
}

static void sample_figures(const struct campaign *campaign, size_t equal)
{
    static const char command[] = "make figures";
    json_t *figures = json_array();
    size_t good = 0;

    for (size_t i = 0; i < campaign->count; i++) {
        good += is_good(&campaign->trials[i]);
    }
    figures_add(figures, command, (double)good, "", equal_to((double)campaign->count),
                "faulty bus over vcan: random missions well ended");
    figures_add(figures, command, (double)equal, "", equal_to((double)campaign->count),
                "faulty bus over vcan: the same bits as in process");
    figures_print(figures);
}

/* The command line. */

struct options {
    const char *bus;
    size_t count;
    uint64_t seed;
};

static struct options parse(int argc, char **argv)
{
    struct options options = {.seed = 1};

    for (int i = 1; i + 1 < argc; i += 2) {
        if (strcmp(argv[i], "--bus") == 0) {
            options.bus = argv[i + 1];
        } else if (strcmp(argv[i], "--count") == 0) {
            options.count = strtoul(argv[i + 1], NULL, 10);
        } else if (strcmp(argv[i], "--seed") == 0) {
            options.seed = strtoul(argv[i + 1], NULL, 10);
        } else {
            fail("usage: bench_bus [--bus BUS] [--count N] [--seed S]");
        }
    }
    if (argc % 2 == 0) {
        fail("usage: bench_bus [--bus BUS] [--count N] [--seed S]");
    }
    if (options.count == 0) {
        options.count = options.bus == NULL ? CAMPAIGN : SAMPLE;
    }
    return options;
}

int main(int argc, char **argv)
{
    static struct campaign campaign;
    const struct options options = parse(argc, argv);

    campaign.entry = rig_find_robot(ROBOT_NAME);
    campaign.count = options.count;
    campaign.trials = calloc(options.count, sizeof *campaign.trials);
    if (campaign.entry == NULL || campaign.trials == NULL || !robot_file_load(ROBOT_FILE, &campaign.file)) {
        fail("no robot, or no memory");
    }
    for (size_t i = 0; i < campaign.count; i++) {
        bus_trial_draw(&campaign.trials[i], options.seed + i);
    }
    if (options.bus == NULL) {
        in_parallel("faulty bus", run_trial, &campaign, campaign.count);
        campaign_figures(&campaign);
    } else {
        sample_figures(&campaign, run_on_bus(&campaign, options.bus));
    }
    print_tables(&campaign);
    free(campaign.trials);
    return EXIT_SUCCESS;
}
