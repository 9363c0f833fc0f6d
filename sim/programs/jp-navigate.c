/* A robot finds its way over a map on which not everything is that is in the world. */
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/bus/bus_open.h"
#include "sim/bus/can_log.h"
#include "sim/bus/local_ecu.h"
#include "sim/files/cell_file.h"
#include "sim/lattice/lattice_robot.h"
#include "sim/missions/bus_navigation.h"
#include "sim/missions/navigation.h"
#include "sim/missions/navigation_balancer.h"
#include "sim/missions/navigation_record.h"
#include "sim/missions/navigation_sight.h"
#include "sim/missions/navigation_skid.h"
#include "sim/missions/navigation_world.h"
#include "sim/missions/plan_arguments.h"
#include "sim/missions/plan_lattice.h"

/** Exit code when the outputs were written but the robot did not arrive, or touched something. */
#define NOT_ARRIVED_EXIT 1

#define MEMORY_KIB  1024
#define BOXES       6
#define BOXES_MAX   1000
#define VIEW        2.5
#define SECONDS_MAX 3600

/* Deviation of what the battery is taken to hold, share of it; and with which probability the robot shall come home, %.
 */
#define BATTERY_DEVIATION 0.02
#define HOME_PERCENT      99.9

#define IN_PROCESS  "in-process"
#define FRAMES_NAME "frames.log"

enum {
    OPTION_BOXES = PLAN_OPTION_OWN,
    OPTION_VIEW,
    OPTION_PATIENCE,
    OPTION_FRAMES,
    OPTION_BATTERY,
    OPTION_CHARGE,
    OPTION_HOME
};

struct arguments {
    struct plan_arguments plan; /* first: plan_arguments_take() looks at it */
    unsigned boxes;
    double view_m;
    const char *bus; /* NULL: no ECU, but the navigator itself */
    unsigned patience;
    bool frames;           /* are logged */
    double battery_j;      /* 0: it lasts, and the robot stays at the goal */
    double charge_percent; /* of cells; below 0: it has none */
    double home_percent;   /* with which the robot shall come home */
};

/* ---- Command line ---- */

