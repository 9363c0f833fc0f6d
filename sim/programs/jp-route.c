/* Plans routes segment by segment and jointly and compares them. */
#include <joulepath/tables.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/energy_kind.h"
#include "sim/balancer/rig.h"
#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/base/progress.h"
#include "sim/files/model_file.h"
#include "sim/missions/route_plan.h"

#define Q16_ONE            65536.0
#define Q24_ONE            16777216.0
#define DEGREES_PER_RADIAN (180 / M_PI)
#define NUMBER_DIGITS      12
#define LABEL_WIDTH        8
#define COLUMN_WIDTH       9
#define PLANS              2

enum { OPTION_SETTLED = COMMAND_LINE_OWN, OPTION_LEGS };

struct arguments {
    struct command_line common;
    char **route_paths;
    size_t route_count;
    const char *model; /* identified, published or a path */
    enum energy_kind energy;
    bool settled;
    uint16_t legs;
};

/* What routes are planned with. */
struct setting {
    struct robot_file file;
    struct jp_energy_model model;
    struct route_planner planner;
};

/* ---- Command line ---- */

static bool is_identified(const struct arguments *arguments)
{
    return strcmp(arguments->model, "identified") == 0;
}

static void check(const struct arguments *arguments, const struct argp_state *state)
{
    if (arguments->common.robot[0] == '\0' || arguments->route_count == 0) {
        command_line_refuse(state, "--robot and at least one route are needed");
    }
    if (arguments->energy == ENERGY_BATTERY && !is_identified(arguments)) {
        command_line_refuse(state, "--energy battery: only the identified models know it; leave out --model");
    }
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case 'm':
        arguments->model = argument;
        return 0;
    case 'e':
        if (!energy_kind_parse(argument, &arguments->energy)) {
            command_line_refuse(state, "--energy %s: must be motor or battery", argument);
        }
        return 0;
    case OPTION_SETTLED:
        arguments->settled = true;
        return 0;
    case OPTION_LEGS:
        arguments->legs = (uint16_t)command_line_whole(state, "--legs", argument, 1, JP_ROUTE_LEGS_MAX);
        return 0;
    case ARGP_KEY_ARG:
        arguments->route_paths[arguments->route_count++] = argument;
        return 0;
    case ARGP_KEY_END:
        check(arguments, state);
        return 0;
    default:
        return command_line_option(key, argument, state, &arguments->common);
    }
}

/* ---- Setting ---- */

static bool load_model(const struct arguments *arguments, const struct robot_entry *entry,
                       struct jp_energy_model *model)
{
    if (strcmp(arguments->model, "published") == 0) {
        *model = jp_energy_model_published;
        return true;
    }
    if (!is_identified(arguments)) {
        return model_file_load(arguments->model, model);
    }

    const struct jp_energy_model *identified = rig_energy_model(entry, arguments->energy);

    if (identified != NULL) {
        *model = *identified;
    }
    return identified != NULL;
}

/* Only the identified models have a horizon. */
static bool find_horizon(const struct arguments *arguments, const struct robot_entry *entry,
                         const struct jp_horizon **horizon)
{
    *horizon = NULL;
    if (arguments->settled || !is_identified(arguments)) {
        return true;
    }
    *horizon = arguments->energy == ENERGY_BATTERY ? entry->horizon_battery : entry->horizon;
    if (*horizon == NULL) {
        error_line("%s: no table of transients; run make horizon ROBOT=%s, or plan with --settled", entry->name,
                   entry->name);
    }
    return *horizon != NULL;
}

static bool prepare(const struct arguments *arguments, struct setting *setting)
{
    const char *field = NULL;

    if (!robot_file_load(arguments->common.robot, &setting->file)) {
        return false;
    }

    const struct robot_entry *entry = rig_find_robot(setting->file.name);

    if (entry == NULL || !load_model(arguments, entry, &setting->model) ||
        !find_horizon(arguments, entry, &setting->planner.horizon)) {
        return false;
    }
    if (jp_segment_limits_check(&entry->config->limits, &setting->model, &field) != JP_OK) {
        error_line("%s: %s: does not go with the limits of %s; correct the model", arguments->model, field,
                   entry->name);
        return false;
    }
    setting->planner.model = &setting->model;
    setting->planner.limits = &entry->config->limits;
    setting->planner.legs = arguments->legs;
    return true;
}

