/* Drives a scenario's mission by six strategies in closed loop and compares their energies. */
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/missions/mission_report.h"
#include "sim/missions/scenario_arguments.h"

enum { OPTION_ALONE = COMMAND_LINE_OWN, OPTION_OPTIMISED };

struct arguments {
    struct scenario_arguments scenario; /* first: scenario_arguments_take() looks at it */
    enum mission_strategy first;        /* to be driven */
    size_t count;
};

/* Cruise and transients are how the robot drives; another strategy that cannot drive the route is a row that says so.
 */
static bool drive(struct mission *missions, enum mission_strategy strategy, const struct scenario *scenario,
                  const char *directory)
{
    const struct mission_view view = {.log = output_open(directory, mission_log_name(strategy)),
                                      .progress = mission_name(strategy)};

    struct mission *mission = &missions[strategy];

    if (view.log == NULL || mission_run(mission, strategy, scenario, missions, &view)) {
        return view.log != NULL;
    }
    if (strategy == MISSION_CRUISE || strategy == MISSION_OPTIMISED_CRUISE) {
        mission_complain(mission, scenario);
        return false;
    }
    return mission->impossible[0] != '\0';
}

/* `count` of them from `first` on. */
static bool drive_all(struct mission *missions, size_t first, size_t count, const struct scenario *scenario,
                      const char *directory)
{
    for (size_t i = first; i < first + count; i++) {
        if (!drive(missions, (enum mission_strategy)i, scenario, directory)) {
            return false;
        }
        mission_print(&missions[i]);
    }
    mission_print_comparison(&missions[first], count);
    return output_json(directory, "summary.json", mission_json(scenario, &missions[first], count));
}

static bool compare(const struct arguments *options)
{
    const struct scenario_arguments *arguments = &options->scenario;
    const size_t first = options->first;
    const size_t count = options->count;
    struct scenario scenario;
    struct mission missions[MISSION_STRATEGIES + 1] = {0};

    if (!scenario_load(arguments->path, &scenario) || !output_directory(arguments->common.output)) {
        return false;
    }
    (void)printf("%s: robot %s, %s energy model, energy of the %s, %zu waypoints\n", scenario.name, scenario.robot.name,
                 scenario.model == SCENARIO_PUBLISHED ? "published" : "identified", energy_kind_name(scenario.energy),
                 scenario.waypoint_count);
    if (!drive_all(missions, first, count, &scenario, arguments->common.output)) {
        output_discard();
        return false;
    }
    return output_commit();
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    if (key == OPTION_ALONE || key == OPTION_OPTIMISED) {
        arguments->first = key == OPTION_ALONE ? MISSION_CRUISE : MISSION_OPTIMISED_CRUISE;
        arguments->count = 1;
        return 0;
    }
    return scenario_arguments_take(key, argument, state);
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_OUTPUT("build/mission"),
        {"alone", OPTION_ALONE, NULL, 0, "cruise and transients alone, not what they are compared with", 0},
        {"optimised", OPTION_OPTIMISED, NULL, 0, "the same, with headings and speeds found for the whole route", 0},
        {0},
    };
    static const struct argp argp = {
        options, parse_option, "SCENARIO.cfg", "Drives a mission by six strategies and compares their energies.", NULL,
        NULL,    NULL};
    struct arguments arguments = {
        .scenario = {.example = "sim/scenarios/gao2018_mission.cfg", .common = {.output = "build/mission"}},
        .count = MISSION_STRATEGIES};

    command_line_parse(&argp, argc, argv, &arguments);
    return compare(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
