#include "sim/missions/scenario_arguments.h"

error_t scenario_arguments_take(int key, char *argument, struct argp_state *state)
{
    struct scenario_arguments *arguments = state->input;

    switch (key) {
    case ARGP_KEY_ARG:
        command_line_take(state, "scenario", argument, &arguments->path);
        return 0;
    case ARGP_KEY_END:
        if (arguments->path == NULL) {
            command_line_refuse(state, "a scenario is needed, such as %s", arguments->example);
        }
        return 0;
    default:
        return command_line_option(key, argument, state, &arguments->common);
    }
}