static void check(const struct arguments *arguments, struct argp_state *state)
{
    if (arguments->frames && arguments->bus == NULL) {
        command_line_refuse(state, "--frames: there are none without --bus");
    }
    if (arguments->battery_j > 0 && arguments->bus != NULL) {
        command_line_refuse(state, "--battery: the ECU looks at its cells; give --charge, or leave --bus out");
    }
    if (arguments->charge_percent >= 0 && arguments->battery_j > 0) {
        command_line_refuse(state, "--charge: the cells say what --battery would; leave one out");
    }
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case OPTION_BOXES:
        arguments->boxes = (unsigned)command_line_whole(state, "--hidden", argument, 0, BOXES_MAX);
        return 0;
    case OPTION_VIEW:
        arguments->view_m = command_line_real(state, "--view", argument, 0.1, 100);
        return 0;
    case 'b':
        arguments->bus = argument;
        return 0;
    case OPTION_PATIENCE:
        arguments->patience = (unsigned)command_line_whole(state, "--patience", argument, 1, 86400);
        return 0;
    case OPTION_BATTERY:
        arguments->battery_j = command_line_real(state, "--battery", argument, 1, 1e7);
        return 0;
    case OPTION_CHARGE:
        arguments->charge_percent = command_line_real(state, "--charge", argument, 0, 100);
        return 0;
    case OPTION_HOME:
        arguments->home_percent = command_line_real(state, "--home", argument, 50, 99.99);
        return 0;
    case OPTION_FRAMES:
        arguments->frames = true;
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

/* The robot's lattice. NULL after one line on stderr. */
static const struct jp_lattice *prepare(const struct arguments *arguments, const struct lattice_robot *robot,
                                        const struct map_file *map)
{
    const struct jp_lattice *lattice = plan_lattice_for_navigation(robot->name);

    if (lattice == NULL || robot->turning_radius_m == 0) {
        error_line("%s: no lattice for finding its way; give the robot file a section navigation: { cell_m = 0.1; "
                   "margin_m = 0.06; }; and run make lattice ROBOT=%s",
                   robot->name, robot->name);
        return NULL;
    }
    return plan_lattice_fits(arguments->plan.map_path, map, lattice) ? lattice : NULL;
}

/* ---- Outputs ---- */

static json_t *json_place(const struct map_file *map, const struct jp_lattice *lattice,
                          const struct jp_lattice_pose *pose)
{
    const struct clearance_pose grid = plan_grid_pose(map, lattice, pose);
    const struct plan_place place = plan_map_place(map, &grid);

    return json_pack("[f, f, f]", place.x, place.y, place.heading_deg);
}

static json_t *json_result(const struct navigation_result *result)
{
    return json_pack("{s:s, s:s, s:b, s:i, s:i, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "state",
                     navigation_state_name(result->state), "reason", navigation_reason_name(result->reason), "touched",
                     result->is_touched, "replans", (int)result->replans, "cells_seen", (int)result->seen,
                     "clearance_m", result->clearance_m, "goal_error_m", result->goal_error_m, "deviation_m",
                     result->deviation_m, "planned_j", result->planned_joules, "length_m", result->length_m, "time_s",
                     result->seconds, "energy_j", result->joules, "forecast_j", result->forecast_joules,
                     "forecast_deviation_j", result->deviation_joules);
}

/* Row by row from the south. */
static json_t *json_reach(const struct jp_terrain_config *cells, const int8_t *reach)
{
    json_t *rows = json_array();

    for (int y = 0; y < cells->height; y++) {
        json_t *row = json_array();

        for (int x = 0; x < cells->width; x++) {
            (void)json_array_append_new(row, json_integer(reach[y * cells->width + x]));
        }
        (void)json_array_append_new(rows, row);
    }
    return rows;
}

static const char *home_name(enum jp_home_state state)
{
    static const char *const names[] = {"idle", "preparing", "out", "at goal", "returning", "home", "failed"};

    return names[state];
}

/* Why it has failed; NULL: it has not. */
static const char *home_reason(const struct navigation_result *result)
{
    if (result->home != JP_HOME_FAILED) {
        return NULL;
    }
    switch (result->home_status) {
    case JP_OK:
        return navigation_reason_name(result->reason);
    case JP_ERR_STATE:
        return "motors off";
    case JP_ERR_NO_PLAN:
        return "no way leads home";
    default:
        return "the robot cannot stand there";
    }
}

static json_t *json_home(const struct navigation_task *task, const struct navigation_result *result)
{
    return json_pack(
        "{s:s, s:s?, s:b, s:b, s:f, s:f, s:f, s:f, s:f, s:f, s:o}", "state", home_name(result->home), "reason",
        home_reason(result), "stranded", result->is_stranded, "turned_back", result->has_turned_back, "battery_j",
        task->battery->joules, "confidence", task->battery->confidence, "given_j", result->given_joules,
        "least_probability", result->least_probability, "trip_j", result->trip_joules, "trip_deviation_j",
        result->trip_deviation_joules, "reach_percent", json_reach(&task->map->config, task->battery->reach));
}

static json_t *json_charge(const struct navigation_charge *charge)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "true", charge->charge, "known", charge->known, "deviation",
                     charge->deviation, "left_j", charge->joules, "left_known_j", charge->known_joules,
                     "left_deviation_j", charge->joules_deviation);
}

static json_t *json_cells(const struct navigation_result *result)
{
    return json_pack("{s:o, s:o, s:f}", "before", json_charge(&result->charge_before), "after",
                     json_charge(&result->charge), "least_bus_v", result->least_bus_v);
}

static void print_charge(const struct navigation_result *result)
{
    const struct navigation_charge *charge = &result->charge;

    (void)printf("%-24s %8.2f %%, known as %.2f ± %.2f %%\n", "state of charge", 100 * charge->charge,
                 100 * charge->known, 100 * charge->deviation);
    (void)printf("%-24s %8.1f J, known as %.1f ± %.1f J\n", "energy left", charge->joules, charge->known_joules,
                 charge->joules_deviation);
    (void)printf("%-24s %8.2f V\n", "bus, least", result->least_bus_v);
}

static void print_home(const struct navigation_task *task, const struct navigation_result *result)
{
    const char *reason = home_reason(result);

    (void)printf("%-24s %s%s%s%s%s\n", "home", home_name(result->home), reason != NULL ? ": " : "",
                 reason != NULL ? reason : "", result->has_turned_back ? ", turned back" : "",
                 result->is_stranded ? ", STRANDED: the battery is empty" : "");
    (void)printf("%-24s %8.1f J, standard deviation %.1f J\n", "goal and home, forecast", result->trip_joules,
                 result->trip_deviation_joules);
    (void)printf("%-24s %8.1f J of %.1f J\n", "out of the battery", result->given_joules, task->battery->joules);
    (void)printf("%-24s %8.2f %%\n", "coming home, least", 100 * result->least_probability);
    if (task->battery->pack != NULL) {
        print_charge(result);
    }
}

