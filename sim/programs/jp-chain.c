/* Drives chains of random segments back to back and records the energies of each. */
#include <argp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../chain.h"
#include "../error.h"
#include "../output.h"
#include "../progress.h"
#include "../variation.h"

#define CHAINS_MAX   100000
#define SEGMENTS_MAX 100000

/** A rig's noise, the commands and the variation of a chain: independent streams. */
enum stream { STREAM_NOISE, STREAM_COMMANDS, STREAM_VARIATION, STREAMS };

struct arguments {
    const char *path;
    const char *output;
    long chains;
    long segments;
    long seed;
    struct chain_ranges ranges;
    const char *variation; /* NULL: none */
    bool vary;
    const char *change; /* NULL: none */
    long change_at;     /* -1: not given */
};

struct campaign {
    const struct arguments *arguments;
    const struct robot_entry *entry;
    struct robot_file file;
    struct chain_record *records; /* of the present chain */
    size_t rows;
    size_t falls;
    size_t faults;
    uint64_t ticks;
    uint64_t saturated_ticks;
    double model;
    double battery;
    double wall_seconds;
};

/** One chain: its robot, and that after the change. */
struct drive {
    struct variation variation;
    struct variation changed;
    struct robot_file robot;
    struct robot_file changed_robot;
};

/* ---- Command line ---- */

static double number(const char *option, const char *text, double low, double high, const struct argp_state *state)
{
    char *end;
    const double value = strtod(text, &end);

    if (end == text || *end != '\0' || !(value >= low && value <= high)) {
        argp_failure(state, ERROR_EXIT, 0, "%s %s: must be a number from %g to %g", option, text, low, high);
    }
    return value;
}

static long whole(const char *option, const char *text, long low, long high, const struct argp_state *state)
{
    char *end;
    const long value = strtol(text, &end, 10);

    if (end == text || *end != '\0' || value < low || value > high) {
        argp_failure(state, ERROR_EXIT, 0, "%s %s: must be a whole number from %ld to %ld", option, text, low, high);
    }
    return value;
}

enum {
    OPTION_SHORTEST = 256,
    OPTION_LONGEST,
    OPTION_SPEED_SHARE,
    OPTION_TURN_RATE_SHARE,
    OPTION_TURN_SHARE,
    OPTION_VARIATION,
    OPTION_VARY,
    OPTION_CHANGE,
    OPTION_CHANGE_AT,
};

static void check(const struct arguments *arguments, const struct argp_state *state)
{
    if (arguments->path == NULL || arguments->output == NULL) {
        argp_failure(state, ERROR_EXIT, 0, "a robot file and --output are needed");
    }
    if (arguments->ranges.shortest > arguments->ranges.longest) {
        argp_failure(state, ERROR_EXIT, 0, "--shortest %g: must not be above --longest %g", arguments->ranges.shortest,
                     arguments->ranges.longest);
    }
    if (arguments->vary && arguments->variation != NULL) {
        argp_failure(state, ERROR_EXIT, 0, "give --vary or --variation, not both");
    }
    if ((arguments->change == NULL) != (arguments->change_at < 0)) {
        argp_failure(state, ERROR_EXIT, 0, "give both --change and --change-at, or neither");
    }
    if (arguments->change_at >= arguments->segments) {
        argp_failure(state, ERROR_EXIT, 0, "--change-at %ld: must be below --segments %ld", arguments->change_at,
                     arguments->segments);
    }
}

