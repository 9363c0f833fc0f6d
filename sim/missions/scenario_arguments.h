/** The command line of programs that take one scenario: options that are common, and its path. */
#ifndef JOULEPATH_SIM_MISSIONS_SCENARIO_ARGUMENTS_H
#define JOULEPATH_SIM_MISSIONS_SCENARIO_ARGUMENTS_H

#include "sim/base/command_line.h"

struct scenario_arguments {
    const char *path;
    const char *example; /**< a path, told to those who give none */
    struct command_line common;
};

/** Argp's parser into these arguments. */
error_t scenario_arguments_take(int key, char *argument, struct argp_state *state);

#endif