static json_t *json_summary(const struct arguments *arguments, const struct map_file *map, const char *map_path,
                            const struct lattice_robot *robot, const struct navigation_task *task,
                            const struct navigation_world *world, const struct navigation_result *result,
                            const struct navigation_record *record)
{
    const struct jp_lattice_pose goal = {task->goal.x, task->goal.y, 0};

    return json_pack("{s:s, s:{s:s, s:s, s:s}, s:f, s:i, s:o, s:o, s:f, s:i, s:i, s:I, s:o, s:O, s:O, s:s}", "robot",
                     robot->name, "map", "file", map_path, "name", map->name, "note", map->note, "steepest",
                     robot->grade_max, "steep_cells", (int)world->steep_cells, "start",
                     json_place(map, task->lattice, &task->start), "goal", json_place(map, task->lattice, &goal),
                     "view_m", task->view_m, "hidden_boxes", (int)arguments->boxes, "memory_bytes", (int)task->memory,
                     "seed", (json_int_t)task->seed, "result", json_result(result), "courses", record->courses, "seen",
                     record->seen, "log", "drive.csv");
}

static void print(const struct navigation_world *world, const struct navigation_result *result)
{
    (void)printf("%-24s %s%s%s\n", "outcome", navigation_state_name(result->state),
                 result->reason == JP_NAVIGATOR_NO_REASON ? "" : ": ",
                 result->reason == JP_NAVIGATOR_NO_REASON ? "" : navigation_reason_name(result->reason));
    (void)printf("%-24s %s\n", "touched anything", result->is_touched ? "YES" : "no");
    (void)printf("%-24s %8.3f m\n", "least clearance", result->clearance_m);
    (void)printf("%-24s %8.3f m\n", "from the goal", result->goal_error_m);
    if (result->deviation_m > 0) {
        (void)printf("%-24s %8.3f m, standard deviation by its odometry\n", "known to", result->deviation_m);
    }
    (void)printf("%-24s %8u\n", "cells too steep", world->steep_cells);
    (void)printf("%-24s %8u\n", "cells not on the map", result->seen);
    (void)printf("%-24s %8u\n", "planned anew", result->replans);
    (void)printf("%-24s %8.2f m\n", "driven", result->length_m);
    (void)printf("%-24s %8.1f s\n", "time", result->seconds);
    (void)printf("%-24s %8.1f J\n", "energy", result->joules);
    if (result->planned_joules > 0) {
        (void)printf("%-24s %8.1f J\n", "planned, first route", result->planned_joules);
    }
    (void)printf("%-24s %8.1f J, standard deviation %.1f J\n", "forecast, first course", result->forecast_joules,
                 result->deviation_joules);
}

/* What the ECU tells of its way home, in the order of HomeState. */
static const char *told_name(const struct bus_navigation *navigation)
{
    static const char *const names[] = {
        "no home",    "no memory for the way", "closed", "seeking", "no way", "no battery", "suffices",
        "too little", "turning back"};
    const uint8_t state = navigation->drive.view.home.home_state;

    return state < sizeof names / sizeof names[0] ? names[state] : "?";
}

static json_t *json_told(const struct bus_navigation *navigation)
{
    const struct jp_can_home_status_t *home = &navigation->drive.view.home;
    const struct jp_can_home_battery_t *battery = &navigation->drive.view.home_battery;

    return json_pack("{s:s, s:b, s:f, s:f, s:f, s:f, s:f}", "state", told_name(navigation), "turned_back",
                     navigation->result.has_turned_back, "probability", ldexp(home->probability, -16), "way_j",
                     ldexp(home->way, -3), "way_deviation_j", ldexp(home->way_deviation, -3), "left_j",
                     ldexp(battery->left, -4), "left_deviation_j", ldexp(battery->left_deviation, -4));
}

static json_t *json_bus(const struct bus_navigation *navigation)
{
    char fingerprint[17];

    (void)snprintf(fingerprint, sizeof fingerprint, "%016" PRIx64, navigation->fingerprint);
    return json_pack("{s:I, s:f, s:I, s:I, s:s, s:o}", "map_bytes", (json_int_t)navigation->stream_bytes, "upload_s",
                     navigation->upload_s, "ticks", (json_int_t)navigation->drive.tick, "commands_late",
                     (json_int_t)navigation->drive.late, "fingerprint", fingerprint, "home", json_told(navigation));
}

