/* Drives the patrol robot through a scene, or over a map of others, by several methods and compares them; or on rounds
 * over a map, for hours. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/clearance.h"
#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/bus/bus_open.h"
#include "sim/bus/can_log.h"
#include "sim/bus/local_ecu.h"
#include "sim/missions/patrol_boxes.h"
#include "sim/missions/patrol_bus.h"
#include "sim/missions/patrol_report.h"
#include "sim/missions/patrol_round_report.h"

/** Exit code when the outputs were written but the robot did not arrive. */
#define NOT_ARRIVED_EXIT 1

#define IN_PROCESS  "in-process"
#define FRAMES_NAME "frames.log"

#define DEGREES (180 / M_PI)
#define ALL     PATROL_METHODS

#define BOXES_MAX 1000

/* Of a round. */
#define HOURS     0.25
#define HOURS_MAX 1000

enum {
    OPTION_METHOD = COMMAND_LINE_OWN,
    OPTION_MAP,
    OPTION_START,
    OPTION_GOAL,
    OPTION_BEAM_DROPOUT,
    OPTION_SCAN_DROPOUT,
    OPTION_JUMP,
    OPTION_SLIP,
    OPTION_STRATEGY,
    OPTION_PLAN,
    OPTION_PATIENCE,
    OPTION_BOXES,
    OPTION_ROUND,
    OPTION_HOURS
};

struct arguments {
    enum patrol_scene_kind kind; /* PATROL_SCENES: none */
    struct command_line common;
    enum patrol_method method; /* ALL: every one */
    const char *map_path;
    struct planar_pose start;
    struct planar_pose goal;
    bool has_start;
    bool has_goal;
    struct patrol_faults faults;
    bool turns_by_fixed_angle;
    bool plans_by_length;
    const char *bus; /* NULL: no ECU, but the core itself */
    unsigned patience;
    unsigned boxes;         /* that the map does not show */
    const char *round_path; /* NULL: to a goal */
    double hours;           /* of the round; 0: not given */
};

/* ---- Command line ---- */

/* Reads "1,2,3". */
static bool read_numbers(const char *text, double *numbers, unsigned count)
{
    const char *rest = text;

    for (unsigned i = 0; i < count; i++) {
        char *end;
        numbers[i] = strtod(rest, &end);
        if (end == rest || !isfinite(numbers[i]) || *end != (i + 1 < count ? ',' : '\0')) {
            return false;
        }
        rest = end + 1;
    }
    return true;
}

static unsigned find_name(const char *name, const char *const *names, unsigned count)
{
    unsigned i = 0;

    while (i < count && strcmp(name, names[i]) != 0) {
        i++;
    }
    return i;
}

static void parse_scene(struct arguments *arguments, const char *text, struct argp_state *state)
{
    if (arguments->kind != PATROL_SCENES) {
        command_line_refuse(state, "one scene only, not also %s", text);
    }
    arguments->kind = (enum patrol_scene_kind)find_name(text, patrol_scene_names, PATROL_SCENES);
    if (arguments->kind == PATROL_SCENES) {
        command_line_refuse(state, "%s: no such scene; see --help", text);
    }
}

static void parse_method(struct arguments *arguments, const char *text, struct argp_state *state)
{
    arguments->method = (enum patrol_method)find_name(text, patrol_method_names, PATROL_METHODS);
    if (arguments->method == ALL && strcmp(text, "all") != 0) {
        command_line_refuse(state, "--method %s: must be improved, plain, pursuit or all", text);
    }
}

static void parse_place(const char *option, const char *text, struct planar_pose *place, struct argp_state *state)
{
    double numbers[3] = {0};

    if (!read_numbers(text, numbers, 3)) {
        command_line_refuse(state, "%s %s: must be X,Y,DEGREES", option, text);
    }
    *place = (struct planar_pose){numbers[0], numbers[1], numbers[2] / DEGREES};
}

static void parse_beam_dropout(struct patrol_faults *faults, const char *text, struct argp_state *state)
{
    if (!read_numbers(text, &faults->beam_dropout, 1) || faults->beam_dropout < 0 || faults->beam_dropout > 1) {
        command_line_refuse(state, "--beam-dropout %s: must be a share from 0 to 1", text);
    }
}

static void parse_scan_dropout(struct patrol_faults *faults, const char *text, struct argp_state *state)
{
    double numbers[2] = {0};

    if (!read_numbers(text, numbers, 2) || numbers[0] < 0 || numbers[1] < numbers[0]) {
        command_line_refuse(state, "--scan-dropout %s: must be FROM,UNTIL, in s", text);
    }
    faults->scan_dropout_from = numbers[0];
    faults->scan_dropout_until = numbers[1];
}

