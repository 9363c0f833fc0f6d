/* Makes the state lattice of a robot; tools/design/lattice.py turns it into tables. */
#include <stdlib.h>

#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/lattice/lattice_costs.h"
#include "sim/lattice/lattice_generate.h"
#include "sim/lattice/lattice_json.h"
#include "sim/lattice/lattice_sets.h"

enum { OPTION_PRIMITIVES = COMMAND_LINE_OWN, OPTION_NAVIGATION };

struct arguments {
    struct command_line common;
    const char *primitives;
    bool navigation;
};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case OPTION_PRIMITIVES:
        arguments->primitives = argument;
        return 0;
    case OPTION_NAVIGATION:
        arguments->navigation = true;
        return 0;
    case ARGP_KEY_ARG:
        command_line_take_robot(state, argument, &arguments->common);
        return 0;
    case ARGP_KEY_END:
        if (arguments->common.robot[0] == '\0') {
            command_line_refuse(state, "a robot is needed, such as zhang2018");
        }
        return 0;
    default:
        return command_line_option(key, argument, state, &arguments->common);
    }
}

static bool find_primitives(const struct arguments *arguments, struct lattice *lattice)
{
    if (arguments->primitives != NULL) {
        return lattice_from_json(arguments->primitives, lattice);
    }
    lattice->resolution_m = lattice->robot->cell_m;
    return lattice_generate(lattice);
}

static bool write(const struct arguments *arguments, const struct lattice *lattice)
{
    return output_directory(arguments->common.output) &&
           output_json(arguments->common.output, "lattice.json", lattice_to_json(lattice)) && output_commit();
}

static bool load(const struct arguments *arguments, struct lattice_robot *robot)
{
    if (!lattice_robot_load(arguments->common.robot, robot)) {
        return false;
    }
    if (arguments->navigation && !lattice_robot_turns_anywhere(robot)) {
        error_line("%s: --navigation: it does not find its own way; give its file a section navigation, or leave the "
                   "option out",
                   arguments->common.robot);
        return false;
    }
    return true;
}

static bool make(const struct arguments *arguments)
{
    static struct lattice_robot robot;
    struct lattice lattice = {.robot = &robot};

    if (!load(arguments, &robot)) {
        return false;
    }
    const bool done = find_primitives(arguments, &lattice) && lattice_cover(&lattice) && lattice_price(&lattice) &&
                      write(arguments, &lattice);
    lattice_free(&lattice);
    return done;
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_OUTPUT("build/lattice"),
        {"primitives", OPTION_PRIMITIVES, "FILE", 0,
         "price these primitives (tools.design.lattice) instead of choosing some", 0},
        {"navigation", OPTION_NAVIGATION, NULL, 0, "sweep the disc in which it turns where it finds its own way", 0},
        {0},
    };
    static const struct argp argp = {
        options, parse_option, "ROBOT", "Chooses, sweeps and prices the primitives of a robot's state lattice.",
        NULL,    NULL,         NULL};
    struct arguments arguments = {.common = {.output = "build/lattice"}};

    command_line_parse(&argp, argc, argv, &arguments);
    return make(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
