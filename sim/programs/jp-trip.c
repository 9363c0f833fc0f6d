/* Missions of robots that differ from their file: learn, predict, drive. One JSON object a line for each seed. */
#include <argp.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"
#include "../output.h"
#include "../progress.h"
#include "../trip.h"

/* Of the interval that the measured energy shall fall in with 95 %. */
#define INTERVAL_DEVIATIONS 1.96

struct arguments {
    const char *path;
    const char *output;
    long seed;
    long count;
    bool disturbed;
};

static const char *const faults[TRIP_FAULTS] = {NULL, "pushes", "dropped samples", "current offset"};
static const char *const changes[TRIP_CHANGES] = {NULL, "ground", "payload"};
static const char *const outcomes[] = {"done", "fell", "stopped"};

static long parse_number(const char *option, const char *text, long low, long high, struct argp_state *state)
{
    char *end;
    long value = strtol(text, &end, 10);

    if (*text == '\0' || *end != '\0' || value < low || value > high) {
        argp_failure(state, ERROR_EXIT, 0, "%s %s: must be a whole number from %ld to %ld", option, text, low, high);
    }
    return value;
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case 's':
        arguments->seed = parse_number("--seed", argument, 0, 1000000000, state);
        return 0;
    case 'n':
        arguments->count = parse_number("--count", argument, 1, 1000000, state);
        return 0;
    case 'o':
        arguments->output = argument;
        return 0;
    case 'f':
        arguments->disturbed = true;
        return 0;
    case ARGP_KEY_ARG:
        if (arguments->path != NULL) {
            argp_failure(state, ERROR_EXIT, 0, "one robot file only, not also %s", argument);
        }
        arguments->path = argument;
        return 0;
    case ARGP_KEY_END:
        if (arguments->path == NULL) {
            argp_failure(state, ERROR_EXIT, 0, "a robot file is needed, such as sim/robots/courier24.cfg");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static json_t *json_variation(const struct variation *variation)
{
    json_t *object = json_object();

    for (size_t i = 0; i < variation_member_count; i++) {
        json_object_set_new(object, variation_members[i].column,
                            json_real(variation_value(variation, &variation_members[i])));
    }
    return object;
}

static json_t *json_trip(const struct trip *trip, const char *robot)
{
    const double error = trip->measured - trip->predicted;
    const double limit = INTERVAL_DEVIATIONS * trip->deviation;

    return json_pack("{s:I, s:s, s:o, s:s?, s:s?, s:s, s:i, s:f, s:f, s:f, s:f, s:b, s:f, s:{s:b, s:b, s:b},"
                     " s:{s:f, s:f}, s:f, s:i}",
                     "seed", (json_int_t)trip->seed, "robot", robot, "variation", json_variation(&trip->variation),
                     "fault", faults[trip->fault], "change", changes[trip->change], "outcome", outcomes[trip->outcome],
                     "segments", (int)trip->segments, "seconds", trip->seconds, "predicted_j", trip->predicted, "std_j",
                     trip->deviation, "measured_j", trip->measured, "inside", error >= -limit && error <= limit,
                     "prior_predicted_j", trip->unlearned, "reserve", "asked", trip->available > 0, "answer",
                     trip->answer, "true", trip->measured <= trip->available, "learned", "ground_friction",
                     trip->ground, "payload_kg", trip->payload, "charge_used", trip->charge, "rejected",
                     (int)trip->rejected);
}

static bool print_trip(const struct trip *trip, const char *robot)
{
    json_t *object = json_trip(trip, robot);
    bool printed =
        object != NULL && json_dumpf(object, stdout, JSON_COMPACT | JSON_REAL_PRECISION(9)) == 0 && puts("") >= 0;

    json_decref(object);
    if (!printed) {
        error_line("standard output: cannot be written; redirect it elsewhere");
    }
    return printed;
}

/* As jp-plan --parameters reads them. */
static json_t *json_parameters(const struct trip *trip, const struct robot_file *file)
{
    json_t *a = json_array();
    json_t *b = json_array();

    for (size_t i = 0; i < JP_ENERGY_TERMS; i++) {
        json_array_append_new(a, json_real((double)trip->learned.a[i] / JP_Q16_ONE));
    }
    for (size_t i = 0; i < sizeof trip->learned.b / sizeof trip->learned.b[0]; i++) {
        json_array_append_new(b, json_real((double)trip->learned.b[i] / JP_Q16_ONE));
    }
    return json_pack("{s:s, s:i, s:o, s:o, s:f}", "robot", file->name, "version", (int)trip->version, "a", a, "b", b,
                     "mass", 1 + trip->payload / (file->body.mass_kg + 2 * file->wheel.mass_kg));
}

static bool write_parameters(const char *directory, const struct trip *trip, const struct robot_file *file)
{
    struct output output;

    return output_directory(directory) &&
           output_open_json(&output, directory, "parameters.json", json_parameters(trip, file)) &&
           output_commit(&output, 1);
}

static bool run(const struct arguments *arguments)
{
    struct robot_file file;
    struct trip trip = {0};

    if (!robot_file_load(arguments->path, &file)) {
        return false;
    }

    const struct robot_entry *entry = rig_find_robot(file.name);

    for (long i = 0; entry != NULL && i < arguments->count; i++) {
        if (!trip_run(&trip, entry, &file, (uint64_t)(arguments->seed + i), arguments->disturbed) ||
            !print_trip(&trip, file.name)) {
            return false;
        }
        progress_show("missions", (size_t)i + 1, (size_t)arguments->count);
    }
    progress_end();
    return entry != NULL && fflush(stdout) == 0 &&
           (arguments->output == NULL || write_parameters(arguments->output, &trip, &file));
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        {"seed", 's', "SEED", 0, "of the first mission (1)", 0},
        {"count", 'n', "N", 0, "missions, of seeds one after the other (1)", 0},
        {"output", 'o', "DIR", 0, "where parameters.json goes: what the last robot learned, for jp-plan --parameters",
         0},
        {"faults", 'f', NULL, 0, "with faults, and with changes of ground and payload", 0},
        {0},
    };
    static const struct argp argp = {options,
                                     parse_option,
                                     "ROBOT.cfg",
                                     "Drives robots that differ from their file: each learns on a way, predicts what a "
                                     "route will take, and drives it.",
                                     NULL,
                                     NULL,
                                     NULL};
    struct arguments arguments = {.seed = 1, .count = 1};

    argp_err_exit_status = ERROR_EXIT;
    (void)argp_parse(&argp, argc, argv, 0, NULL, &arguments);
    return run(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