static void parse_jump(struct patrol_faults *faults, const char *text, struct argp_state *state)
{
    double numbers[2] = {0};

    if (!read_numbers(text, numbers, 2) || numbers[0] < 0) {
        command_line_refuse(state, "--jump %s: must be AT,METRES, from 0 s on", text);
    }
    faults->jump_at = numbers[0];
    faults->jump_m = numbers[1];
}

static void parse_strategy(struct arguments *arguments, const char *text, struct argp_state *state)
{
    arguments->turns_by_fixed_angle = strcmp(text, "fixed-angle") == 0;
    if (!arguments->turns_by_fixed_angle && strcmp(text, "by-cost") != 0) {
        command_line_refuse(state, "--strategy %s: must be by-cost or fixed-angle", text);
    }
}

static void parse_plan(struct arguments *arguments, const char *text, struct argp_state *state)
{
    arguments->plans_by_length = strcmp(text, "length") == 0;
    if (!arguments->plans_by_length && strcmp(text, "joules") != 0) {
        command_line_refuse(state, "--plan %s: must be joules or length", text);
    }
}

static void parse_patience(struct arguments *arguments, const char *text, struct argp_state *state)
{
    double seconds = 0;

    if (!read_numbers(text, &seconds, 1) || seconds < 1 || seconds > 3600) {
        command_line_refuse(state, "--patience %s: must be 1 to 3600 s", text);
    }
    arguments->patience = (unsigned)seconds;
}

static void parse_boxes(struct arguments *arguments, const char *text, struct argp_state *state)
{
    double boxes = 0;

    if (!read_numbers(text, &boxes, 1) || boxes < 0 || boxes > BOXES_MAX || boxes != floor(boxes)) {
        command_line_refuse(state, "--hidden %s: must be a whole number from 0 to %d", text, BOXES_MAX);
    }
    arguments->boxes = (unsigned)boxes;
}

static void parse_hours(struct arguments *arguments, const char *text, struct argp_state *state)
{
    if (!read_numbers(text, &arguments->hours, 1) || arguments->hours <= 0 || arguments->hours > HOURS_MAX) {
        command_line_refuse(state, "--hours %s: must be above 0 and at most %d", text, HOURS_MAX);
    }
}

static bool has_faults(const struct arguments *arguments)
{
    const struct patrol_faults *faults = &arguments->faults;

    return faults->slip || faults->beam_dropout > 0 || faults->scan_dropout_until > 0 || faults->jump_at >= 0;
}

static void check_bus(const struct arguments *arguments, struct argp_state *state)
{
    if (arguments->method != ALL && arguments->method != PATROL_IMPROVED) {
        command_line_refuse(state, "--method %s: the ECU drives by the improved band; leave it out with --bus",
                            patrol_method_names[arguments->method]);
    }
    if (has_faults(arguments) || arguments->turns_by_fixed_angle || arguments->plans_by_length) {
        command_line_refuse(state, "--bus takes neither faults nor another strategy; leave them out");
    }
}

/* It begins at its charger, and goes by what the ECU has, too. */
static void check_round(const struct arguments *arguments, struct argp_state *state)
{
    if (arguments->map_path == NULL || arguments->kind != PATROL_SCENES) {
        command_line_refuse(state, "--round: goes over a map and through no scene; give it with --map");
    }
    if (arguments->has_start || arguments->has_goal) {
        command_line_refuse(state, "--round: has its own places; leave --start and --goal out");
    }
    if (arguments->method != ALL || has_faults(arguments) || arguments->turns_by_fixed_angle ||
        arguments->plans_by_length) {
        command_line_refuse(state, "--round takes neither a method, faults nor another strategy; leave them out");
    }
}

static void check_drive(const struct arguments *arguments, struct argp_state *state)
{
    const bool has_map = arguments->map_path != NULL;

    if ((arguments->kind != PATROL_SCENES) == has_map) {
        command_line_refuse(state, "a scene or --map is needed, and not both; see --help");
    }
    if (arguments->has_start != has_map || arguments->has_goal != has_map) {
        command_line_refuse(state, "--map, --start and --goal belong together");
    }
    if (arguments->boxes > 0 && !has_map) {
        command_line_refuse(state, "--hidden: a scene has its own things; give it with --map");
    }
    if (arguments->hours > 0) {
        command_line_refuse(state, "--hours: a drive to a goal ends there; give it with --round");
    }
    if (arguments->bus != NULL) {
        check_bus(arguments, state);
    }
}

