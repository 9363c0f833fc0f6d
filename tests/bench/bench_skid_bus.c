/* Random missions of robots that their sides steer, over a faulty bus, with sensors and bodies that fail: figures as
 * JSON, tables on stderr.
 *
 *   bench_skid_bus [--count N] [--seed S]    10 000 missions, half of zhang2018 and half of burger */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/fault_names.h"
#include "sim/base/parallel.h"
#include "tests/bench/figures.h"
#include "tests/support/skid_bus_trial.h"

#define CAMPAIGN 10000U
#define ROBOTS   2U

struct campaign {
    struct skid_steer_model models[ROBOTS];
    struct skid_bus_trial *trials;
    size_t count;
};

static const char *const names[ROBOTS] = {"zhang2018", "burger"};

static void fail(const char *what)
{
    (void)fprintf(stderr, "bench_skid_bus: %s\n", what);
    exit(2);
}

static void run_trial(void *context, size_t index)
{
    struct campaign *campaign = context;

    if (!skid_bus_trial_run(&campaign->trials[index])) {
        exit(2);
    }
}

/* The tables. */

static bool is_good(const struct skid_bus_trial *trial)
{
    return trial->end == SKID_BUS_DONE || trial->end == SKID_BUS_NAMED || trial->thrown;
}

static void print_bad(const struct skid_bus_trial *trial)
{
    char found[FAULTS_NAME_SIZE];

    faults_name(trial->robot_faults, found);
    (void)fprintf(stderr, "seed %" PRIu64 ", %s: %s, tick %" PRIu32 ", %.2f m off, stop %.2f, faults: %s:", trial->seed,
                  trial->robot->name, skid_bus_end_name(trial->end), trial->ticks, trial->end_error, trial->stop,
                  found);
    for (size_t i = 0; i < trial->fault_count; i++) {
        const struct skid_bus_fault *fault = &trial->faults[i];

        (void)fprintf(stderr, " %s %" PRIu64 "-%" PRId64, bus_fault_name(fault->kind), fault->from,
                      (int64_t)fault->until);
        if (fault->kind == BUS_FAULT_SENSOR) {
            (void)fprintf(stderr, " (channel %d, kind %d, value %d)", fault->sensor.channel, fault->sensor.kind,
                          fault->sensor.value);
        }
    }
    (void)fprintf(stderr, "\n");
}

static bool has(const struct skid_bus_trial *trial, enum bus_fault_kind kind)
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
    size_t ends[SKID_BUS_ENDS] = {0};
    size_t count = 0;
    size_t bad = 0;

    for (size_t i = 0; i < campaign->count; i++) {
        const struct skid_bus_trial *trial = &campaign->trials[i];

        if (has(trial, kind)) {
            count++;
            ends[trial->end]++;
            bad += !is_good(trial);
        }
    }
    if (count == 0) {
        return;
    }
    (void)fprintf(stderr, "%-16s %8zu %8zu %8zu %8zu\n", bus_fault_name(kind), count, ends[SKID_BUS_DONE],
                  ends[SKID_BUS_NAMED], bad);
}

static void print_tables(const struct campaign *campaign)
{
    (void)fprintf(stderr, "%-16s %8s %8s %8s %8s\n", "fault", "missions", "done", "named", "bad");
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

static size_t count_end(const struct campaign *campaign, enum skid_bus_end end)
{
    size_t count = 0;

    for (size_t i = 0; i < campaign->count; i++) {
        count += campaign->trials[i].end == end && !campaign->trials[i].thrown;
    }
    return count;
}

static void print_figures(const struct campaign *campaign)
{
    static const char command[] = "make bench-skid-bus";
    json_t *figures = json_array();
    double stop = 0;
    size_t thrown = 0;

    for (size_t i = 0; i < campaign->count; i++) {
        const struct skid_bus_trial *trial = &campaign->trials[i];

        stop = trial->stop > stop ? trial->stop : stop;
        thrown += trial->thrown;
    }
    figures_add(figures, command, (double)campaign->count, "", at_least(CAMPAIGN),
                "skid steer on a faulty bus: random missions, in process");
    figures_add(figures, command, (double)count_end(campaign, SKID_BUS_DONE), "", no_bar,
                "skid steer on a faulty bus: ended at the target");
    figures_add(figures, command, (double)count_end(campaign, SKID_BUS_NAMED), "", no_bar,
                "skid steer on a faulty bus: ended with a named fault");
    figures_add(figures, command, (double)thrown, "", no_bar,
                "skid steer on a faulty bus: thrown over by a jam, or misled by a sensor");
    figures_add(figures, command, (double)count_end(campaign, SKID_BUS_UNNAMED), "", equal_to(0),
                "skid steer on a faulty bus: neither at the target nor with a named fault");
    figures_add(figures, command, (double)count_end(campaign, SKID_BUS_ALARM), "", equal_to(0),
                "skid steer on a faulty bus: a fault where nothing had failed");
    figures_add(figures, command, (double)count_end(campaign, SKID_BUS_MOVED), "", equal_to(0),
                "skid steer on a faulty bus: moved without a command or beyond the stated distance");
    figures_add(figures, command, (double)count_end(campaign, SKID_BUS_ASTRAY), "", equal_to(0),
                "skid steer on a faulty bus: ended elsewhere than commanded");
    figures_add(figures, command, (double)count_end(campaign, SKID_BUS_TIPPED), "", equal_to(0),
                "skid steer on a faulty bus: tipped over");
    figures_add(figures, command, 100 * stop, "%", at_most(100),
                "skid steer on a faulty bus: longest stop, of the stated distance");
    figures_print(figures);
}

static void parse(int argc, char **argv, size_t *count, uint64_t *seed)
{
    for (int i = 1; i < argc; i += 2) {
        if (i + 1 < argc && strcmp(argv[i], "--count") == 0) {
            *count = strtoul(argv[i + 1], NULL, 10);
        } else if (i + 1 < argc && strcmp(argv[i], "--seed") == 0) {
            *seed = strtoull(argv[i + 1], NULL, 10);
        } else {
            fail("usage: bench_skid_bus [--count N] [--seed S]");
        }
    }
}

int main(int argc, char **argv)
{
    static struct campaign campaign = {.count = CAMPAIGN};
    uint64_t seed = 1;

    parse(argc, argv, &campaign.count, &seed);
    campaign.trials = calloc(campaign.count, sizeof *campaign.trials);
    if (campaign.trials == NULL) {
        fail("no memory");
    }
    for (size_t i = 0; i < ROBOTS; i++) {
        char path[64];

        (void)snprintf(path, sizeof path, "sim/robots/%s.cfg", names[i]);
        if (!skid_robot_load(path, &campaign.models[i])) {
            return 2;
        }
    }
    for (size_t i = 0; i < campaign.count; i++) {
        const struct skid_robot_entry *robot = skid_robot_find(names[i % ROBOTS]);

        if (robot == NULL) {
            return 2;
        }
        skid_bus_trial_draw(&campaign.trials[i], seed + i, robot, &campaign.models[i % ROBOTS]);
    }
    in_parallel("skid steer on a faulty bus", run_trial, &campaign, campaign.count);
    print_figures(&campaign);
    print_tables(&campaign);
    free(campaign.trials);
    return EXIT_SUCCESS;
}
