/* Foretells and drives the front of a scenario's route: its energy over its time. */
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/missions/front.h"
#include "sim/missions/scenario_arguments.h"

static bool run(const struct scenario_arguments *arguments)
{
    static struct front front;
    struct scenario scenario;

    if (!scenario_load_balancer(arguments->path, &scenario) || !output_directory(arguments->common.output) ||
        !front_make(&front, &scenario)) {
        return false;
    }
    (void)printf("%s: robot %s, energy of the %s\n", scenario.name, scenario.robot.name,
                 energy_kind_name(scenario.energy));
    front_print(&front);
    return output_json(arguments->common.output, "front.json", front_json(&scenario, &front)) && output_commit();
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_OUTPUT("build/front"),
        {0},
    };
    static const struct argp argp = {options,
                                     scenario_arguments_take,
                                     "SCENARIO.cfg",
                                     "Foretells and drives the front of a route: its energy over its time.",
                                     NULL,
                                     NULL,
                                     NULL};
    struct scenario_arguments arguments = {.example = "sim/scenarios/gao2018_short.cfg",
                                           .common = {.output = "build/front"}};

    command_line_parse(&argp, argc, argv, &arguments);
    return run(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