static void check(const struct arguments *arguments, struct argp_state *state)
{
    if (arguments->round_path != NULL) {
        check_round(arguments, state);
    } else {
        check_drive(arguments, state);
    }
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case OPTION_METHOD:
        parse_method(arguments, argument, state);
        return 0;
    case OPTION_MAP:
        arguments->map_path = argument;
        return 0;
    case OPTION_START:
        parse_place("--start", argument, &arguments->start, state);
        arguments->has_start = true;
        return 0;
    case OPTION_GOAL:
        parse_place("--goal", argument, &arguments->goal, state);
        arguments->has_goal = true;
        return 0;
    case OPTION_BEAM_DROPOUT:
        parse_beam_dropout(&arguments->faults, argument, state);
        return 0;
    case OPTION_SCAN_DROPOUT:
        parse_scan_dropout(&arguments->faults, argument, state);
        return 0;
    case OPTION_JUMP:
        parse_jump(&arguments->faults, argument, state);
        return 0;
    case OPTION_SLIP:
        arguments->faults.slip = true;
        return 0;
    case OPTION_PLAN:
        parse_plan(arguments, argument, state);
        return 0;
    case OPTION_STRATEGY:
        parse_strategy(arguments, argument, state);
        return 0;
    case 'b':
        arguments->bus = argument;
        return 0;
    case OPTION_PATIENCE:
        parse_patience(arguments, argument, state);
        return 0;
    case OPTION_BOXES:
        parse_boxes(arguments, argument, state);
        return 0;
    case OPTION_ROUND:
        arguments->round_path = argument;
        return 0;
    case OPTION_HOURS:
        parse_hours(arguments, argument, state);
        return 0;
    case ARGP_KEY_ARG:
        parse_scene(arguments, argument, state);
        return 0;
    case ARGP_KEY_END:
        check(arguments, state);
        return 0;
    default:
        return command_line_option(key, argument, state, &arguments->common);
    }
}

/* ---- Scene ---- */

static bool is_on_map(const struct jp_terrain *map, const struct jp_plane_pose *pose)
{
    const double cell = (double)map->config.resolution / JP_Q16_ONE;

    return pose->x >= 0 && (double)pose->x < map->config.width * cell && pose->y >= 0 &&
           (double)pose->y < map->config.height * cell;
}

static bool is_place_free(const struct patrol_scene *scene, const struct four_wheel_file *robot, const char *option,
                          const struct jp_plane_pose *pose)
{
    const struct clearance_robot shape = {robot->body.length_m, robot->body.width_m, 0};
    const struct clearance_pose place = {(double)pose->x, (double)pose->y, (double)pose->heading};

    if (!is_on_map(&scene->ground, pose)) {
        error_line("%s: outside the map; give a place inside", option);
        return false;
    }
    if (!clearance_at(&scene->ground, &shape, &place)) {
        error_line("%s: the robot does not fit there: %.2f, %.2f m from the map's south-west corner touches what is "
                   "not free; give another place",
                   option, place.x, place.y);
        return false;
    }
    return true;
}

/* *scene is to be freed either way. */
static bool find_scene(const struct arguments *arguments, const struct four_wheel_file *robot,
                       struct patrol_scene *scene)
{
    if (arguments->map_path == NULL) {
        patrol_scene_make(arguments->kind, arguments->common.seed, scene);
        return true;
    }
    return patrol_scene_load(arguments->map_path, &arguments->start, &arguments->goal, scene) &&
           is_place_free(scene, robot, "--start", &scene->start) &&
           is_place_free(scene, robot, "--goal", &scene->goal) &&
           (arguments->boxes == 0 || patrol_boxes_hide(scene, robot, arguments->boxes, arguments->common.seed));
}

/* ---- Drives ---- */

static bool drive(struct patrol_report *report, enum patrol_method method, FILE *log)
{
    struct patrol_run *run = &report->runs[report->run_count];
    const struct patrol_task task = {.robot = report->robot,
                                     .scene = report->scene,
                                     .method = method,
                                     .turns_by_fixed_angle = report->turns_by_fixed_angle,
                                     .plans_by_length = report->plans_by_length,
                                     .seed = report->seed,
                                     .faults = report->faults,
                                     .observe = patrol_record_observe,
                                     .context = &run->record};

    if (log == NULL) {
        return false;
    }
    run->method = method;
    patrol_record_init(&run->record, log);
    report->run_count++;
    return patrol_mission_run(&task, &run->result);
}

