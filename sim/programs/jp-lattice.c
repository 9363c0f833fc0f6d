/* Makes the state lattice of a robot; tools/lattice.py turns it into tables. */
#include <argp.h>
#include <stdlib.h>

#include "../error.h"
#include "../lattice_costs.h"
#include "../lattice_generate.h"
#include "../lattice_json.h"
#include "../lattice_sets.h"
#include "../output.h"

/* Cells of the lattices that are made here (section 2.2 of Zhang et al.), m. */
#define RESOLUTION 0.2

struct arguments {
    const char *path;
    const char *output;
    const char *primitives;
};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case 'o':
        arguments->output = argument;
        return 0;
    case 'p':
        arguments->primitives = argument;
        return 0;
    case ARGP_KEY_ARG:
        if (arguments->path != NULL) {
            argp_error(state, "one robot file only, not also %s", argument);
        }
        arguments->path = argument;
        return 0;
    case ARGP_KEY_END:
        if (arguments->path == NULL || arguments->output == NULL) {
            argp_error(state, "a robot file and --output are needed");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static bool find_primitives(const struct arguments *arguments, struct lattice *lattice)
{
    if (arguments->primitives != NULL) {
        return lattice_from_json(arguments->primitives, lattice);
    }
    lattice->resolution_m = RESOLUTION;
    return lattice_generate(lattice);
}

static bool write(const struct arguments *arguments, const struct lattice *lattice)
{
    struct output output;

    return output_directory(arguments->output) &&
           output_open_json(&output, arguments->output, "lattice.json", lattice_to_json(lattice)) &&
           output_commit(&output, 1);
}

static bool make(const struct arguments *arguments)
{
    static struct lattice_robot robot;
    struct lattice lattice = {.robot = &robot};

    if (!lattice_robot_load(arguments->path, &robot)) {
        return false;
    }
    bool done = find_primitives(arguments, &lattice) && lattice_cover(&lattice);
    if (done) {
        lattice_price(&lattice);
        done = write(arguments, &lattice);
    }
    lattice_free(&lattice);
    return done;
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        {"output", 'o', "DIR", 0, "where lattice.json goes", 0},
        {"primitives", 'p', "FILE", 0, "price these primitives (JSON of tools/lattice.py) instead of choosing some", 0},
        {0},
    };
    static const struct argp argp = {
        options, parse_option, "ROBOT.cfg", "Chooses, sweeps and prices the primitives of a robot's state lattice.",
        NULL,    NULL,         NULL};
    struct arguments arguments = {0};

    argp_err_exit_status = ERROR_EXIT;
    (void)argp_parse(&argp, argc, argv, 0, NULL, &arguments);
    return make(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
