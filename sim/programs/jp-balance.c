/* How well a robot balances. */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/balance_trial.h"
#include "sim/balancer/robot_file.h"
#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"

struct arguments {
    struct command_line common;
};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case ARGP_KEY_ARG:
        command_line_take_robot(state, argument, &arguments->common);
        return 0;
    case ARGP_KEY_NO_ARGS:
        command_line_refuse(state, "a robot is needed, such as courier24");
    default:
        return command_line_option(key, argument, state, &arguments->common);
    }
}

static void print_table(const char *name, const struct balance_limits *limits, const struct balance_stand *stand,
                        double mass)
{
    (void)printf("%s\n", name);
    (void)printf("comes back from a lean of    %s%8.2f °\n", limits->lean_deg >= BALANCE_LEAN_MAX ? ">=" : "  ",
                 limits->lean_deg);
    (void)printf("takes a push of              %10.3g N·s, %.2f m/s of its mass\n", limits->push_n_s,
                 limits->push_n_s / mass);
    (void)printf("lean while standing          %10.3f ° rms\n", stand->lean_rms_deg);
    (void)printf("voltage while standing       %10.3f V rms\n", stand->voltage_rms_v);
    (void)printf("motors' power while standing %10.3f W\n", stand->power_w);
    (void)printf("wanders while standing       %10.4f m\n", stand->wander_m);
}

static bool print(const struct arguments *arguments, const struct robot_file *file, const struct balance_limits *limits,
                  const struct balance_stand *stand)
{
    if (arguments->common.json != NULL &&
        !output_json(NULL, arguments->common.json,
                     json_pack("{s:s, s:f, s:f, s:f, s:f, s:f, s:f}", "robot", file->name, "lean_deg", limits->lean_deg,
                               "push_n_s", limits->push_n_s, "standing_lean_rms_deg", stand->lean_rms_deg,
                               "standing_voltage_rms_v", stand->voltage_rms_v, "standing_power_w", stand->power_w,
                               "standing_wander_m", stand->wander_m))) {
        return false;
    }
    if (arguments->common.json == NULL || strcmp(arguments->common.json, "-") != 0) {
        print_table(file->name, limits, stand, file->body.mass_kg + 2 * file->wheel.mass_kg);
    }
    return output_commit();
}

static bool run(const struct arguments *arguments)
{
    struct robot_file file;
    struct balance_limits limits;
    struct balance_stand stand;

    if (!robot_file_load(arguments->common.robot, &file)) {
        return false;
    }

    const struct robot_entry *entry = rig_find_robot(file.name);

    return entry != NULL && balance_trial_stand(entry, &file, arguments->common.seed, &stand) &&
           balance_trial_limits(entry, &file, arguments->common.seed, &limits) &&
           print(arguments, &file, &limits, &stand);
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {OPTION_JSON, OPTION_SEED("of the sensors' noise"), {0}};
    static const struct argp parser = {
        options, parse_option, "ROBOT", "Leans and pushes a simulated robot until it falls, and lets it stand.",
        NULL,    NULL,         NULL};
    struct arguments arguments = {.common = {.seed = 1}};

    command_line_parse(&parser, argc, argv, &arguments);
    return run(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