static bool drive_all(const struct arguments *arguments, struct patrol_report *report)
{
    for (enum patrol_method method = 0; method < PATROL_METHODS; method++) {
        const bool is_asked_for = arguments->method == ALL || arguments->method == method;
        if (is_asked_for && !drive(report, method, output_open(arguments->common.output, patrol_report_log(method)))) {
            return false;
        }
    }
    return true;
}

/* Exit status. */
static int drive_and_write(const struct arguments *arguments, struct patrol_report *report)
{
    if (!output_directory(arguments->common.output)) {
        return ERROR_EXIT;
    }
    if (!drive_all(arguments, report) ||
        !output_json(arguments->common.output, "summary.json", patrol_report_json(report))) {
        output_discard();
        return ERROR_EXIT;
    }
    patrol_report_print(report);
    if (!output_commit()) {
        return ERROR_EXIT;
    }
    return report->runs[0].result.outcome == PATROL_ARRIVED ? EXIT_SUCCESS : NOT_ARRIVED_EXIT;
}

/* ---- Over a bus ---- */

static bool open_link(const struct arguments *arguments, const struct four_wheel_file *robot, struct jp_can_link *link)
{
    static struct local_ecu ecu;

    if (strcmp(arguments->bus, IN_PROCESS) != 0) {
        return bus_open(link, arguments->bus);
    }
    const struct patrol_robot_entry *entry = patrol_robot_find(robot->name);

    return entry != NULL && local_ecu_start_patrol(&ecu, entry, link);
}

static json_t *json_of(const struct patrol_bus *bus, const struct patrol_scene *scene, uint64_t seed)
{
    const struct patrol_result *result = &bus->result;
    char fingerprint[20];

    (void)snprintf(fingerprint, sizeof fingerprint, "%016llx", (unsigned long long)bus->fingerprint);
    return json_pack("{s:s, s:I, s:s, s:s, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:I, s:I, s:f, s:f, s:f, s:f, s:I, s:s}",
                     "scene", scene->name, "seed", (json_int_t)seed, "outcome", patrol_outcome_names[result->outcome],
                     "reason", patrol_reason_names[result->reason], "time_s", result->time, "length_m", result->length,
                     "energy_j", result->energy_j, "clearance_min_m", result->clearance_min, "position_error_m",
                     result->position_error, "heading_error_deg", result->heading_error * DEGREES, "odometry_error_m",
                     result->odometry_error, "replans", (json_int_t)result->replans, "map_bytes",
                     (json_int_t)bus->stream_bytes, "upload_s", bus->upload_s, "forecast_j", bus->forecast_j,
                     "deviation_j", bus->deviation_j, "metered_j", bus->metered_j, "commands_late",
                     (json_int_t)bus->drive.late, "fingerprint", fingerprint);
}

static void print_bus(const struct patrol_bus *bus, const struct patrol_scene *scene)
{
    const struct patrol_result *result = &bus->result;

    (void)printf("%-24s %s\n", scene->name, patrol_outcome_names[result->outcome]);
    (void)printf("%-24s %8.1f s\n", "time", result->time);
    (void)printf("%-24s %8.2f m, nearest %.2f m to anything\n", "driven", result->length, result->clearance_min);
    (void)printf("%-24s %8.0f J, foretold %.0f J, metered %.0f J\n", "energy", result->energy_j, bus->forecast_j,
                 bus->metered_j);
    (void)printf("%-24s %8.3f m and %.1f deg off\n", "goal", result->position_error, result->heading_error * DEGREES);
    (void)printf("%-24s %8zu bytes in %.1f s\n", "map over the bus", bus->stream_bytes, bus->upload_s);
    (void)printf("%-24s %016llx\n", "fingerprint", (unsigned long long)bus->fingerprint);
}

static bool write_bus(const struct arguments *arguments, const struct patrol_bus *bus, const struct patrol_scene *scene)
{
    return output_json(arguments->common.output, "summary.json", json_of(bus, scene, arguments->common.seed)) &&
           output_commit();
}

