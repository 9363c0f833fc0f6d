/** The command line of the property tests: --count N, --seed S, --json FILE, --verbose. */
#ifndef JOULEPATH_TESTS_SUPPORT_OPTIONS_H
#define JOULEPATH_TESTS_SUPPORT_OPTIONS_H

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

#endif