/* ---- Results ---- */

static double total(const struct jp_segment *segments, size_t count)
{
    double energy = 0;

    for (size_t i = 0; i < count; i++) {
        energy += segments[i].energy / Q16_ONE;
    }
    return energy;
}

static double gain_percent(double greedy, double joint)
{
    return 100 * (greedy - joint) / greedy;
}

static double seconds(const struct jp_segment *segments, size_t count)
{
    double sum = 0;

    for (size_t i = 0; i < count; i++) {
        sum += segments[i].command.duration / Q16_ONE;
    }
    return sum;
}

static void print_half(const struct jp_segment *segment)
{
    const struct jp_segment_command *command = &segment->command;

    (void)printf(" %*.3f %*.4f %*.4f %*.2f %*.2f %*.3f", COLUMN_WIDTH, command->duration / Q16_ONE, COLUMN_WIDTH,
                 command->motion.speed / Q24_ONE, COLUMN_WIDTH, command->motion.turn_rate / Q24_ONE, COLUMN_WIDTH,
                 segment->arc / Q24_ONE * DEGREES_PER_RADIAN, COLUMN_WIDTH,
                 command->turn / Q24_ONE * DEGREES_PER_RADIAN, COLUMN_WIDTH, segment->energy / Q16_ONE);
}

static void print_heads(void)
{
    static const char *const heads[] = {"T s", "v m/s", "w rad/s", "arc deg", "turn deg", "E J"};
    static const char *const plans[PLANS] = {"greedy", "joint"};
    const int width = (int)(sizeof heads / sizeof heads[0]) * (COLUMN_WIDTH + 1);

    (void)printf("%-*s %*s %*s\n", LABEL_WIDTH, "", width - 1, plans[0], width - 1, plans[1]);
    (void)printf("%-*s", LABEL_WIDTH, "segment");
    for (size_t i = 0; i < PLANS * sizeof heads / sizeof heads[0]; i++) {
        (void)printf(" %*s", COLUMN_WIDTH, heads[i % (sizeof heads / sizeof heads[0])]);
    }
    (void)printf("\n");
}

static void print_sums(const struct jp_segment *segments, size_t count)
{
    (void)printf(" %*.3f %*s %*s %*s %*s %*.3f", COLUMN_WIDTH, seconds(segments, count), COLUMN_WIDTH, "", COLUMN_WIDTH,
                 "", COLUMN_WIDTH, "", COLUMN_WIDTH, "", COLUMN_WIDTH, total(segments, count));
}

static void print_route(const char *path, const struct route_file *route, const struct route_plan *plan)
{
    (void)printf("%s\n", path);
    print_heads();
    for (size_t i = 0; i < route->count; i++) {
        (void)printf("%-*zu", LABEL_WIDTH, i + 1);
        print_half(&plan->greedy[i]);
        print_half(&plan->joint[i]);
        (void)printf("\n");
    }
    (void)printf("%-*s", LABEL_WIDTH, "sum");
    print_sums(plan->greedy, route->count);
    print_sums(plan->joint, route->count);
    (void)printf("\ngain %.3f %%\n\n",
                 gain_percent(total(plan->greedy, route->count), total(plan->joint, route->count)));
}

static json_t *json_segment(const struct jp_segment *segment)
{
    const struct jp_segment_command *command = &segment->command;

    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "duration_s", command->duration / Q16_ONE, "speed_m_s",
                     command->motion.speed / Q24_ONE, "turn_rate_rad_s", command->motion.turn_rate / Q24_ONE, "arc_rad",
                     segment->arc / Q24_ONE, "turn_rad", command->turn / Q24_ONE, "length_m", segment->length / Q16_ONE,
                     "energy_j", segment->energy / Q16_ONE);
}

static json_t *json_segments(const struct jp_segment *segments, size_t count)
{
    json_t *array = json_array();

    for (size_t i = 0; i < count; i++) {
        (void)json_array_append_new(array, json_segment(&segments[i]));
    }
    return array;
}

