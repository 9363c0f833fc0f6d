#include "sim/missions/plan_arguments.h"

#define MEMORY_KIB_MAX 1048576

static void parse_place(const char *option, const char *text, struct plan_place *place, struct argp_state *state)
{
    if (!plan_place_parse(text, place)) {
        command_line_refuse(state, "%s %s: must be X,Y or X,Y,DEGREES", option, text);
    }
}

static void check(const struct plan_arguments *arguments, struct argp_state *state)
{
    if (arguments->map_path == NULL || arguments->common.robot[0] == '\0') {
        command_line_refuse(state, "a map and --robot are needed");
    }
    if (arguments->has_start != arguments->has_goal) {
        command_line_refuse(state, "give both --start and --goal, or neither");
    }
    if (arguments->has_start && !arguments->start.has_heading) {
        command_line_refuse(state, "--start: must be X,Y,DEGREES");
    }
}

error_t plan_arguments_take(int key, char *argument, struct argp_state *state)
{
    struct plan_arguments *arguments = state->input;

    switch (key) {
    case PLAN_OPTION_START:
        parse_place("--start", argument, &arguments->start, state);
        arguments->has_start = true;
        return 0;
    case PLAN_OPTION_GOAL:
        parse_place("--goal", argument, &arguments->goal, state);
        arguments->has_goal = true;
        return 0;
    case PLAN_OPTION_MEMORY:
        arguments->memory = (size_t)command_line_whole(state, "--memory", argument, 1, MEMORY_KIB_MAX) * 1024;
        return 0;
    case ARGP_KEY_ARG:
        command_line_take(state, "map", argument, &arguments->map_path);
        return 0;
    case ARGP_KEY_END:
        check(arguments, state);
        return 0;
    default:
        return command_line_option(key, argument, state, &arguments->common);
    }
}

bool plan_arguments_task(const struct plan_arguments *arguments, const struct map_file *map,
                         const struct jp_lattice *lattice, struct plan_task *task)
{
    return arguments->has_start ? plan_task_set(map, lattice, &arguments->start, &arguments->goal, task)
                                : plan_task_choose(map, lattice, task);
}
