/* Checks a patrol robot's file and prints what its controller is set to. */
#include <argp.h>
#include <jansson.h>
#include <stdio.h>

#include "../error.h"
#include "../patrol_config.h"
#include "../patrol_members.h"

struct arguments {
    const char *path;
    bool json;
};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case 'j':
        arguments->json = true;
        return 0;
    case ARGP_KEY_ARG:
        if (arguments->path != NULL) {
            argp_error(state, "one robot file only, not also %s", argument);
        }
        arguments->path = argument;
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "a robot file is missing, such as sim/robots/patrol.cfg");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
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
static void print_json(const char *robot, const struct part *parts, size_t count)
{
    json_t *root = json_pack("{s:s}", "name", robot);

    for (size_t i = 0; i < count; i++) {
        (void)json_object_set_new(root, parts[i].name, json_part(&parts[i]));
    }
    (void)json_dumpf(root, stdout, JSON_INDENT(4) | JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(17));
    (void)putchar('\n');
    json_decref(root);
}

static void print(const struct four_wheel_file *robot, bool json)
{
    const struct jp_patrol_config patrol = patrol_config(robot, PATROL_IMPROVED);
    const struct jp_pure_pursuit_config pursuit = patrol_pursuit_config(robot);
    const struct part parts[] = {
        {"patrol", &patrol, patrol_members, patrol_member_count},
        {"pure_pursuit", &pursuit, patrol_pursuit_members, patrol_pursuit_member_count},
    };
    const size_t count = sizeof parts / sizeof parts[0];

    if (json) {
        print_json(robot->name, parts, count);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        print_table(&parts[i]);
    }
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {{"json", 'j', NULL, 0, "Print JSON instead of a table", 0}, {0}};
    static const struct argp argp = {options,
                                     parse_option,
                                     "FILE",
                                     "Checks a patrol robot's file and prints what its controller is set to: the "
                                     "members of jp_patrol_config and jp_pure_pursuit_config with their units.",
                                     NULL,
                                     NULL,
                                     NULL};
    struct arguments arguments = {0};
    struct four_wheel_file robot;

    argp_err_exit_status = ERROR_EXIT;
    (void)argp_parse(&argp, argc, argv, 0, NULL, &arguments);
    if (!four_wheel_file_load(arguments.path, &robot)) {
        return ERROR_EXIT;
    }
    print(&robot, arguments.json);
    if (fflush(stdout) != 0 || ferror(stdout)) {
        error_line("jp-patrol-config: standard output cannot be written; is the disk full?");
        return ERROR_EXIT;
    }
    return 0;
}