/* Exit status. */
static int drive_on_link(const struct arguments *arguments, const struct four_wheel_file *robot,
                         const struct patrol_scene *scene, const struct jp_can_link *link)
{
    static struct patrol_bus bus;
    FILE *frames =
        output_directory(arguments->common.output) ? output_open(arguments->common.output, FRAMES_NAME) : NULL;
    struct can_log log = {
        .stream = frames, .inner = *link, .interface = "can0", .tick = &bus.drive.tick, .rate_hz = FOUR_WHEEL_RATE_HZ};
    const struct jp_can_link logged = can_log_link(&log);

    if (frames == NULL || !patrol_bus_run(&bus, robot, scene, arguments->common.seed, &logged, arguments->patience)) {
        output_discard();
        return ERROR_EXIT;
    }
    print_bus(&bus, scene);
    if (!write_bus(arguments, &bus, scene)) {
        return ERROR_EXIT;
    }
    return bus.result.outcome == PATROL_ARRIVED ? EXIT_SUCCESS : NOT_ARRIVED_EXIT;
}

static int patrol_on_bus(const struct arguments *arguments, const struct four_wheel_file *robot)
{
    struct patrol_scene scene = {.block = NULL};
    struct jp_can_link link;
    int status = ERROR_EXIT;

    if (find_scene(arguments, robot, &scene) && open_link(arguments, robot, &link)) {
        status = drive_on_link(arguments, robot, &scene, &link);
        link.close(link.port.context);
    }
    patrol_scene_free(&scene);
    return status;
}

static int patrol(const struct arguments *arguments, const struct four_wheel_file *robot)
{
    static struct patrol_report report;
    struct patrol_scene scene = {.block = NULL};
    int status = ERROR_EXIT;

    if (find_scene(arguments, robot, &scene)) {
        report = (struct patrol_report){.robot = robot,
                                        .scene = &scene,
                                        .map_path = arguments->map_path,
                                        .seed = arguments->common.seed,
                                        .faults = arguments->faults,
                                        .turns_by_fixed_angle = arguments->turns_by_fixed_angle,
                                        .plans_by_length = arguments->plans_by_length};
        status = drive_and_write(arguments, &report);
    }
    for (size_t i = 0; i < report.run_count; i++) {
        patrol_record_free(&report.runs[i].record);
    }
    patrol_scene_free(&scene);
    return status;
}

/* ---- A round ---- */

static bool are_places_free(const struct patrol_scene *scene, const struct four_wheel_file *robot,
                            const struct patrol_round_file *file)
{
    char name[sizeof "stops[00]"];

    for (unsigned i = 0; i < file->stop_count; i++) {
        const struct jp_plane_pose pose = patrol_scene_place(scene, &file->stops[i].pose);

        (void)snprintf(name, sizeof name, "stops[%u]", i % JP_PATROL_STOPS_MAX);
        if (!is_place_free(scene, robot, name, &pose)) {
            return false;
        }
    }
    return is_place_free(scene, robot, "charger", &scene->start);
}

/* The boxes are on its first way. *scene is to be freed either way. */
static bool find_round(const struct arguments *arguments, const struct four_wheel_file *robot,
                       struct patrol_round_file *file, struct patrol_scene *scene)
{
    if (!patrol_round_file_load(arguments->round_path, file)) {
        return false;
    }
    const struct planar_pose charger = patrol_round_charger(file);

    return patrol_scene_load(arguments->map_path, &charger, &file->stops[0].pose, scene) &&
           are_places_free(scene, robot, file) &&
           (arguments->boxes == 0 || patrol_boxes_hide(scene, robot, arguments->boxes, arguments->common.seed));
}

/* The link is logged, and closed at the end. */
static bool go_round_on_bus(const struct arguments *arguments, const struct patrol_round_task *task,
                            struct patrol_round_result *result)
{
    struct jp_can_link link;
    bool is_done = false;

    if (open_link(arguments, task->robot, &link)) {
        is_done = patrol_round_drive_on_bus(task, &link, arguments->patience, result);
        link.close(link.port.context);
    }
    return is_done;
}

/* Exit status. */
static int go_round(const struct arguments *arguments, struct patrol_round_task *task,
                    struct patrol_round_result *result)
{
    task->log =
        output_directory(arguments->common.output) ? output_open(arguments->common.output, PATROL_ROUND_LOG) : NULL;
    if (task->log == NULL ||
        !(arguments->bus != NULL ? go_round_on_bus(arguments, task, result) : patrol_round_drive(task, result)) ||
        !output_json(arguments->common.output, "summary.json", patrol_round_json(task, result, arguments->map_path))) {
        output_discard();
        return ERROR_EXIT;
    }
    patrol_round_print(task, result);
    if (!output_commit()) {
        return ERROR_EXIT;
    }
    return result->outcome == PATROL_ROUND_WENT_ON && result->record.below_reserve == 0 ? EXIT_SUCCESS
                                                                                        : NOT_ARRIVED_EXIT;
}

