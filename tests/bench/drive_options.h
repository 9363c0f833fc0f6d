/** Options of a bench that drives: the first seed, how many drives, and the maps to drive on. */
#ifndef JOULEPATH_TESTS_BENCH_DRIVE_OPTIONS_H
#define JOULEPATH_TESTS_BENCH_DRIVE_OPTIONS_H

#include <argp.h>
#include <stdint.h>
#include <stdlib.h>

#include "sim/base/error.h"

enum { DRIVE_MAPS_MAX = 16 };

struct drive_options {
    uint64_t seed;
    size_t count;
    size_t count_max;
    size_t maps_max; /**< 0: the bench has scenes of its own; at most DRIVE_MAPS_MAX, and then one at least */
    const char *maps[DRIVE_MAPS_MAX];
    size_t map_count;
};

static error_t parse_drive_option(int key, char *argument, struct argp_state *state)
{
    struct drive_options *const options = state->input;
    char *end;

    if (key == ARGP_KEY_ARG && options->map_count < options->maps_max) {
        options->maps[options->map_count++] = argument;
        return 0;
    }
    if (key == ARGP_KEY_END && options->map_count == 0 && options->maps_max > 0) {
        argp_error(state, "no map is given");
    }
    if (key != 's' && key != 'n') {
        return ARGP_ERR_UNKNOWN;
    }
    const unsigned long value = strtoul(argument, &end, 10);

    if (*end != '\0' || (key == 'n' && (value < 1 || value > options->count_max))) {
        argp_error(state, "%s: no number of its range", argument);
    }
    if (key == 's') {
        options->seed = value;
    } else {
        options->count = value;
    }
    return 0;
}

/** Exits with status 2 and a line on stderr where the arguments are no options. */
static inline void parse_drive_options(int argc, char **argv, const char *purpose, struct drive_options *options)
{
    static const struct argp_option known[] = {
        {"seed", 's', "FIRST", 0, "first seed", 0}, {"count", 'n', "N", 0, "drives of each map or scene", 0}, {0}};
    const struct argp parser = {
        known, parse_drive_option, options->maps_max > 0 ? "MAP.json..." : NULL, purpose, NULL, NULL, NULL};

    argp_err_exit_status = ERROR_EXIT;
    (void)argp_parse(&parser, argc, argv, 0, NULL, options);
}

#endif
