/* Plans a route over a map for least energy and for least distance, compares them, and drives the first. */
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/rig.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/files/lattice_file.h"
#include "sim/missions/plan_arguments.h"
#include "sim/missions/plan_lattice.h"
#include "sim/missions/plan_parameters.h"
#include "sim/missions/plan_skid_drive.h"
#include "sim/missions/plan_tables.h"

/** Exit code when the outputs were written but the goal was not reached. */
#define NOT_REACHED_EXIT 1

#define MEMORY_KIB 8192

enum { OPTION_COST = PLAN_OPTION_OWN, OPTION_LATTICE };

struct arguments {
    struct plan_arguments plan;  /* first: plan_arguments_take() looks at it */
    const char *lattice_path;    /* NULL: as built in */
    const char *parameters_path; /* NULL: as built in */
    enum jp_cost_kind cost;
};

/* ---- Command line ---- */

static void parse_cost(struct arguments *arguments, const char *text, struct argp_state *state)
{
    if (strcmp(text, "physical") != 0 && strcmp(text, "paper") != 0) {
        command_line_refuse(state, "--cost %s: must be physical or paper", text);
    }
    arguments->cost = strcmp(text, "paper") == 0 ? JP_COST_PAPER : JP_COST_PHYSICAL;
}

static void check(const struct arguments *arguments, struct argp_state *state)
{
    if (arguments->parameters_path != NULL && arguments->cost != JP_COST_PHYSICAL) {
        command_line_refuse(state, "--parameters: only the physical cost follows what is learned; leave --cost out");
    }
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case OPTION_COST:
        parse_cost(arguments, argument, state);
        return 0;
    case OPTION_LATTICE:
        arguments->lattice_path = argument;
        return 0;
    case 'p':
        arguments->parameters_path = argument;
        return 0;
    case ARGP_KEY_END:
        (void)plan_arguments_take(key, argument, state);
        check(arguments, state);
        return 0;
    default:
        return plan_arguments_take(key, argument, state);
    }
}

/* ---- Inputs ---- */

static const struct jp_lattice *built_in_lattice(const char *name)
{
    const struct jp_lattice *lattice = plan_lattice_find(name);

    if (lattice == NULL) {
        error_line("%s: no lattice for this robot; run make lattice ROBOT=%s, or give --lattice", name, name);
    }
    return lattice;
}

/* NULL after one line on stderr. */
static const struct jp_lattice *find_lattice(const struct arguments *arguments, const struct lattice_robot *robot,
                                             struct lattice_file *file)
{
    if (arguments->lattice_path == NULL) {
        return built_in_lattice(robot->name);
    }
    if (!lattice_file_load(arguments->lattice_path, file)) {
        return NULL;
    }
    if (strcmp(file->name, robot->name) != 0) {
        error_line("%s: robot: '%s' is not '%s', for which is planned; make a lattice for that robot",
                   arguments->lattice_path, file->name, robot->name);
        return NULL;
    }
    return &file->lattice;
}

/* The robot's lattice, charged by what was learned if there is anything. NULL after one line on stderr. */
static const struct jp_lattice *charged_lattice(const struct arguments *arguments, const struct map_file *map,
                                                const struct lattice_robot *robot, struct lattice_file *file,
                                                struct jp_tariff *tariff)
{
    const struct jp_lattice *lattice = find_lattice(arguments, robot, file);

    if (lattice == NULL || !plan_lattice_fits(arguments->plan.map_path, map, lattice)) {
        return NULL;
    }
    if (arguments->parameters_path == NULL) {
        return lattice;
    }
    return plan_parameters_load(arguments->parameters_path, robot, lattice, tariff) ? &tariff->lattice : NULL;
}

static bool find_task(const struct arguments *arguments, const struct map_file *map, const struct jp_lattice *lattice,
                      struct plan_task *task)
{
    return plan_arguments_task(&arguments->plan, map, lattice, task);
}

/* ---- Outputs ---- */

static bool write_routes(const struct plan_report *report, const char *directory)
{
    for (enum plan_aim aim = 0; aim < PLAN_AIMS; aim++) {
        FILE *stream = output_open(directory, plan_route_files[aim]);
        if (stream == NULL) {
            return false;
        }
        plan_route_write(&report->searches[aim].route, report->map, report->lattice, stream);
    }
    return true;
}

static bool write_scenario(const struct plan_drive *drive, const struct arguments *arguments)
{
    FILE *stream = output_open(arguments->plan.common.output, PLAN_SCENARIO_FILE);
    char *path = realpath(arguments->plan.common.robot, NULL);

    if (stream != NULL && path != NULL) {
        plan_drive_write(drive, path, stream);
    }
    free(path);
    return stream != NULL;
}

/* ---- Plan ---- */

static bool search_both(const struct arguments *arguments, struct map_file *map, struct plan_report *report)
{
    const enum jp_cost_kind costs[PLAN_AIMS] = {arguments->cost, JP_COST_DISTANCE};

    for (enum plan_aim aim = 0; aim < PLAN_AIMS; aim++) {
        if (!plan_search(map, report->lattice, costs[aim], &report->task, report->memory, &report->searches[aim])) {
            return false;
        }
    }
    return true;
}

/* By a balancer. *driven is false after one line on stderr: it cannot be driven. */
static bool drive_balancer(const struct arguments *arguments, const struct lattice_robot *robot,
                           struct plan_report *report, bool *driven)
{
    static struct plan_drive balancer;
    static struct plan_driven result;