static void print_bus(const struct bus_navigation *navigation)
{
    (void)printf("%-24s %8zu bytes in %.1f s\n", "map over the bus", navigation->stream_bytes, navigation->upload_s);
    (void)printf("%-24s %8" PRIu64 "\n", "commands late", navigation->drive.late);
    (void)printf("%-24s %016" PRIx64 "\n", "fingerprint", navigation->fingerprint);
    (void)printf("%-24s %s%s, %.2f %%: %.1f ± %.1f J of %.1f ± %.1f J\n", "home", told_name(navigation),
                 navigation->result.has_turned_back ? ", turned back" : "",
                 100 * ldexp(navigation->drive.view.home.probability, -16), ldexp(navigation->drive.view.home.way, -3),
                 ldexp(navigation->drive.view.home.way_deviation, -3),
                 ldexp(navigation->drive.view.home_battery.left, -4),
                 ldexp(navigation->drive.view.home_battery.left_deviation, -4));
}

/* ---- Bus ---- */

static bool is_balancer(const struct lattice_robot *robot)
{
    return robot->balancer.model != NULL;
}

/* Fed by cells it counts what leaves them. */
static bool start_balancer(struct local_ecu *ecu, const char *name, bool is_fed, struct jp_can_link *link)
{
    const struct robot_entry *entry = rig_find_robot(name);

    if (entry != NULL && is_fed && entry->energy_battery == NULL) {
        error_line("%s: --charge: no energy model of its battery is built in; run make identify ROBOT=%s", name, name);
        return false;
    }
    return entry != NULL && local_ecu_start(ecu, entry, is_fed ? entry->energy_battery : entry->energy, link);
}

static bool start_local(struct local_ecu *ecu, const struct lattice_robot *robot, bool is_fed, struct jp_can_link *link)
{
    if (is_balancer(robot)) {
        return start_balancer(ecu, robot->name, is_fed, link);
    }
    const struct skid_robot_entry *entry = skid_robot_find(robot->name);

    if (entry == NULL || entry->navigation == NULL) {
        error_line("%s: --bus: its ECU has no navigator; leave it out, or give the robot file a section navigation and "
                   "run make lattice ROBOT=%s",
                   robot->name, robot->name);
        return false;
    }
    return local_ecu_start_skid(ecu, entry, link);
}

static bool start_ecu(const struct arguments *arguments, const struct lattice_robot *robot, struct jp_can_link *link)
{
    static struct local_ecu ecu;
    const bool is_fed = arguments->charge_percent >= 0;

    if (!start_local(&ecu, robot, is_fed, link)) {
        return false;
    }
    if (is_fed) {
        ecu_node_turn_back(&ecu.node, (jp_q31)lround(ldexp(arguments->home_percent / 100, 31)));
    }
    return true;
}

/* False after one line on stderr. */
static bool load_cells(const struct arguments *arguments, const char *name, struct bus_navigation_cells *cells)
{
    if (!pack_file_load_robot(name, &cells->cell, &cells->wiring)) {
        return false;
    }
    cells->condition = (struct cell_condition){.charge = arguments->charge_percent / 100,
                                               .temperature_c = cells->cell.resistance.reference_c};
    return true;
}

static bool drive_on_bus(const struct arguments *arguments, const struct lattice_robot *robot,
                         const struct navigation_task *task, FILE *frames, struct bus_navigation *navigation)
{
    static struct bus_navigation_cells cells;
    const bool is_fed = arguments->charge_percent >= 0;
    const struct bus_navigation_robot body = {.balancer = is_balancer(robot) ? &robot->balancer.file : NULL,
                                              .skid = is_balancer(robot) ? NULL : &robot->skid_steer,
                                              .cells = is_fed ? &cells : NULL};
    const bool is_local = strcmp(arguments->bus, IN_PROCESS) == 0;
    struct jp_can_link link;

    if (is_fed && !load_cells(arguments, robot->name, &cells)) {
        return false;
    }
    if (is_local ? !start_ecu(arguments, robot, &link) : !bus_open(&link, arguments->bus)) {
        return false;
    }
    struct can_log log = {.stream = frames,
                          .inner = link,
                          .interface = "can0",
                          .tick = &navigation->drive.tick,
                          .rate_hz = (uint32_t)(is_balancer(robot) ? robot->balancer.file.control.rate_hz
                                                                   : robot->skid_steer.control.rate_hz)};
    const struct jp_can_link logged = can_log_link(&log);
    const bool is_done =
        bus_navigation_run(navigation, task, &body, frames != NULL ? &logged : &link, arguments->patience);

    link.close(link.port.context);
    return is_done;
}

