/** The main program of a property test: its options --count N, --seed S, --json FILE and --verbose, its tests, its
 * figures. */
#ifndef JOULEPATH_TESTS_SUPPORT_OPTIONS_H
#define JOULEPATH_TESTS_SUPPORT_OPTIONS_H

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/figures.h"
#include "unity.h"

struct options {
    unsigned long count;     /**< cases; above 0 */
    unsigned long long seed; /**< above 0 */
    const char *json;        /**< where figures go; NULL: nowhere */
    bool verbose;
};

static inline bool parse_number(const char *text, unsigned long long *number)
{
    char *end = NULL;

    *number = strtoull(text, &end, 10);
    return end != text && *end == '\0' && *number > 0;
}

/** Of an option with a value; false: it is none, or the value is bad. */
static inline bool parse_value(struct options *options, const char *name, const char *value)
{
    unsigned long long number = 0;

    if (strcmp(name, "--json") == 0) {
        options->json = value;
        return true;
    }
    if (!parse_number(value, &number)) {
        return false;
    }
    if (strcmp(name, "--count") == 0) {
        options->count = (unsigned long)number;
        return true;
    }
    options->seed = number;
    return strcmp(name, "--seed") == 0;
}

/** The options over their defaults. On a bad one the program ends with exit status 2 and one line. */
static inline struct options parse_options(int argc, char **argv, struct options options)
{
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--verbose") == 0) {
            options.verbose = true;
        } else if (i + 1 < argc && parse_value(&options, argv[i], argv[i + 1])) {
            i++;
        } else {
            (void)fprintf(stderr, "%s: %s: usage: --count N, --seed S (above 0), --json FILE, --verbose\n", argv[0],
                          argv[i]);
            exit(2);
        }
    }
    return options;
}

/** The program's exit status; before it ends, `add_figures` gives the figures where --json asks for them. */
static inline int end_property(const struct options *options, int failures, void (*add_figures)(json_t *))
{
    if (options->json != NULL && add_figures != NULL) {
        json_t *figures = json_array();

        add_figures(figures);
        figures_write(figures, options->json);
    }
    return failures;
}

/** The main program after its options; add_figures may be NULL. A macro, since Unity names the file that it stands in.
 */
#define RUN_PROPERTY(options, add_figures)                                                                             \
    ((void)printf("seed %llu\n", (options).seed), UNITY_BEGIN(), run_tests(),                                          \
     end_property(&(options), UNITY_END(), add_figures))

#endif