static json_t *json_route(const struct arguments *arguments, const struct setting *setting, const char *path,
                          const struct route_file *route, const struct route_plan *plan)
{
    const double greedy = total(plan->greedy, route->count);
    const double joint = total(plan->joint, route->count);

    return json_pack("{s:s, s:s, s:s, s:o, s:s, s:b, s:i, s:o, s:o, s:f, s:f, s:f}", "route", path, "robot",
                     setting->file.name, "model", arguments->model, "parameters", model_file_json(&setting->model),
                     "energy", energy_kind_name(arguments->energy), "settled", setting->planner.horizon == NULL, "legs",
                     setting->planner.legs, "greedy", json_segments(plan->greedy, route->count), "joint",
                     json_segments(plan->joint, route->count), "greedy_j", greedy, "joint_j", joint, "gain_percent",
                     gain_percent(greedy, joint));
}

static void write_json(json_t *value, FILE *stream)
{
    (void)json_dumpf(value, stream, JSON_REAL_PRECISION(NUMBER_DIGITS));
    (void)fputc('\n', stream);
    json_decref(value);
}

/* ---- Routes ---- */

static bool plan_route(const struct arguments *arguments, const struct setting *setting, const char *path, FILE *json)
{
    static struct route_file route;
    static struct route_plan plan;

    if (!route_file_load(path, &route) || !route_plan_make(&setting->planner, path, &route, &plan)) {
        return false;
    }
    if (json != stdout) {
        print_route(path, &route, &plan);
    }
    if (json != NULL) {
        write_json(json_route(arguments, setting, path, &route, &plan), json);
    }
    return true;
}

static bool plan_routes(const struct arguments *arguments, const struct setting *setting, FILE *json)
{
    bool planned = true;

    for (size_t i = 0; i < arguments->route_count && planned; i++) {
        planned = plan_route(arguments, setting, arguments->route_paths[i], json);
        progress_show("routes", i + 1, arguments->route_count);
    }
    progress_end();
    return planned;
}

static bool run(const struct arguments *arguments)
{
    static struct setting setting;
    FILE *json = NULL;

    if (!prepare(arguments, &setting)) {
        return false;
    }
    if (arguments->common.json != NULL) {
        json = output_open(NULL, arguments->common.json);
        if (json == NULL) {
            return false;
        }
    }
    if (!plan_routes(arguments, &setting, json)) {
        output_discard();
        return false;
    }
    return output_commit();
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_ROBOT(""),
        {"model", 'm', "MODEL", 0, "energy model: identified (default), published, or a JSON file of its fields", 0},
        {"energy", 'e', "KIND", 0, "of the identified model: motor (default) or battery", 0},
        {"settled", OPTION_SETTLED, NULL, 0, "every segment starts settled, as in the paper, and lasts Ts at least", 0},
        {"legs", OPTION_LEGS, "N", 0,
         "segments planned at once; of longer routes one is driven, then N are planned again (64)", 0},
        OPTION_JSON,
        {0},
    };
    static const struct argp argp = {
        options,
        parse_option,
        "ROUTE...",
        "Plans routes for least energy, segment by segment (greedy) and all segments together (joint), and compares "
        "them.\vA ROUTE is a CSV file with the columns x_m, y_m and, for the start, heading_deg, or a JSON file "
        "{\"points_m\": [[x, y], ...], \"heading_deg\": 0}; its first point is the start.",
        NULL,
        NULL,
        NULL};
    struct arguments arguments = {.model = "identified", .legs = JP_ROUTE_LEGS_MAX};

    arguments.route_paths = calloc((size_t)argc, sizeof *arguments.route_paths);
    if (arguments.route_paths == NULL) {
        error_line("jp-route: no memory for so many routes; give fewer");
        return ERROR_EXIT;
    }
    command_line_parse(&argp, argc, argv, &arguments);

    const bool done = run(&arguments);

    free(arguments.route_paths);
    return done ? EXIT_SUCCESS : ERROR_EXIT;
}
