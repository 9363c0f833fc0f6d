/**
 * Command lines of the programs. What several programs have is spelt alike and means the same in all:
 *
 *   -b, --bus BUS          the CAN bus to be on
 *   -e, --energy KIND      motor or battery
 *   -j, --json FILE        write the result to FILE as well; with -, to standard output instead of the table, but for
 *                          programs that tell there what happens as they run
 *   -m, --model MODEL      energy model
 *   -n, --count N          how many
 *   -o, --output DIR       folder of the results, made if need be; build/NAME of the program jp-NAME
 *   -p, --parameters FILE  what a robot has learned
 *   -r, --robot ROBOT      a robot's file, or the name of one in sim/robots/
 *   -s, --seed N           of all that is random
 *   -V, --version, -?, --help and --usage
 *
 * What one program has alone has no letter. What is wrong is said in one line, and the program ends with ERROR_EXIT.
 */
#ifndef JOULEPATH_SIM_BASE_COMMAND_LINE_H
#define JOULEPATH_SIM_BASE_COMMAND_LINE_H

#include <argp.h>
#include <stdbool.h>
#include <stdint.h>

#define COMMAND_LINE_PATH_SIZE 1024

/** Seeds are at most this. */
#define COMMAND_LINE_SEED_MAX INT64_C(1000000000000000000)

/** The first key of options without a letter. */
#define COMMAND_LINE_OWN 256

#define OPTION_JSON                                                                                                    \
    {                                                                                                                  \
        "json", 'j', "FILE", 0, "also as JSON to FILE; with -, to standard output instead of the table", 0             \
    }
/** Of a program that tells on standard output what happens as it runs: only to a file. */
#define OPTION_JSON_COUNTS                                                                                             \
    {                                                                                                                  \
        "json", 'j', "FILE", 0, "what was counted, also as JSON to FILE", 0                                            \
    }
#define OPTION_OUTPUT(folder)                                                                                          \
    {                                                                                                                  \
        "output", 'o', "DIR", 0, "folder of the results (" folder ")", 0                                               \
    }
#define OPTION_ROBOT(comment)                                                                                          \
    {                                                                                                                  \
        "robot", 'r', "ROBOT", 0, "its file, or the name of one in sim/robots" comment, 0                              \
    }
#define OPTION_SEED(comment)                                                                                           \
    {                                                                                                                  \
        "seed", 's', "N", 0, comment " (1)", 0                                                                         \
    }

/** The common options that have a value. */
struct command_line {
    const char *output;                 /**< NULL: not given */
    const char *json;                   /**< NULL: not given */
    char robot[COMMAND_LINE_PATH_SIZE]; /**< path of its file; empty: not given */
    uint64_t seed;
};

/** Reads the command line into `input`, by argp; before it, output_start(). */
void command_line_parse(const struct argp *argp, int argc, char **argv, void *input);

/** Takes one of --json, --output, --robot and --seed; ARGP_ERR_UNKNOWN: another one. */
error_t command_line_option(int key, char *argument, const struct argp_state *state, struct command_line *options);

/** Ends the program after one line. */
void command_line_refuse(const struct argp_state *state, const char *format, ...)
    __attribute__((noreturn, format(printf, 2, 3)));

/** Refuses standard output as the file of --json, which may be NULL. */
void command_line_need_file(const struct argp_state *state, const char *path);

/** Takes the one argument that is no option; `what` it is. */
void command_line_take(const struct argp_state *state, const char *what, const char *argument, const char **place);

/** The same of a robot. */
void command_line_take_robot(const struct argp_state *state, const char *argument, struct command_line *options);

/** The value of an option that is a whole number, in decimal digits, or a number. */
int64_t command_line_whole(const struct argp_state *state, const char *option, const char *text, int64_t low,
                           int64_t high);
double command_line_real(const struct argp_state *state, const char *option, const char *text, double low, double high);

#endif