static error_t parse_range(int key, const char *argument, struct chain_ranges *ranges, const struct argp_state *state)
{
    switch (key) {
    case OPTION_SHORTEST:
        ranges->shortest = number("--shortest", argument, 0.05, 600, state);
        return 0;
    case OPTION_LONGEST:
        ranges->longest = number("--longest", argument, 0.05, 600, state);
        return 0;
    case OPTION_SPEED_SHARE:
        ranges->speed_share = number("--speed-share", argument, 0, 1, state);
        return 0;
    case OPTION_TURN_RATE_SHARE:
        ranges->turn_rate_share = number("--turn-rate-share", argument, 0, 1, state);
        return 0;
    case OPTION_TURN_SHARE:
        ranges->turn_share = number("--turn-share", argument, 0, 1, state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case 'o':
        arguments->output = argument;
        return 0;
    case 'c':
        arguments->chains = whole("--chains", argument, 1, CHAINS_MAX, state);
        return 0;
    case 'n':
        arguments->segments = whole("--segments", argument, 1, SEGMENTS_MAX, state);
        return 0;
    case 's':
        arguments->seed = whole("--seed", argument, 0, 1000000000, state);
        return 0;
    case OPTION_VARIATION:
        arguments->variation = argument;
        return 0;
    case OPTION_VARY:
        arguments->vary = true;
        return 0;
    case OPTION_CHANGE:
        arguments->change = argument;
        return 0;
    case OPTION_CHANGE_AT:
        arguments->change_at = whole("--change-at", argument, 1, SEGMENTS_MAX, state);
        return 0;
    case ARGP_KEY_ARG:
        if (arguments->path != NULL) {
            argp_failure(state, ERROR_EXIT, 0, "one robot file only, not also %s", argument);
        }
        arguments->path = argument;
        return 0;
    case ARGP_KEY_END:
        check(arguments, state);
        return 0;
    default:
        return parse_range(key, argument, &arguments->ranges, state);
    }
}

/* ---- Driving ---- */

static uint64_t stream_seed(const struct arguments *arguments, size_t chain, enum stream stream)
{
    return (((uint64_t)arguments->seed << 32) + chain) * STREAMS + stream;
}

static bool prepare(const struct campaign *campaign, size_t chain, struct drive *drive)
{
    const struct arguments *arguments = campaign->arguments;

    drive->variation = variation_none;
    if (arguments->vary) {
        struct random random;
        random_init(&random, stream_seed(arguments, chain, STREAM_VARIATION));
        variation_draw(&random, &drive->variation);
    }
    if (arguments->variation != NULL && !variation_parse("--variation", arguments->variation, &drive->variation)) {
        return false;
    }
    drive->changed = drive->variation;
    if (arguments->change != NULL && !variation_parse("--change", arguments->change, &drive->changed)) {
        return false;
    }
    variation_apply(&drive->variation, &campaign->file, &drive->robot);
    variation_apply(&drive->changed, &campaign->file, &drive->changed_robot);
    return robot_file_check(arguments->vary ? "--vary" : "--variation", &drive->robot) &&
           robot_file_check("--change", &drive->changed_robot);
}

static void count(struct campaign *campaign, const struct chain_record *record)
{
    campaign->rows++;
    campaign->falls += record->end == CHAIN_FELL;
    campaign->faults += record->end == CHAIN_FAULT;
    campaign->ticks += record->ticks;
    campaign->saturated_ticks += record->saturated_ticks;
    campaign->model += record->model;
    campaign->battery += record->battery;
}

/* ---- Table ---- */

static void write_head(FILE *table)
{
    (void)fprintf(table, "chain,segment,v_m_s,w_rad_s,turn_rad,duration_s,ticks,end,faults,e_model_j,e_battery_j,"
                         "plant_motor_j,plant_electrical_j,bus_v,charge_as,saturated_ticks");
    for (size_t i = 0; i < variation_member_count; i++) {
        (void)fprintf(table, ",%s", variation_members[i].column);
    }
    (void)fprintf(table, ",x_m,y_m,yaw_rad,pitch_rad,wheel_rate_rad_s,pitch_rate_rad_s,yaw_rate_rad_s,u_left_v,"
                         "u_right_v,wheel_error_rad,yaw_error_rad,wheel_integral_rad_s,yaw_integral_rad_s,"
                         "reference_wheel_rate_rad_s,reference_yaw_rate_rad_s,wheel_lag_rad,yaw_lag_rad\n");
}

static void write_result(const struct chain_record *record, double tick_seconds, FILE *table)
{
    static const char *const ends[] = {[CHAIN_DRIVEN] = "driven", [CHAIN_FELL] = "fell", [CHAIN_FAULT] = "fault"};

    (void)fprintf(table, "%.9f,%.9f,%.9f,%.9g,%u,%s,%u,%.9f,%.9f,%.9f,%.9f,%.6f,%.9f,%u", record->command.speed,
                  record->command.turn_rate, record->command.turn, record->commanded_ticks * tick_seconds,
                  record->ticks, ends[record->end], record->faults, record->model, record->battery, record->motor,
                  record->electrical, record->bus_voltage, record->charge, record->saturated_ticks);
}

static void write_variation(const struct variation *variation, FILE *table)
{
    for (size_t i = 0; i < variation_member_count; i++) {
        (void)fprintf(table, ",%.9g", variation_value(variation, &variation_members[i]));
    }
}

static void write_state(const struct chain_state *s, FILE *table)
{
    const double values[] = {s->x,
                             s->y,
                             s->yaw,
                             s->pitch,
                             s->wheel_rate,
                             s->pitch_rate,
                             s->yaw_rate,
                             s->voltage_left,
                             s->voltage_right,
                             s->wheel_error,
                             s->yaw_error,
                             s->wheel_integral,
                             s->yaw_integral,
                             s->reference_wheel_rate,
                             s->reference_yaw_rate,
                             s->wheel_lag,
                             s->yaw_lag};

    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        (void)fprintf(table, ",%.9f", values[i]);
    }
}