static int patrol_for_hours(const struct arguments *arguments, const struct four_wheel_file *robot)
{
    struct patrol_round_file file;
    struct patrol_scene scene = {.block = NULL};
    int status = ERROR_EXIT;

    if (find_round(arguments, robot, &file, &scene)) {
        struct patrol_round_task task = {.robot = robot,
                                         .scene = &scene,
                                         .file = &file,
                                         .seed = arguments->common.seed,
                                         .hours = arguments->hours > 0 ? arguments->hours : HOURS};

        struct patrol_round_result *result = malloc(sizeof *result);

        if (result != NULL) {
            status = go_round(arguments, &task, result);
        } else {
            error_line("%s: no memory for a round", arguments->round_path);
        }
        free(result);
    }
    patrol_scene_free(&scene);
    return status;
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_SEED("of the scene and of the noise"),
        {"method", OPTION_METHOD, "METHOD", 0, "improved, plain, pursuit or all (default)", 0},
        {"strategy", OPTION_STRATEGY, "STRATEGY", 0,
         "how the improved band turns to its path: by-cost (default), or by the paper's fixed-angle", 0},
        {"plan", OPTION_PLAN, "COST", 0, "what its path costs: joules (default), or by the paper its length", 0},
        {"map", OPTION_MAP, "MAP.json", 0, "drive over this map (tools.design.import_map) instead of a scene", 0},
        {"start", OPTION_START, "X,Y,DEG", 0, "on that map, m in its frame", 0},
        {"goal", OPTION_GOAL, "X,Y,DEG", 0, "likewise", 0},
        OPTION_ROBOT(" (patrol)"),
        {"beam-dropout", OPTION_BEAM_DROPOUT, "SHARE", 0, "this share of the laser's beams drops out", 0},
        {"scan-dropout", OPTION_SCAN_DROPOUT, "FROM,UNTIL", 0, "no scans in this time, s", 0},
        {"jump", OPTION_JUMP, "AT,METRES", 0, "the laser's pose jumps so far at this time, s", 0},
        {"bus", 'b', "BUS", 0,
         "the robot's ECU gets map and goal, sees and drives in frames: " IN_PROCESS
         ", can:INTERFACE, slcan:DEVICE or pty:NAME, in lockstep",
         0},
        {"hidden", OPTION_BOXES, "N", 0, "on --map: boxes on the way that the map does not show (0)", 0},
        {"round", OPTION_ROUND, "ROUND.cfg", 0,
         "on --map: go round between its stops, and home to its charger while the energy lasts", 0},
        {"hours", OPTION_HOURS, "HOURS", 0, "of the round (0.25)", 0},
        {"patience", OPTION_PATIENCE, "SECONDS", 0, "wait so long for an ECU (10)", 0},
        {"slip", OPTION_SLIP, NULL, 0, "the ground is slippery and falls off to one side", 0},
        OPTION_OUTPUT("build/patrol"),
        {0},
    };
    static const struct argp argp = {
        options,
        parse_option,
        "SCENE\n--map=MAP.json --start=X,Y,DEG --goal=X,Y,DEG\n--map=MAP.json --round=ROUND.cfg",
        "Drives the patrol robot through a scene by the improved and the plain timed elastic band and by pure pursuit, "
        "and compares them. Scenes: beside-obstacle, l-passage, corridor, doorway, pedestrian, warehouse.\v"
        "Exit status: 0 the robot arrived by the first method, or went round and was never home with less than the "
        "reserve; 1 it did not: the outputs say why; 2 bad input, nothing was written.",
        NULL,
        NULL,
        NULL};
    static struct four_wheel_file robot;
    struct arguments arguments = {.kind = PATROL_SCENES,
                                  .common = {.output = "build/patrol", .robot = "sim/robots/patrol.cfg", .seed = 1},
                                  .method = ALL,
                                  .faults.jump_at = -1,
                                  .patience = BUS_DRIVE_PATIENCE};

    command_line_parse(&argp, argc, argv, &arguments);
    if (!four_wheel_file_load(arguments.common.robot, &robot)) {
        return ERROR_EXIT;
    }
    if (arguments.round_path != NULL) {
        return patrol_for_hours(&arguments, &robot);
    }
    return arguments.bus != NULL ? patrol_on_bus(&arguments, &robot) : patrol(&arguments, &robot);
}
