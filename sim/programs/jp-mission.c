/* Drives a scenario's mission by six strategies in closed loop and compares their energies. */
#include <argp.h>
#include <stdlib.h>

#include "../error.h"
#include "../mission_report.h"
#include "../output.h"

struct arguments {
    const char *path;
    const char *output;
};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case 'o':
        arguments->output = argument;
        return 0;
    case ARGP_KEY_ARG:
        if (arguments->path != NULL) {
            argp_error(state, "one scenario only, not also %s", argument);
        }
        arguments->path = argument;
        return 0;
    case ARGP_KEY_END:
        if (arguments->path == NULL || arguments->output == NULL) {
            argp_error(state, "a scenario and --output are needed");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* The files of a comparison: the logs, then the summary. */
struct files {
    struct output outputs[MISSION_STRATEGIES + 1];
    size_t count;
};

static bool drive(struct mission *missions, enum mission_strategy strategy, const struct scenario *scenario,
                  const char *directory, struct files *files)
{
    struct output *log = &files->outputs[files->count];

    if (!output_open(log, directory, mission_log_name(strategy))) {
        return false;
    }
    files->count++;

    const struct mission_view view = {.log = log->stream, .progress = mission_name(strategy)};

    return mission_run(&missions[strategy], strategy, scenario, missions, &view);
}

static bool drive_all(struct mission *missions, const struct scenario *scenario, const char *directory,
                      struct files *files)
{
    for (size_t i = 0; i < MISSION_STRATEGIES; i++) {
        if (!drive(missions, (enum mission_strategy)i, scenario, directory, files)) {
            return false;
        }
        mission_print(&missions[i]);
    }
    mission_print_comparison(missions, MISSION_STRATEGIES);
    if (!output_open_json(&files->outputs[files->count], directory, "summary.json",
                          mission_json(scenario, missions, MISSION_STRATEGIES))) {
        return false;
    }
    files->count++;
    return true;
}

static bool compare(const struct arguments *arguments)
{
    struct scenario scenario;
    struct mission missions[MISSION_STRATEGIES] = {0};
    struct files files = {.count = 0};

    if (!scenario_load(arguments->path, &scenario) || !output_directory(arguments->output)) {
        return false;
    }
    (void)printf("%s: robot %s, %s energy model, energy of the %s, %zu waypoints\n", scenario.name, scenario.robot.name,
                 scenario.model == SCENARIO_PUBLISHED ? "published" : "identified", energy_kind_name(scenario.energy),
                 scenario.waypoint_count);
    if (!drive_all(missions, &scenario, arguments->output, &files)) {
        output_discard(files.outputs, files.count);
        return false;
    }
    return output_commit(files.outputs, files.count);
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        {"output", 'o', "DIR", 0, "where summary.json and the logs go", 0},
        {0},
    };
    static const struct argp argp = {
        options, parse_option, "SCENARIO.cfg", "Drives a mission by six strategies and compares their energies.", NULL,
        NULL,    NULL};
    struct arguments arguments = {NULL, NULL};

    argp_err_exit_status = ERROR_EXIT;
    (void)argp_parse(&argp, argc, argv, 0, NULL, &arguments);
    return compare(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
