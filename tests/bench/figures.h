/** The figures of a bench, for tools/measure/figures.py. */
#ifndef JOULEPATH_TESTS_BENCH_FIGURES_H
#define JOULEPATH_TESTS_BENCH_FIGURES_H

#include <argp.h>
#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "sim/base/error.h"

/** What a figure must be; `op` is NULL for one that is only shown. */
struct figure_bar {
    const char *op; /**< "<=", ">=" or "==" */
    double value;
};

static const struct figure_bar no_bar = {NULL, 0};

static inline struct figure_bar equal_to(double value)
{
    return (struct figure_bar){"==", value};
}

static inline struct figure_bar at_most(double value)
{
    return (struct figure_bar){"<=", value};
}

static inline struct figure_bar at_least(double value)
{
    return (struct figure_bar){">=", value};
}

/** Appends a figure that `command` makes again; its name is a format. */
__attribute__((format(printf, 6, 7))) static inline void figures_add(json_t *figures, const char *command, double value,
                                                                     const char *unit, struct figure_bar bar,
                                                                     const char *format, ...)
{
    json_t *bound = bar.op == NULL ? json_null() : json_pack("{s:s, s:f}", "op", bar.op, "value", bar.value);
    char name[256];
    va_list arguments;

    va_start(arguments, format);
    (void)vsnprintf(name, sizeof name, format, arguments);
    va_end(arguments);
    if (json_array_append_new(figures, json_pack("{s:s, s:f, s:s, s:o, s:s}", "name", name, "value", value, "unit",
                                                 unit, "bound", bound, "command", command)) != 0) {
        error_line("%s: no memory", name);
        exit(1);
    }
}

static inline error_t figures_parse_option(int key, char *argument, struct argp_state *state)
{
    if (key != 'r') {
        return ARGP_ERR_UNKNOWN;
    }
    *(const char **)state->input = argument;
    return 0;
}

/** Reads the command line of a bench whose only option is --rows FILE; NULL without it. */
static inline const char *figures_rows_path(int argc, char **argv, const char *purpose)
{
    static const struct argp_option options[] = {{"rows", 'r', "FILE", 0, "write the rows of a table to FILE", 0}, {0}};
    const struct argp parser = {options, figures_parse_option, NULL, purpose, NULL, NULL, NULL};
    const char *path = NULL;

    argp_err_exit_status = ERROR_EXIT;
    (void)argp_parse(&parser, argc, argv, 0, NULL, &path);
    return path;
}

/** Writes the rows, unless the path is NULL, and frees them. */
static inline void figures_write_rows(json_t *rows, const char *path)
{
    if (path != NULL && json_dump_file(rows, path, JSON_INDENT(1)) != 0) {
        error_line("%s: cannot be written", path);
        exit(ERROR_EXIT);
    }
    json_decref(rows);
}

/** Writes and frees them. */
static inline void figures_write(json_t *figures, const char *path)
{
    if (json_dump_file(figures, path, JSON_INDENT(2) | JSON_REAL_PRECISION(10)) != 0) {
        error_line("%s: cannot be written", path);
        exit(1);
    }
    json_decref(figures);
}

/** Prints and frees them. */
static inline void figures_print(json_t *figures)
{
    if (json_dumpf(figures, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(10)) != 0 || printf("\n") < 0) {
        error_line("stdout: cannot write the figures");
        exit(1);
    }
    json_decref(figures);
}

#endif
