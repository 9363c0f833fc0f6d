/* Checks a robot file and prints it. */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/robot_file.h"
#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/four_wheel/four_wheel_file.h"
#include "sim/skid_steer/skid_steer_model.h"

struct arguments {
    struct command_line common;
};

/* The constants of a robot of any type, and the fields of its file. */
struct robot {
    const struct config_kind *kind;
    union {
        struct robot_file balancer;
        struct skid_steer_model skid_steer;
        struct four_wheel_file four_wheel;
    } of;
};

static bool load_balancer(const char *path, struct robot *robot)
{
    return robot_file_load(path, &robot->of.balancer);
}

static bool load_skid_steer(const char *path, struct robot *robot)
{
    return skid_steer_load(path, &robot->of.skid_steer);
}

static bool load_differential_drive(const char *path, struct robot *robot)
{
    return differential_drive_load(path, &robot->of.skid_steer);
}

static bool load_four_wheel(const char *path, struct robot *robot)
{
    return four_wheel_file_load(path, &robot->of.four_wheel);
}

static bool load(const char *path, struct robot *robot)
{
    static const struct {
        const struct config_kind *kind;
        bool (*load)(const char *path, struct robot *robot);
    } kinds[] = {{&robot_kind, load_balancer},
                 {&skid_steer_kind, load_skid_steer},
                 {&differential_drive_kind, load_differential_drive},
                 {&four_wheel_kind, load_four_wheel}};
    char type[CONFIG_NAME_SIZE];

    if (!config_fields_type(path, type)) {
        return false;
    }
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (strcmp(type, kinds[i].kind->type) == 0) {
            robot->kind = kinds[i].kind;
            return kinds[i].load(path, robot);
        }
    }
    config_fields_refuse_type(path, type, CONFIG_BALANCER ", skid_steer, differential_drive or four_wheel");
    return false;
}

static const char *name(const struct robot *robot)
{
    return (const char *)&robot->of + robot->kind->name_offset;
}

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

static void print_value(const char *key, const struct robot *robot, const struct config_field *field, size_t index)
{
    if (config_field_is_left_out(&robot->of, field, index)) {
        (void)printf("%-38s %14s %s\n", key, "–", field->unit);
    } else {
        (void)printf("%-38s %14.10g %s\n", key, config_field_value(&robot->of, field, index), field->unit);
    }
}

static void print_table(const struct robot *robot)
{
    (void)printf("%-38s %s\n%-38s %s\n", "name", name(robot), "type", robot->kind->type);
    for (size_t i = 0; i < robot->kind->field_count; i++) {
        const struct config_field *field = &robot->kind->fields[i];
        for (size_t index = 0; index < field->count; index++) {
            char key[CONFIG_LABEL_SIZE];
            config_field_label(field, index, key);
            print_value(key, robot, field, index);
        }
    }
}

static json_t *json_number(const struct robot *robot, const struct config_field *field, size_t index)
{
    const double value = config_field_value(&robot->of, field, index);
    return field->type == CONFIG_FIELD_WHOLE ? json_integer((json_int_t)value) : json_real(value);
}

static json_t *json_value(const struct robot *robot, const struct config_field *field)
{
    if (config_field_is_left_out(&robot->of, field, 0)) {
        return json_null();
    }
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
static json_t *json_robot(const struct robot *robot)
{
    json_t *root = json_object();
    (void)json_object_set_new(root, "name", json_string(name(robot)));
    (void)json_object_set_new(root, "type", json_string(robot->kind->type));
    for (size_t i = 0; i < robot->kind->field_count; i++) {
        const struct config_field *field = &robot->kind->fields[i];
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

static void print_json(const struct robot *robot, FILE *stream)
{
    json_t *root = json_robot(robot);
    (void)json_dumpf(root, stream, JSON_INDENT(4) | JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(15));
    (void)fputc('\n', stream);
    json_decref(root);
}

static bool print(const struct robot *robot, const char *json_path)
{
    FILE *json = NULL;

    if (json_path != NULL) {
        json = output_open(NULL, json_path);
        if (json == NULL) {
            return false;
        }
        print_json(robot, json);
    }
    if (json != stdout) {
        print_table(robot);
    }
    return output_commit();
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {OPTION_JSON, {0}};
    static const struct argp parser = {
        options, parse_option, "ROBOT", "Checks a robot file and prints its constants with their units.",
        NULL,    NULL,         NULL};
    struct arguments arguments = {0};
    command_line_parse(&parser, argc, argv, &arguments);
    struct robot robot;
    if (!load(arguments.common.robot, &robot)) {
        return ERROR_EXIT;
    }
    return print(&robot, arguments.common.json) ? EXIT_SUCCESS : ERROR_EXIT;
}
