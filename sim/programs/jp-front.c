/* Foretells and drives the front of a scenario's route: its energy over its time. */
#include <stdlib.h>

#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/missions/front.h"

struct arguments {
    const char *path;
    struct command_line common;
};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case ARGP_KEY_ARG:
        command_line_take(state, "scenario", argument, &arguments->path);
        return 0;
    case ARGP_KEY_END:
        if (arguments->path == NULL) {
            command_line_refuse(state, "a scenario is needed, such as sim/scenarios/gao2018_short.cfg");
        }
        return 0;
    default:
        return command_line_option(key, argument, state, &arguments->common);
    }
}

static bool run(const struct arguments *arguments)
{
    static struct front front;
    struct scenario scenario;

    if (!scenario_load(arguments->path, &scenario) || !output_directory(arguments->common.output) ||
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
                                     parse_option,
                                     "SCENARIO.cfg",
                                     "Foretells and drives the front of a route: its energy over its time.",
                                     NULL,
                                     NULL,
                                     NULL};
    struct arguments arguments = {.common = {.output = "build/front"}};

    command_line_parse(&argp, argc, argv, &arguments);
    return run(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
