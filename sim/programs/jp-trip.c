/* Missions of robots that differ from their file: learn, predict, drive. One JSON object a line for each seed. */
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/energy_unit.h"
#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/base/progress.h"
#include "sim/missions/leg_drive.h"
#include "sim/missions/trip_skid.h"

/* Of the interval that the measured energy shall fall in with 95 %. */
#define INTERVAL_DEVIATIONS 1.96

enum { OPTION_FAULTS = COMMAND_LINE_OWN, OPTION_LEGS };

struct arguments {
    struct command_line common;
    size_t count;
    bool disturbed;
    bool legs;
    enum energy_kind energy;
};

static const char *const faults[TRIP_FAULTS] = {NULL, "pushes", "dropped samples", "current offset"};
static const char *const changes[TRIP_CHANGES] = {NULL, "ground", "payload"};
static const char *const outcomes[] = {"done", "fell", "stopped"};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case 'n':
        arguments->count = (size_t)command_line_whole(state, "--count", argument, 1, 1000000);
        return 0;
    case OPTION_FAULTS:
        arguments->disturbed = true;
        return 0;
    case OPTION_LEGS:
        arguments->legs = true;
        return 0;
    case 'e':
        if (!energy_kind_parse(argument, &arguments->energy)) {
            command_line_refuse(state, "--energy %s: must be motor or battery", argument);
        }
        return 0;
    case ARGP_KEY_ARG:
        command_line_take_robot(state, argument, &arguments->common);
        return 0;
    case ARGP_KEY_END:
        if (arguments->common.robot[0] == '\0') {
            command_line_refuse(state, "a robot is needed, such as courier24");
        }
        return 0;
    default:
        return command_line_option(key, argument, state, &arguments->common);
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

/* `variation` and `learned`: what the robot is, and what it has learned of that; taken over. */
static json_t *json_trip(const struct trip *trip, const char *robot, json_t *variation, json_t *learned)
{
    const double error = trip->measured - trip->predicted;
    const double limit = INTERVAL_DEVIATIONS * trip->deviation;

    return json_pack("{s:I, s:s, s:o, s:s?, s:s?, s:s, s:i, s:f, s:f, s:f, s:f, s:b, s:f, s:{s:b, s:b, s:b},"
                     " s:o, s:f, s:i}",
                     "seed", (json_int_t)trip->seed, "robot", robot, "variation", variation, "fault",
                     faults[trip->fault], "change", changes[trip->change], "outcome", outcomes[trip->outcome],
                     "segments", (int)trip->segments, "seconds", trip->seconds, "predicted_j", trip->predicted, "std_j",
                     trip->deviation, "measured_j", trip->measured, "inside", error >= -limit && error <= limit,
                     "prior_predicted_j", trip->unlearned, "reserve", "asked", trip->available > 0, "answer",
                     trip->answer, "true", trip->measured <= trip->available, "learned", learned, "charge_used",
                     trip->charge, "outliers", (int)trip->outliers);
}

static bool print_trip(json_t *object)
{
    (void)json_dumpf(object, stdout, JSON_COMPACT | JSON_REAL_PRECISION(9));
    (void)puts("");
    json_decref(object);
    return output_is_said();
}

/* As jp-plan --parameters reads them. */
static json_t *json_parameters(const struct trip *trip, const struct robot_file *file)
{
    json_t *a = json_array();
    json_t *b = json_array();

    for (size_t i = 0; i < JP_ENERGY_TERMS; i++) {
        json_array_append_new(a, json_real(i == ENERGY_UNIT_TIME_TERM
                                               ? (double)trip->learned.a[i] / JP_Q16_ONE
                                               : energy_unit_joules(&trip->learned, trip->learned.a[i])));
    }
    for (size_t i = 0; i < sizeof trip->learned.b / sizeof trip->learned.b[0]; i++) {
        json_array_append_new(b, json_real(energy_unit_joules(&trip->learned, trip->learned.b[i])));
    }
    return json_pack("{s:s, s:i, s:o, s:o, s:f}", "robot", file->name, "version", (int)trip->version, "a", a, "b", b,
                     "mass", 1 + trip->payload / (file->body.mass_kg + 2 * file->wheel.mass_kg));
}

static bool write_parameters(const char *directory, const struct trip *trip, const struct robot_file *file)
{
    return output_directory(directory) && output_json(directory, "parameters.json", json_parameters(trip, file)) &&
           output_commit();
}

/* A line for each leg, as tools/design/learning_legs.py reads it. */

static void print_leg(const struct leg_drive *drive, unsigned i)
{
    const struct driven_leg *leg = &drive->legs[i];
    const struct jp_leg_energy *expected = &leg->expected;

    (void)printf("%llu", (unsigned long long)drive->seed);
    for (size_t k = 0; k < variation_member_count; k++) {
        (void)printf(",%.9f", variation_value(&drive->variation, &variation_members[k]));
    }
    (void)printf(",%d,%.9f,%.9f", i < LEG_DRIVE_LEARNT ? 0 : 1, (double)expected->travel / JP_Q16_ONE,
                 (double)expected->turning / JP_Q16_ONE);
    for (size_t k = 0; k < JP_LEG_TRANSIENTS; k++) {
        (void)printf(",%.9f", energy_unit_joules(drive->model, expected->transient[k]));
    }
    (void)printf(",%.9f,%.9f\n", energy_unit_joules(drive->model, expected->energy), leg->measured);
}

