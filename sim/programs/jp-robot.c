/* Checks a robot file and prints it. */
#include <argp.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"
#include "../robot_file.h"

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
        argp_error(state, "a robot file is missing, such as sim/robots/courier24.cfg");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static void print_table(const struct robot_file *robot)
{
    (void)printf("%-34s %s\n", "name", robot->name);
    for (size_t i = 0; i < robot_field_count; i++) {
        const struct robot_field *field = &robot_fields[i];
        for (size_t index = 0; index < field->count; index++) {
            char key[ROBOT_LABEL_SIZE];
            robot_field_label(field, index, key);
            (void)printf("%-34s %14.10g %s\n", key, robot_field_value(robot, field, index), field->unit);
        }
    }
}

static json_t *json_number(const struct robot_file *robot, const struct robot_field *field, size_t index)
{
    const double value = robot_field_value(robot, field, index);
    return field->type == ROBOT_FIELD_WHOLE ? json_integer((json_int_t)value) : json_real(value);
}

static json_t *json_value(const struct robot_file *robot, const struct robot_field *field)
{
    if (field->count == 1) {
        return json_number(robot, field, 0);
    }
    json_t *array = json_array();
    for (size_t index = 0; index < field->count; index++) {
        (void)json_array_append_new(array, json_number(robot, field, index));
    }
    return array;
}

/* {"name": …, "body": {"mass_kg": …}, …} */
static json_t *json_robot(const struct robot_file *robot)
{
    json_t *root = json_object();
    (void)json_object_set_new(root, "name", json_string(robot->name));
    for (size_t i = 0; i < robot_field_count; i++) {
        const struct robot_field *field = &robot_fields[i];
        const char *dot = strchr(field->key, '.');
        char group_name[64];
        (void)snprintf(group_name, sizeof group_name, "%.*s", (int)(dot - field->key), field->key);
        json_t *group = json_object_get(root, group_name);
        if (group == NULL) {
            group = json_object();
            (void)json_object_set_new(root, group_name, group);
        }
        (void)json_object_set_new(group, dot + 1, json_value(robot, field));
    }
    return root;
}

static void print_json(const struct robot_file *robot)
{
    json_t *root = json_robot(robot);
    (void)json_dumpf(root, stdout, JSON_INDENT(4) | JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(15));
    (void)putchar('\n');
    json_decref(root);
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {{"json", 'j', NULL, 0, "Print JSON instead of a table", 0}, {0}};
    static const struct argp parser = {
        options, parse_option, "FILE", "Checks a robot file and prints its constants with their units.",
        NULL,    NULL,         NULL};
    struct arguments arguments = {0};
    argp_err_exit_status = ERROR_EXIT;
    if (argp_parse(&parser, argc, argv, 0, NULL, &arguments) != 0) {
        return ERROR_EXIT;
    }
    struct robot_file robot;
    if (!robot_file_load(arguments.path, &robot)) {
        return ERROR_EXIT;
    }
    if (arguments.json) {
        print_json(&robot);
    } else {
        print_table(&robot);
    }
    if (fflush(stdout) != 0 || ferror(stdout)) {
        error_line("jp-robot: standard output cannot be written; is the disk full?");
        return ERROR_EXIT;
    }
    return 0;
}