    if (!plan_drive_prepare(report->map, report->lattice, robot, &report->searches[PLAN_ENERGY].route, &balancer)) {
        *driven = false;
        return true;
    }
    FILE *log = output_open(arguments->plan.common.output, PLAN_LOG_FILE);
    if (log == NULL || !write_scenario(&balancer, arguments) || !plan_drive_run(report->map, robot, &balancer, log)) {
        return false;
    }
    result = plan_drive_result(&balancer);
    report->drive = &result;
    return true;
}

/* By a robot that its sides steer, if it has a controller. *driven as above. */
static bool drive_skid_steer(const struct arguments *arguments, const struct lattice_robot *robot,
                             struct plan_report *report, bool *driven)
{
    static struct plan_skid_drive skid;
    const struct skid_robot_entry *entry = skid_robot_built_in(robot->name);

    if (entry == NULL || report->searches[PLAN_ENERGY].route.count < 2) {
        return true;
    }
    if (!plan_skid_drive_prepare(report->map, report->lattice, entry, &robot->skid_steer,
                                 &report->searches[PLAN_ENERGY].route, &skid)) {
        *driven = false;
        return true;
    }
    FILE *log = output_open(arguments->plan.common.output, PLAN_LOG_FILE);
    if (log == NULL) {
        return false;
    }
    plan_skid_drive_run(report->map, &skid, log);
    report->drive = &skid.driven;
    return true;
}

/* Drives the energy-optimal route. *driven is false after one line on stderr. */
static bool drive(const struct arguments *arguments, const struct lattice_robot *robot, struct plan_report *report,
                  bool *driven)
{
    if (!plan_search_arrives(&report->searches[PLAN_ENERGY])) {
        return true;
    }
    return robot->balancer.model != NULL ? drive_balancer(arguments, robot, report, driven)
                                         : drive_skid_steer(arguments, robot, report, driven);
}

static bool arrives(const struct plan_report *report)
{
    return plan_search_arrives(&report->searches[PLAN_ENERGY]) &&
           plan_search_arrives(&report->searches[PLAN_DISTANCE]) && (report->drive == NULL || report->drive->is_clear);
}

/* Exit status. */
static int write_all(const struct arguments *arguments, const struct lattice_robot *robot, struct plan_report *report)
{
    bool driven = true;

    if (!output_directory(arguments->plan.common.output)) {
        return ERROR_EXIT;
    }
    if (!write_routes(report, arguments->plan.common.output) || !drive(arguments, robot, report, &driven) ||
        !output_json(arguments->plan.common.output, "summary.json", plan_json(report))) {
        output_discard();
        return ERROR_EXIT;
    }
    plan_print(report);
    if (!output_commit()) {
        return ERROR_EXIT;
    }
    return driven && arrives(report) ? EXIT_SUCCESS : NOT_REACHED_EXIT;
}

static int plan(const struct arguments *arguments, struct map_file *map, const struct lattice_robot *robot)
{
    struct lattice_file file = {.primitives = NULL};
    struct jp_tariff tariff = {.primitives = NULL};
    char *map_path = realpath(arguments->plan.map_path, NULL);
    struct plan_report report = {.map = map,
                                 .map_path = map_path != NULL ? map_path : arguments->plan.map_path,
                                 .lattice = charged_lattice(arguments, map, robot, &file, &tariff),
                                 .lattice_path = arguments->lattice_path,
                                 .parameters_path = arguments->parameters_path,
                                 .memory = arguments->plan.memory};
    int status = ERROR_EXIT;

    if (report.lattice != NULL && find_task(arguments, map, report.lattice, &report.task) &&
        search_both(arguments, map, &report)) {
        status = write_all(arguments, robot, &report);
    }
    for (enum plan_aim aim = 0; aim < PLAN_AIMS; aim++) {
        plan_route_free(&report.searches[aim].route);
    }
    plan_parameters_free(&tariff);
    lattice_file_free(&file);
    free(map_path);
    return status;
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_ROBOT(""),
        PLAN_OPTION_PLACES,
        {"cost", OPTION_COST, "KIND", 0, "physical (default) or paper: what the energy-optimal route is charged for",
         0},
        PLAN_OPTION_BLOCK(" (default: 8192)"),
        {"lattice", OPTION_LATTICE, "FILE.json", 0, "a lattice (tools.design.lattice --json) (default: as built in)",
         0},
        {"parameters", 'p', "FILE.json", 0, "what the robot has learned (default: as built in)", 0},
        OPTION_OUTPUT("build/plan"),
        {0},
    };
    static const struct argp argp = {
        options,
        parse_option,
        "MAP.json",
        "Plans a route over a map (tools.design.import_map) for least energy and for least distance and compares them; "
        "the first is driven in the simulator.\v"
        "Exit status: 0 both routes reach the goal; 1 not, or the drive could not be made or touched an obstacle: "
        "the outputs say which; 2 bad input, nothing was written.",
        NULL,
        NULL,
        NULL};
    static struct lattice_robot robot;
    struct arguments arguments = {
        .plan = {.common = {.output = "build/plan"}, .memory = (size_t)MEMORY_KIB * 1024},
        .cost = JP_COST_PHYSICAL,
    };
    struct map_file map;

    command_line_parse(&argp, argc, argv, &arguments);
    if (!lattice_robot_load(arguments.plan.common.robot, &robot) || !map_file_load(arguments.plan.map_path, &map)) {
        return ERROR_EXIT;
    }
    const int status = plan(&arguments, &map, &robot);
    map_file_free(&map);
    return status;
}
