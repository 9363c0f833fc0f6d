/* Drives a scenario's mission by the strategies of its robot's kind in closed loop and compares their energies. */
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/missions/mission_report.h"
#include "sim/missions/mission_skid.h"
#include "sim/missions/scenario_arguments.h"

enum { OPTION_ALONE = COMMAND_LINE_OWN, OPTION_OPTIMISED };

struct arguments {
    struct scenario_arguments scenario; /* first: scenario_arguments_take() looks at it */
    bool is_alone;
    bool is_optimised;
};

/* To be driven, one after the other. */
struct strategies {
    enum mission_strategy first;
    size_t count;
};

static bool choose(const struct arguments *arguments, const struct scenario *scenario, struct strategies *chosen)
{
    const bool is_skid = scenario->kind == SCENARIO_SKID;

    if (arguments->is_optimised && is_skid) {
        error_line("--optimised: is for balancers, and %s is none; leave it out", scenario->skid.name);
        return false;
    }
    if (arguments->is_optimised) {
        *chosen = (struct strategies){MISSION_OPTIMISED_CRUISE, 1};
    } else if (arguments->is_alone) {
        *chosen = (struct strategies){is_skid ? MISSION_ROUNDED : MISSION_CRUISE, 1};
    } else {
        *chosen = is_skid ? (struct strategies){MISSION_ROUNDED, MISSION_SKID_COMPARED}
                          : (struct strategies){MISSION_OPTIMAL, MISSION_BALANCER_COMPARED};
    }
    return true;
}

static bool run(struct mission *missions, enum mission_strategy strategy, const struct scenario *scenario,
                const struct mission_view *view)
{
    struct mission *mission = &missions[strategy];

    return scenario->kind == SCENARIO_SKID ? mission_skid_run(mission, strategy, scenario, missions, view)
                                           : mission_run(mission, strategy, scenario, missions, view);
}

/* How the robot drives; another strategy that cannot drive the route is a row that says so. */
static bool is_own(enum mission_strategy strategy)
{
    return strategy == MISSION_CRUISE || strategy >= MISSION_OPTIMISED_CRUISE;
}

static bool drive(struct mission *missions, enum mission_strategy strategy, const struct scenario *scenario,
                  const char *directory)
{
    const struct mission_view view = {.log = output_open(directory, mission_log_name(strategy)),
                                      .progress = mission_name(strategy)};

    struct mission *mission = &missions[strategy];

    if (view.log == NULL || run(missions, strategy, scenario, &view)) {
        return view.log != NULL;
    }
    if (is_own(strategy)) {
        mission_complain(mission, scenario);
        return false;
    }
    return mission->impossible[0] != '\0';
}

static bool drive_all(struct mission *missions, const struct strategies *chosen, const struct scenario *scenario,
                      const char *directory)
{
    const size_t first = chosen->first;
    const size_t count = chosen->count;

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
    struct strategies chosen;
    struct scenario scenario;
    struct mission missions[MISSION_STRATEGIES] = {0};

    if (!scenario_load(arguments->path, &scenario) || !choose(options, &scenario, &chosen) ||
        !output_directory(arguments->common.output)) {
        return false;
    }
    (void)printf("%s: robot %s, %s energy model, energy of the %s, %zu waypoints\n", scenario.name,
                 scenario_robot(&scenario).name, scenario.model == SCENARIO_PUBLISHED ? "published" : "identified",
                 energy_kind_name(scenario.energy), scenario.waypoint_count);
    if (!drive_all(missions, &chosen, &scenario, arguments->common.output)) {
        output_discard();
        return false;
    }
    return output_commit();
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    if (key == OPTION_ALONE || key == OPTION_OPTIMISED) {
        arguments->is_alone = key == OPTION_ALONE;
        arguments->is_optimised = key == OPTION_OPTIMISED;
        return 0;
    }
    return scenario_arguments_take(key, argument, state);
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_OUTPUT("build/mission"),
        {"alone", OPTION_ALONE, NULL, 0, "as the robot drives alone, not what that is compared with", 0},
        {"optimised", OPTION_OPTIMISED, NULL, 0,
         "cruise and transients alone, with headings and speeds found for the whole route", 0},
        {0},
    };
    static const struct argp argp = {
        options,
        parse_option,
        "SCENARIO.cfg",
        "Drives a mission by the strategies of its robot's kind and compares their energies.",
        NULL,
        NULL,
        NULL};
    struct arguments arguments = {
        .scenario = {.example = "sim/scenarios/gao2018_mission.cfg", .common = {.output = "build/mission"}}};

    command_line_parse(&argp, argc, argv, &arguments);
    return compare(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
