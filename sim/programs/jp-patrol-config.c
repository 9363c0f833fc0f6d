/* Checks a patrol robot's file and prints what its controller is set to. */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/four_wheel/patrol_config.h"
#include "sim/four_wheel/patrol_members.h"

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
        command_line_refuse(state, "a robot is needed, such as patrol");
    default:
        return command_line_option(key, argument, state, &arguments->common);
    }
}

/** A configuration and its members. */
struct part {
    const char *name;
    const void *config;
    const struct patrol_member *members;
    size_t count;
};

static void print_table(const struct part *part)
{
    (void)printf("%s\n", part->name);
    for (size_t i = 0; i < part->count; i++) {
        const struct patrol_member *member = &part->members[i];
        (void)printf("  %-32s %14.6g %s\n", member->key, patrol_member_quantity(part->config, member), member->unit);
    }
}

static json_t *json_value(const struct part *part, const struct patrol_member *member)
{
    const double value = patrol_member_value(part->config, member);

    switch (member->format) {
    case PATROL_FLOAT:
        return json_real(value);
    case PATROL_FLAG:
        return json_boolean(value != 0);
    default:
        return json_integer((json_int_t)value);
    }
}

static json_t *json_part(const struct part *part)
{
    json_t *array = json_array();

    for (size_t i = 0; i < part->count; i++) {
        const struct patrol_member *member = &part->members[i];
        (void)json_array_append_new(array, json_pack("{s:s, s:s, s:o, s:s}", "key", member->key, "format",
                                                     patrol_format_names[member->format], "value",
                                                     json_value(part, member), "unit", member->unit));
    }
    return array;
}

/* Its floats read back exactly. */
static void print_json(const char *robot, const struct part *parts, size_t count, FILE *stream)
{
    json_t *root = json_pack("{s:s}", "name", robot);

    for (size_t i = 0; i < count; i++) {
        (void)json_object_set_new(root, parts[i].name, json_part(&parts[i]));
    }
    (void)json_dumpf(root, stream, JSON_INDENT(4) | JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(17));
    (void)fputc('\n', stream);
    json_decref(root);
}

static bool print(const struct four_wheel_file *robot, const char *json_path)
{
    const struct jp_patrol_config patrol = patrol_config(robot, PATROL_IMPROVED);
    const struct jp_pure_pursuit_config pursuit = patrol_pursuit_config(robot);
    const struct jp_localiser_config localiser = patrol_localiser_config(robot, NULL);
    const struct jp_patrol_scanner scanner = patrol_scanner(robot);
    const struct jp_four_wheel_robot_config tick = patrol_robot_config(robot);
    const struct part parts[] = {
        {"patrol", &patrol, patrol_members, patrol_member_count},
        {"pure_pursuit", &pursuit, patrol_pursuit_members, patrol_pursuit_member_count},
        {"patrol_localiser", &localiser, patrol_localiser_members, patrol_localiser_member_count},
        {"patrol_scanner", &scanner, patrol_scanner_members, patrol_scanner_member_count},
        {"four_wheel_robot", &tick, patrol_robot_members, patrol_robot_member_count},
    };
    const size_t count = sizeof parts / sizeof parts[0];

    FILE *json = NULL;

    if (json_path != NULL) {
        json = output_open(NULL, json_path);
        if (json == NULL) {
            return false;
        }
        print_json(robot->name, parts, count, json);
    }
    for (size_t i = 0; i < count && json != stdout; i++) {
        print_table(&parts[i]);
    }
    return output_commit();
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {OPTION_JSON, {0}};
    static const struct argp argp = {options,
                                     parse_option,
                                     "ROBOT",
                                     "Checks a patrol robot's file and prints what its controller is set to: the "
                                     "members of its C tables with their units.",
                                     NULL,
                                     NULL,
                                     NULL};
    struct arguments arguments = {0};
    struct four_wheel_file robot;

    command_line_parse(&argp, argc, argv, &arguments);
    if (!four_wheel_file_load(arguments.common.robot, &robot)) {
        return ERROR_EXIT;
    }
    return print(&robot, arguments.common.json) ? EXIT_SUCCESS : ERROR_EXIT;
}
