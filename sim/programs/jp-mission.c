/* Drives a scenario's mission by six strategies in closed loop and compares their energies. */
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/missions/mission_report.h"
#include "sim/missions/scenario_arguments.h"

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
    if (strategy == MISSION_CRUISE) {
        mission_complain(mission, scenario);
        return false;
    }
    return mission->impossible[0] != '\0';
}

static bool drive_all(struct mission *missions, const struct scenario *scenario, const char *directory)
{
    for (size_t i = 0; i < MISSION_STRATEGIES; i++) {
        if (!drive(missions, (enum mission_strategy)i, scenario, directory)) {
            return false;
        }
        mission_print(&missions[i]);
    }
    mission_print_comparison(missions, MISSION_STRATEGIES);
    return output_json(directory, "summary.json", mission_json(scenario, missions, MISSION_STRATEGIES));
}

static bool compare(const struct scenario_arguments *arguments)
{
    struct scenario scenario;
    struct mission missions[MISSION_STRATEGIES] = {0};

    if (!scenario_load(arguments->path, &scenario) || !output_directory(arguments->common.output)) {
        return false;
    }
    (void)printf("%s: robot %s, %s energy model, energy of the %s, %zu waypoints\n", scenario.name, scenario.robot.name,
                 scenario.model == SCENARIO_PUBLISHED ? "published" : "identified", energy_kind_name(scenario.energy),
                 scenario.waypoint_count);
    if (!drive_all(missions, &scenario, arguments->common.output)) {
        output_discard();
        return false;
    }
    return output_commit();
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_OUTPUT("build/mission"),
        {0},
    };
    static const struct argp argp = {options,
                                     scenario_arguments_take,
                                     "SCENARIO.cfg",
                                     "Drives a mission by six strategies and compares their energies.",
                                     NULL,
                                     NULL,
                                     NULL};
    struct scenario_arguments arguments = {.example = "sim/scenarios/gao2018_mission.cfg",
                                           .common = {.output = "build/mission"}};

    command_line_parse(&argp, argc, argv, &arguments);
    return compare(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
