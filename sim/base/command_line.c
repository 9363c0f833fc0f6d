#include "sim/base/command_line.h"

#include <errno.h>
#include <inttypes.h>
#include <joulepath/version.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/error.h"
#include "sim/base/output.h"

/** Of the robots that are given by their names; an installed program is told another one by the environment. */
#define ROBOT_FOLDER             "sim/robots"
#define ROBOT_FOLDER_ENVIRONMENT "JOULEPATH_ROBOTS"

static void print_version(FILE *stream, struct argp_state *state)
{
    (void)fprintf(stream, "%s %d.%d.%d\n", state->name, JP_VERSION_MAJOR, JP_VERSION_MINOR, JP_VERSION_PATCH);
}

void command_line_parse(const struct argp *argp, int argc, char **argv, void *input)
{
    output_start();
    argp_err_exit_status = ERROR_EXIT;
    argp_program_version_hook = print_version;
    (void)argp_parse(argp, argc, argv, 0, NULL, input);
}

void command_line_refuse(const struct argp_state *state, const char *format, ...)
{
    char line[COMMAND_LINE_PATH_SIZE];
    va_list arguments;

    va_start(arguments, format);
    (void)vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    error_line("%s: %s", state->name, line);
    exit(ERROR_EXIT);
}

/* ---- Numbers ---- */

int64_t command_line_whole(const struct argp_state *state, const char *option, const char *text, int64_t low,
                           int64_t high)
{
    const char *digits = text + (text[0] == '-');
    const size_t length = strlen(digits);

    errno = 0;

    const long long value = strtoll(text, NULL, 10);

    if (length == 0 || strspn(digits, "0123456789") != length || errno != 0 || value < low || value > high) {
        command_line_refuse(state, "%s %s: must be a whole number from %" PRId64 " to %" PRId64, option, text, low,
                            high);
    }
    return value;
}

double command_line_real(const struct argp_state *state, const char *option, const char *text, double low, double high)
{
    char *end;
    const double value = strtod(text, &end);

    if (end == text || *end != '\0' || !(value >= low && value <= high)) {
        command_line_refuse(state, "%s %s: must be a number from %g to %g", option, text, low, high);
    }
    return value;
}

/* ---- Common options and arguments ---- */

static void set_robot(const struct argp_state *state, const char *argument, struct command_line *options)
{
    const bool is_name = argument[0] != '\0' && strpbrk(argument, "/.") == NULL;
    const char *installed = getenv(ROBOT_FOLDER_ENVIRONMENT);
    const char *folder = installed != NULL ? installed : ROBOT_FOLDER;
    const int length = is_name ? snprintf(options->robot, sizeof options->robot, "%s/%s.cfg", folder, argument)
                               : snprintf(options->robot, sizeof options->robot, "%s", argument);

    if (length <= 0 || (size_t)length >= sizeof options->robot) {
        command_line_refuse(state, "robot: must be a path of 1 to %zu characters", sizeof options->robot - 1);
    }
}

error_t command_line_option(int key, char *argument, const struct argp_state *state, struct command_line *options)
{
    switch (key) {
    case 'j':
        options->json = argument;
        return 0;
    case 'o':
        options->output = argument;
        return 0;
    case 'r':
        set_robot(state, argument, options);
        return 0;
    case 's':
        options->seed = (uint64_t)command_line_whole(state, "--seed", argument, 0, COMMAND_LINE_SEED_MAX);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

void command_line_take(const struct argp_state *state, const char *what, const char *argument, const char **place)
{
    if (*place != NULL) {
        command_line_refuse(state, "one %s only, not also %s", what, argument);
    }
    *place = argument;
}

void command_line_need_file(const struct argp_state *state, const char *path)
{
    if (path != NULL && strcmp(path, "-") == 0) {
        command_line_refuse(state, "--json needs a file: standard output tells what happens as it runs");
    }
}

void command_line_take_robot(const struct argp_state *state, const char *argument, struct command_line *options)
{
    if (options->robot[0] != '\0') {
        command_line_refuse(state, "one robot only, not also %s", argument);
    }
    set_robot(state, argument, options);
}