/* ---- Drive ---- */

static bool switch_on(const struct lattice_robot *robot, const struct navigation_task *task,
                      struct navigation_robot *driven)
{
    static struct navigation_balancer balancer;
    static struct navigation_skid skid;
    const struct clearance_pose start = navigation_start(task);
    const bool is_fed = task->battery != NULL && task->battery->pack != NULL;

    if (robot->balancer.model != NULL) {
        return navigation_balancer_init(&balancer, rig_find_robot(robot->name), &robot->balancer.file, &start,
                                        task->seed, is_fed ? JP_PILOT_BATTERY : JP_PILOT_MOTORS, driven);
    }
    static struct skid_classes classes;
    const struct skid_robot_entry *entry = skid_robot_find(robot->name);
    const struct skid_surface surface = navigation_skid_surface(task->world, task->grounds, &classes);

    return entry != NULL &&
           navigation_skid_init(&skid, entry, &robot->skid_steer, task->world,
                                task->world->config.has_classes ? &surface : NULL, &start, task->seed, driven);
}

/* By the navigator itself. */
static bool drive_alone(const struct lattice_robot *robot, const struct navigation_task *task,
                        struct navigation_result *result)
{
    struct navigation_robot driven;

    return switch_on(robot, task, &driven) && navigation_run(task, &driven, result);
}

/* By itself, or over the bus, with what else is to be told then. */
static bool run(const struct arguments *arguments, const struct lattice_robot *robot,
                const struct navigation_task *task, FILE *frames, struct navigation_result *result, json_t **bus)
{
    static struct bus_navigation navigation;

    if (arguments->bus == NULL) {
        return drive_alone(robot, task, result);
    }
    if (!drive_on_bus(arguments, robot, task, frames, &navigation)) {
        return false;
    }
    *result = navigation.result;
    *bus = json_bus(&navigation);
    print_bus(&navigation);
    return true;
}

/* Exit status. */
static int drive(const struct arguments *arguments, struct map_file *map, const char *map_path,
                 const struct lattice_robot *robot, const struct navigation_world *world,
                 const struct navigation_task *given)
{
    struct navigation_record record;
    struct navigation_result result;
    json_t *bus = NULL;
    FILE *log = output_directory(arguments->plan.common.output)
                    ? output_open(arguments->plan.common.output, "drive.csv")
                    : NULL;
    FILE *frames = log != NULL && arguments->frames ? output_open(arguments->plan.common.output, FRAMES_NAME) : NULL;

    if (log == NULL || (frames == NULL && arguments->frames)) {
        output_discard();
        return ERROR_EXIT;
    }
    navigation_record_init(&record, map, log);
    struct navigation_task task = *given;

    task.context = &record;
    task.watch = navigation_record_watch;
    task.see = navigation_record_see;
    bool is_done = run(arguments, robot, &task, frames, &result, &bus);

    navigation_record_end(&record);
    if (is_done) {
        json_t *summary = json_summary(arguments, map, map_path, robot, &task, world, &result, &record);

        (void)(bus != NULL && json_object_set_new(summary, "bus", bus) == 0);
        (void)(task.battery != NULL && json_object_set_new(summary, "home", json_home(&task, &result)) == 0);
        if (task.battery != NULL && task.battery->pack != NULL) {
            (void)json_object_set_new(summary, "cells", json_cells(&result));
        }
        is_done = output_json(arguments->plan.common.output, "summary.json", summary);
    }
    navigation_record_free(&record);
    if (!is_done) {
        output_discard();
        return ERROR_EXIT;
    }
    print(world, &result);
    if (task.battery != NULL) {
        print_home(&task, &result);
    }
    if (!output_commit()) {
        return ERROR_EXIT;
    }
    const bool is_where_it_should = result.state == JP_NAVIGATOR_ARRIVED && !result.is_stranded;

    return is_where_it_should && !result.is_touched ? EXIT_SUCCESS : NOT_ARRIVED_EXIT;
}

