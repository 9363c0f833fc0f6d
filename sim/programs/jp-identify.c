/* Runs the identification experiments of a robot; tools/design/identify.py fits the energy model to their energies. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/experiment.h"
#include "sim/balancer/fault_names.h"
#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/base/progress.h"

/* Of each segment, unless told otherwise, and at most; as long as it takes to settle. */
#define SEGMENT_SECONDS     10.0
#define SEGMENT_SECONDS_MAX 600.0

/** The last part of a segment, for its steady power. */
#define LAST_SECONDS 1.0

enum { OPTION_THRESHOLD = COMMAND_LINE_OWN, OPTION_SECONDS };

struct arguments {
    struct command_line common;
    size_t count;
    double threshold;
    double seconds;
};

/** What one experiment leaves: its segments and the energy of the second at each window. */
struct record {
    struct experiment experiment;
    struct experiment_energy *energy;
};

struct campaign {
    const struct arguments *arguments;
    struct robot_file file;
    const struct robot_entry *entry;
    struct record *records;
    size_t count;
    size_t windows;
    double window_seconds;
};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case 'n':
        arguments->count = (size_t)command_line_whole(state, "--count", argument, 20, 1000000);
        return 0;
    case OPTION_SECONDS:
        arguments->seconds = command_line_real(state, "--seconds", argument, SEGMENT_SECONDS, SEGMENT_SECONDS_MAX);
        return 0;
    case OPTION_THRESHOLD:
        arguments->threshold = command_line_real(state, "--threshold", argument, 1e-6, 1e3);
        return 0;
    case ARGP_KEY_ARG:
        command_line_take_robot(state, argument, &arguments->common);
        return 0;
    case ARGP_KEY_END:
        if (arguments->common.robot[0] == '\0') {
            command_line_refuse(state, "a robot is needed, such as courier24");
        }
        return 0;
    default:
        return command_line_option(key, argument, state, &arguments->common);
    }
}

static void complain(const struct campaign *campaign, size_t index)
{
    const struct experiment *experiment = &campaign->records[index].experiment;
    const char *path = campaign->arguments->common.robot;
    const char *robot = campaign->file.name;
    char faults[FAULTS_NAME_SIZE];

    if (experiment->end == JP_ROBOT_FALLEN) {
        error_line("%s: the robot fell in experiment %zu; correct control.weights and run make gains ROBOT=%s", path,
                   index, robot);
    } else if (experiment->end == JP_ROBOT_FAULT) {
        faults_name(experiment->faults, faults);
        error_line("%s: the robot stopped in experiment %zu with the fault: %s; run make gains ROBOT=%s for this file, "
                   "or correct its sensors, control.weights or limits",
                   path, index, faults, robot);
    } else {
        error_line("%s: the robot refused a segment of experiment %zu; run make gains ROBOT=%s, whose tables are of "
                   "other limits",
                   path, index, robot);
    }
}

static bool run(struct campaign *campaign)
{
    struct random random;
    struct rig rig;

    random_init(&random, campaign->arguments->common.seed);
    for (size_t i = 0; i < campaign->count; i++) {
        struct record *record = &campaign->records[i];

        experiment_draw(&record->experiment, &campaign->file, &random);
        record->energy = calloc(campaign->windows + 1, sizeof *record->energy);
        if (record->energy == NULL) {
            error_line("--count %zu: no memory for so many; choose fewer", campaign->count);
            return false;
        }
        if (!rig_init(&rig, campaign->entry, &campaign->file, campaign->arguments->common.seed + i)) {
            return false;
        }
        experiment_run(&record->experiment, &rig, campaign->arguments->seconds, campaign->arguments->threshold,
                       record->energy);
        if (record->experiment.end != JP_ROBOT_DRIVING) {
            complain(campaign, i);
            return false;
        }
        progress_show("experiments", i + 1, campaign->count);
    }
    progress_end();
    return true;
}

static double mean_settling(const struct campaign *campaign)
{
    double sum = 0;

    for (size_t i = 0; i < campaign->count; i++) {
        sum += campaign->records[i].experiment.settling;
    }
    return sum / (double)campaign->count;
}

/** The settling time on the grid of windows, where the energies are known. */
static size_t split_window(const struct campaign *campaign)
{
    double window = mean_settling(campaign) / campaign->window_seconds;

    return (size_t)fmin(round(window), (double)campaign->windows - 1);
}

/** Before the settling time, after it, in the last part, altogether. */
static void write_energies(double settling, double until_last, double total, FILE *stream)
{
    (void)fprintf(stream, ",%.9f,%.9f,%.9f,%.9f", settling, total - settling, total - until_last, total);
}