static bool run_legs(const struct arguments *arguments, const struct robot_entry *entry, const struct robot_file *file)
{
    static struct leg_drive drive;

    (void)fputs("seed", stdout);
    for (size_t k = 0; k < variation_member_count; k++) {
        (void)printf(",%s", variation_members[k].column);
    }
    (void)puts(",route,travel,turning,speeding_j,pushing_j,bending_j,expected_j,measured_j");
    for (size_t i = 0; i < arguments->count; i++) {
        if (!leg_drive_run(&drive, entry, arguments->energy, file, arguments->common.seed + i)) {
            return false;
        }
        for (unsigned k = 0; k < LEG_DRIVE_LEGS; k++) {
            print_leg(&drive, k);
        }
        progress_show("robots", i + 1, arguments->count);
    }
    progress_end();
    return output_is_said();
}

static bool run_trips(const struct arguments *arguments, const struct robot_entry *entry, const struct robot_file *file)
{
    struct trip trip = {0};

    for (size_t i = 0; i < arguments->count; i++) {
        if (!trip_run(&trip, entry, file, arguments->common.seed + i, arguments->disturbed) ||
            !print_trip(
                json_trip(&trip, file->name, json_variation(&trip.variation),
                          json_pack("{s:f, s:f}", "ground_friction", trip.ground, "payload_kg", trip.payload)))) {
            return false;
        }
        progress_show("missions", i + 1, arguments->count);
    }
    progress_end();
    return arguments->common.output == NULL || write_parameters(arguments->common.output, &trip, file);
}

/* Of a robot that its sides steer. */

static json_t *json_skid_trip(const struct trip_skid *skid, const char *robot)
{
    const struct skid_variation *variation = &skid->variation;
    const double *factor = skid->factor;

    return json_trip(
        &skid->trip, robot,
        json_pack("{s:f, s:f, s:f, s:f, s:f}", "rolling", variation->rolling, "friction", variation->friction, "mass",
                  variation->mass, "electronics", variation->electronics, "resistance", variation->resistance),
        json_pack("{s:f, s:f, s:f, s:f}", "rolling", factor[JP_SKID_ROLLING], "friction", factor[JP_SKID_FRICTION],
                  "mass", factor[JP_SKID_WEIGHT], "electronics", factor[JP_SKID_ELECTRONICS]));
}

static bool run_skid_trips(const struct arguments *arguments, const struct skid_robot_entry *entry,
                           const struct skid_steer_model *model)
{
    static struct trip_skid skid;

    for (size_t i = 0; i < arguments->count; i++) {
        if (!trip_skid_run(&skid, entry, model, arguments->common.seed + i) ||
            !print_trip(json_skid_trip(&skid, model->name))) {
            return false;
        }
        progress_show("missions", i + 1, arguments->count);
    }
    progress_end();
    return true;
}

static bool run_skid(const struct arguments *arguments)
{
    struct skid_steer_model model;

    if (arguments->disturbed || arguments->legs || arguments->common.output != NULL) {
        error_line("--faults, --legs, --output: are for balancers; leave them out");
        return false;
    }
    if (!skid_robot_load(arguments->common.robot, &model)) {
        return false;
    }

    const struct skid_robot_entry *entry = skid_robot_find(model.name);

    return entry != NULL && run_skid_trips(arguments, entry, &model);
}

static bool run_balancer(const struct arguments *arguments)
{
    struct robot_file file;

    if (!robot_file_load(arguments->common.robot, &file)) {
        return false;
    }

    const struct robot_entry *entry = rig_find_robot(file.name);

    return entry != NULL && (arguments->legs ? run_legs(arguments, entry, &file) : run_trips(arguments, entry, &file));
}

static bool run(const struct arguments *arguments)
{
    char type[CONFIG_NAME_SIZE];

    if (!config_fields_type(arguments->common.robot, type)) {
        return false;
    }
    return strcmp(type, CONFIG_BALANCER) == 0 ? run_balancer(arguments) : run_skid(arguments);
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_SEED("of the first mission"),
        {"count", 'n', "N", 0, "missions, of seeds one after the other (1)", 0},
        {"output", 'o', "DIR", 0, "folder of parameters.json: what the last robot learned, for jp-plan (not kept)", 0},
        {"faults", OPTION_FAULTS, NULL, 0, "with faults, and with changes of ground and payload", 0},
        {"legs", OPTION_LEGS, NULL, 0, "instead: nine routes each, and a line of what each leg took, for make learning",
         0},
        {"energy", 'e', "KIND", 0, "of the legs: motor or battery (motor)", 0},
        {0},
    };
    static const struct argp argp = {options,
                                     parse_option,
                                     "ROBOT",
                                     "Drives robots that differ from their file: each learns on a way, predicts what a "
                                     "route will take, and drives it.",
                                     NULL,
                                     NULL,
                                     NULL};
    struct arguments arguments = {.common = {.seed = 1}, .count = 1};

    command_line_parse(&argp, argc, argv, &arguments);
    return run(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