static int navigate(const struct arguments *arguments, struct map_file *map, const struct lattice_robot *robot)
{
    const struct jp_lattice *lattice = prepare(arguments, robot, map);
    struct navigation_world world;
    struct plan_task places;

    if (lattice == NULL || !navigation_world_init(&world, map, robot->grade_max)) {
        return ERROR_EXIT;
    }
    if (!plan_arguments_task(&arguments->plan, map, lattice, &places) ||
        !navigation_world_hide(&world, map, lattice, &places, arguments->boxes, arguments->plan.common.seed,
                               arguments->plan.memory)) {
        navigation_world_free(&world);
        return ERROR_EXIT;
    }
    struct navigation_task task = {.lattice = lattice,
                                   .map = &map->terrain,
                                   .world = &world.terrain,
                                   .solid = &world.solid,
                                   .grounds = map->grounds,
                                   .start = places.start,
                                   .goal = places.goal,
                                   .view_m = arguments->view_m,
                                   .memory = arguments->plan.memory,
                                   .patience = SECONDS_MAX,
                                   .seed = arguments->plan.common.seed};
    struct navigation_pack pack = {.charge = arguments->charge_percent / 100};
    const bool is_fed = arguments->charge_percent >= 0;
    struct navigation_battery battery = {.pack = is_fed ? &pack : NULL,
                                         .joules = arguments->battery_j,
                                         .believed = arguments->battery_j,
                                         .deviation = BATTERY_DEVIATION * arguments->battery_j,
                                         .confidence = arguments->home_percent / 100,
                                         .reach = calloc(map->terrain.config.width, map->terrain.config.height)};

    /* On the bus the ECU has its own. */
    const bool has_battery = arguments->bus == NULL && (is_fed || arguments->battery_j > 0);

    task.battery = has_battery && battery.reach != NULL ? &battery : NULL;

    char *path = realpath(arguments->plan.map_path, NULL);
    const int status = drive(arguments, map, path != NULL ? path : arguments->plan.map_path, robot, &world, &task);

    free(path);
    free(battery.reach);
    navigation_world_free(&world);
    return status;
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_ROBOT(""),
        PLAN_OPTION_PLACES,
        {"hidden", OPTION_BOXES, "N", 0, "boxes on the way that the map does not show (default: 6)", 0},
        {"view", OPTION_VIEW, "M", 0, "how far the robot sees, m (default: 2.5)", 0},
        PLAN_OPTION_BLOCK(", without --bus (default: 1024)"),
        {"bus", 'b', "BUS", 0,
         "map, goal and what it sees go to the robot's ECU in frames: " IN_PROCESS
         ", can:INTERFACE, slcan:DEVICE or pty:NAME, in lockstep",
         0},
        {"patience", OPTION_PATIENCE, "SECONDS", 0, "wait so long for an ECU (10)", 0},
        {"frames", OPTION_FRAMES, NULL, 0,
         "also write DIR/" FRAMES_NAME ", all frames as candump -L does, in simulated time", 0},
        {"battery", OPTION_BATTERY, "JOULES", 0,
         "the battery holds so much: the robot comes home again, and turns back in time", 0},
        {"charge", OPTION_CHARGE, "PERCENT", 0,
         "the same with the robot's cells, which feed it, at this charge, of which it has but an idea", 0},
        {"home", OPTION_HOME, "PERCENT", 0, "how sure it shall be to come home (99.9)", 0},
        OPTION_SEED("of the boxes and of all noise"),
        OPTION_OUTPUT("build/navigate"),
        {0},
    };
    static const struct argp argp = {
        options,
        parse_option,
        "MAP.json",
        "A robot finds its way over a map (tools.design.import_map) to a goal, in closed loop, while it sees boxes "
        "that the map does not show.\v"
        "Exit status: 0 it arrived, with --battery or --charge at its goal and home or home in time, and touched "
        "nothing; 1 not: "
        "the outputs say why; 2 bad input, nothing was written.",
        NULL,
        NULL,
        NULL};
    static struct lattice_robot robot;
    struct arguments arguments = {
        .plan = {.common = {.output = "build/navigate", .seed = 1}, .memory = (size_t)MEMORY_KIB * 1024},
        .boxes = BOXES,
        .view_m = VIEW,
        .patience = BUS_DRIVE_PATIENCE,
        .charge_percent = -1,
        .home_percent = HOME_PERCENT,
    };
    struct map_file map;

    command_line_parse(&argp, argc, argv, &arguments);
    if (!lattice_robot_load(arguments.plan.common.robot, &robot) || !map_file_load(arguments.plan.map_path, &map)) {
        return ERROR_EXIT;
    }
    const int status = navigate(&arguments, &map, &robot);
    map_file_free(&map);
    return status;
}