static void write_table(const struct campaign *campaign, size_t split, FILE *stream)
{
    size_t last = campaign->windows - (size_t)lround(LAST_SECONDS / campaign->window_seconds);

    (void)fprintf(stream, "v1_m_s,w1_rad_s,turn1_rad,v2_m_s,w2_rad_s,turn2_rad,u_left_before_v,u_right_before_v,"
                          "settling_s,motor_state_j,motor_steady_j,motor_last_j,motor_total_j,battery_state_j,"
                          "battery_steady_j,battery_last_j,battery_total_j\n");
    for (size_t i = 0; i < campaign->count; i++) {
        const struct experiment *e = &campaign->records[i].experiment;
        const struct experiment_energy *energy = campaign->records[i].energy;
        const struct experiment_energy total = energy[campaign->windows];

        (void)fprintf(stream, "%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.6f,%.6f,%.3f", e->first.speed, e->first.turn_rate,
                      e->first.turn, e->second.speed, e->second.turn_rate, e->second.turn, e->voltage_left,
                      e->voltage_right, e->settling);
        write_energies(energy[split].motor, energy[last].motor, total.motor, stream);
        write_energies(energy[split].battery, energy[last].battery, total.battery, stream);
        (void)fputc('\n', stream);
    }
}

static json_t *json_summary(const struct campaign *campaign, size_t split)
{
    return json_pack("{s:s, s:f, s:f, s:f, s:I, s:I, s:f, s:f}", "robot", campaign->file.name, "settling_time_s",
                     (double)split * campaign->window_seconds, "segment_s", campaign->arguments->seconds, "last_s",
                     LAST_SECONDS, "count", (json_int_t)campaign->count, "seed",
                     (json_int_t)campaign->arguments->common.seed, "window_s", campaign->window_seconds,
                     "settling_threshold_v", campaign->arguments->threshold);
}

static bool write(const struct campaign *campaign)
{
    const char *directory = campaign->arguments->common.output;
    size_t split = split_window(campaign);
    (void)printf("%zu experiments, mean settling time %.2f s\n", campaign->count,
                 (double)split * campaign->window_seconds);
    FILE *table = output_open(directory, "experiments.csv");

    if (table == NULL) {
        return false;
    }
    write_table(campaign, split, table);
    if (!output_json(directory, "experiments.json", json_summary(campaign, split))) {
        output_discard();
        return false;
    }
    return output_commit();
}

static bool identify(const struct arguments *arguments)
{
    struct campaign campaign = {.arguments = arguments, .count = arguments->count};

    if (!robot_file_load(arguments->common.robot, &campaign.file)) {
        return false;
    }
    campaign.entry = rig_find_robot(campaign.file.name);
    if (campaign.entry == NULL || !output_directory(arguments->common.output)) {
        return false;
    }
    campaign.windows =
        (size_t)lround(campaign.arguments->seconds * campaign.file.control.rate_hz) / EXPERIMENT_WINDOW_TICKS;
    campaign.window_seconds = (double)EXPERIMENT_WINDOW_TICKS / campaign.file.control.rate_hz;
    campaign.records = calloc(campaign.count, sizeof *campaign.records);
    if (campaign.records == NULL) {
        error_line("--count %zu: no memory for so many; choose fewer", arguments->count);
        return false;
    }

    bool done = run(&campaign) && write(&campaign);

    for (size_t i = 0; i < campaign.count; i++) {
        free(campaign.records[i].energy);
    }
    free(campaign.records);
    return done;
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_OUTPUT("build/identify"),
        {"count", 'n', "N", 0, "experiments (1000)", 0},
        OPTION_SEED("of the random segments"),
        {"seconds", OPTION_SECONDS, "S", 0, "of each of an experiment's two segments (10)", 0},
        {"threshold", OPTION_THRESHOLD, "V", 0,
         "settled: mean voltages of successive windows of 200 ticks differ by less (0.01 V)", 0},
        {0},
    };
    static const struct argp argp = {
        options,
        parse_option,
        "ROBOT",
        "Drives random pairs of segments and records their energies: motor, (ul² + ur²)/Rm, and battery, "
        "ul il + ur ir.",
        NULL,
        NULL,
        NULL};
    struct arguments arguments = {.common = {.output = "build/identify", .seed = 1},
                                  .count = 1000,
                                  .threshold = 0.01,
                                  .seconds = SEGMENT_SECONDS};

    command_line_parse(&argp, argc, argv, &arguments);
    return identify(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