static void write_row(const struct campaign *campaign, const struct drive *drive, size_t chain, size_t segment,
                      FILE *table)
{
    const struct arguments *arguments = campaign->arguments;
    const struct chain_record *record = &campaign->records[segment];
    const bool changed = arguments->change != NULL && segment >= (size_t)arguments->change_at;

    (void)fprintf(table, "%zu,%zu,", chain, segment);
    write_result(record, 1.0 / campaign->file.control.rate_hz, table);
    write_variation(changed ? &drive->changed : &drive->variation, table);
    write_state(&record->state, table);
    (void)fputc('\n', table);
}

/* ---- Campaign ---- */

static bool drive_chain(struct campaign *campaign, size_t chain, FILE *table)
{
    const struct arguments *arguments = campaign->arguments;
    struct drive drive;
    const struct chain_change change = {.at = (size_t)arguments->change_at, .robot = &drive.changed_robot};
    struct random random;
    struct rig rig;

    if (!prepare(campaign, chain, &drive) || !rig_init(&rig, campaign->entry, campaign->entry->energy, &drive.robot,
                                                       stream_seed(arguments, chain, STREAM_NOISE))) {
        return false;
    }
    random_init(&random, stream_seed(arguments, chain, STREAM_COMMANDS));
    chain_draw(campaign->records, (size_t)arguments->segments, &campaign->file, &arguments->ranges, &random);

    const size_t driven =
        chain_run(&rig, campaign->records, (size_t)arguments->segments, arguments->change != NULL ? &change : NULL);

    for (size_t i = 0; i < driven; i++) {
        write_row(campaign, &drive, chain, i, table);
        count(campaign, &campaign->records[i]);
    }
    return true;
}

static double now(void)
{
    struct timespec time;

    (void)clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static bool drive_all(struct campaign *campaign, FILE *table)
{
    const size_t chains = (size_t)campaign->arguments->chains;
    const double start = now();
    bool driven = true;

    write_head(table);
    for (size_t i = 0; i < chains && driven; i++) {
        driven = drive_chain(campaign, i, table);
        progress_show("chains", i + 1, chains);
    }
    progress_end();
    campaign->wall_seconds = now() - start;
    return driven;
}

static double simulated_seconds(const struct campaign *campaign)
{
    return (double)campaign->ticks / campaign->file.control.rate_hz;
}

static json_t *json_text(const char *text)
{
    return text == NULL ? json_null() : json_string(text);
}

static json_t *json_summary(const struct campaign *campaign)
{
    const struct arguments *a = campaign->arguments;
    const struct robot_file *file = &campaign->file;

    return json_pack(
        "{s:s, s:I, s:I, s:I, s:{s:f, s:f, s:f, s:f, s:f}, s:b, s:o, s:o, s:o, s:{s:i, s:f, s:f, s:f, s:f, s:f, s:f}, "
        "s:{s:I, s:I, s:I, s:f, s:I, s:f, s:f}}",
        "robot", file->name, "seed", (json_int_t)a->seed, "chains", (json_int_t)a->chains, "segments",
        (json_int_t)a->segments, "ranges", "speed_share", a->ranges.speed_share, "turn_rate_share",
        a->ranges.turn_rate_share, "turn_share", a->ranges.turn_share, "shortest_s", a->ranges.shortest, "longest_s",
        a->ranges.longest, "vary", a->vary ? 1 : 0, "variation", json_text(a->variation), "change",
        json_text(a->change), "change_at", a->change == NULL ? json_null() : json_integer(a->change_at), "nominal",
        "rate_hz", file->control.rate_hz, "motor_resistance_ohm", file->motor.resistance_ohm, "electronics_w",
        file->electronics.power_w, "speed_limit_m_s", file->limits.speed_m_s, "turn_rate_limit_rad_s",
        file->limits.turn_rate_rad_s, "turn_limit_deg", file->limits.turn_deg, "capacity_wh", file->supply.capacity_wh,
        "totals", "segments", (json_int_t)campaign->rows, "falls", (json_int_t)campaign->falls, "faults",
        (json_int_t)campaign->faults, "simulated_s", simulated_seconds(campaign), "saturated_ticks",
        (json_int_t)campaign->saturated_ticks, "e_model_j", campaign->model, "e_battery_j", campaign->battery);
}

static void print(const struct campaign *campaign)
{
    const double seconds = simulated_seconds(campaign);

    (void)printf("%-20s %12s\n", campaign->file.name, "");
    (void)printf("%-20s %12ld\n", "chains", campaign->arguments->chains);
    (void)printf("%-20s %12zu\n", "segments driven", campaign->rows);
    (void)printf("%-20s %12zu\n", "falls", campaign->falls);
    (void)printf("%-20s %12zu\n", "faults", campaign->faults);
    (void)printf("%-20s %12.3f %%\n", "saturated",
                 100.0 * (double)campaign->saturated_ticks / fmax(1.0, (double)campaign->ticks));
    (void)printf("%-20s %12.1f s\n", "driven", seconds);
    (void)printf("%-20s %12.3f J\n", "energy, model", campaign->model);
    (void)printf("%-20s %12.3f J\n", "energy, battery", campaign->battery);
    (void)printf("%-20s %12.0f times real time\n", "pace", seconds / campaign->wall_seconds);
}

static bool write_all(struct campaign *campaign)
{
    const char *directory = campaign->arguments->output;
    struct output outputs[2];

    if (!output_open(&outputs[0], directory, "chain.csv")) {
        return false;
    }
    if (!drive_all(campaign, outputs[0].stream) ||
        !output_open_json(&outputs[1], directory, "chain.json", json_summary(campaign))) {
        output_discard(outputs, 1);
        return false;
    }
    return output_commit(outputs, 2);
}

static bool run(const struct arguments *arguments)
{
    struct campaign campaign = {.arguments = arguments};

    if (!robot_file_load(arguments->path, &campaign.file)) {
        return false;
    }
    campaign.entry = rig_find_robot(campaign.file.name);
    if (campaign.entry == NULL || !output_directory(arguments->output)) {
        return false;
    }
    campaign.records = calloc((size_t)arguments->segments, sizeof *campaign.records);
    if (campaign.records == NULL) {
        error_line("--segments %ld: no memory for so many; choose fewer", arguments->segments);
        return false;
    }

    const bool done = write_all(&campaign);

    if (done) {
        print(&campaign);
    }
    free(campaign.records);
    return done;
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        {"output", 'o', "DIR", 0, "where chain.csv and chain.json go", 0},
        {"chains", 'c', "N", 0, "chains, each from standing (10)", 0},
        {"segments", 'n', "N", 0, "segments of a chain (20)", 0},
        {"seed", 's', "SEED", 0, "of commands, noise and variation (1); neither option below changes the commands", 0},
        {"shortest", OPTION_SHORTEST, "S", 0, "segment (0.5 s)", 0},
        {"longest", OPTION_LONGEST, "S", 0, "segment (10 s)", 0},
        {"speed-share", OPTION_SPEED_SHARE, "X", 0, "of the robot's limit that v is drawn from (1)", 0},
        {"turn-rate-share", OPTION_TURN_RATE_SHARE, "X", 0, "likewise of w (1)", 0},
        {"turn-share", OPTION_TURN_SHARE, "X", 0, "likewise of sigma (1)", 0},
        {"variation", OPTION_VARIATION, "NAME=NUMBER,...", 0,
         "how the robot differs from its file: factors friction, resistance, motor-friction, capacity; payload in kg",
         0},
        {"vary", OPTION_VARY, NULL, 0, "another such robot in each chain, drawn from the seed", 0},
        {"change", OPTION_CHANGE, "NAME=NUMBER,...", 0, "what changes in mid-drive, as in --variation", 0},
        {"change-at", OPTION_CHANGE_AT, "K", 0, "before which segment it changes, counted from 0", 0},
        {0},
    };
    static const struct argp argp = {
        options, parse_option, "ROBOT.cfg", "Drives chains of random segments back to back and records their energies.",
        NULL,    NULL,         NULL};
    struct arguments arguments = {
        .chains = 10,
        .segments = 20,
        .seed = 1,
        .ranges = {.speed_share = 1, .turn_rate_share = 1, .turn_share = 1, .shortest = 0.5, .longest = 10},
        .change_at = -1,
    };

    argp_err_exit_status = ERROR_EXIT;
    (void)argp_parse(&argp, argc, argv, 0, NULL, &arguments);
    return run(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
