/* The simulated robot as a process: sensors, motors and battery on a CAN bus, and an operator that drives a scenario.
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/fault_names.h"
#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/base/real_time.h"
#include "sim/base/stop_signal.h"
#include "sim/bus/bus_open.h"
#include "sim/bus/can_log.h"
#include "sim/bus/can_relay.h"
#include "sim/bus/local_ecu.h"
#include "sim/missions/bus_mission.h"
#include "sim/missions/mission_report.h"

#define IN_PROCESS  "in-process"
#define FRAMES_NAME "frames.log"

static const char *const pace_names[] = {
    [BUS_MISSION_LOCKSTEP] = "lockstep", [BUS_MISSION_PACED] = "paced", [BUS_MISSION_REAL_TIME] = "real-time"};
#define PACES (sizeof pace_names / sizeof pace_names[0])

enum { OPTION_PACE = COMMAND_LINE_OWN, OPTION_FRAMES, OPTION_HOST, OPTION_PATIENCE };

struct arguments {
    const char *scenario;
    struct command_line common;
    bool frames; /**< are logged */
    const char *buses[CAN_RELAY_LINKS];
    size_t bus_count;
    struct bus_mission_timing timing;
    bool hosts;
    double host_seconds;
};

/** Where the ECU is: in this process, or on other links. */
struct surroundings {
    struct local_ecu ecu;
    struct can_relay relay;
    struct jp_can_link link;
};

static void add_bus(struct arguments *arguments, const char *name, struct argp_state *state)
{
    if (arguments->bus_count == CAN_RELAY_LINKS) {
        command_line_refuse(state, "at most %d buses, not also %s", CAN_RELAY_LINKS, name);
    }
    arguments->buses[arguments->bus_count++] = name;
}

static void set_pace(struct arguments *arguments, const char *name, struct argp_state *state)
{
    for (size_t i = 0; i < PACES; i++) {
        if (strcmp(name, pace_names[i]) == 0) {
            arguments->timing.pace = (enum bus_mission_pace)i;
            return;
        }
    }
    command_line_refuse(state, "--pace is lockstep, paced or real-time, not %s", name);
}

static void set_host(struct arguments *arguments, const char *seconds, struct argp_state *state)
{
    arguments->hosts = true;
    if (seconds != NULL) {
        arguments->host_seconds = command_line_real(state, "--host", seconds, 1e-3, 1e6);
    }
}

static void check(const struct arguments *arguments, struct argp_state *state)
{
    bool in_process = false;

    for (size_t i = 0; i < arguments->bus_count; i++) {
        in_process = in_process || strcmp(arguments->buses[i], IN_PROCESS) == 0;
    }
    if (arguments->scenario == NULL || arguments->bus_count == 0) {
        command_line_refuse(state, "a scenario and --bus are needed");
    }
    command_line_need_file(state, arguments->common.json);
    if (in_process &&
        (arguments->bus_count > 1 || arguments->timing.pace == BUS_MISSION_REAL_TIME || arguments->hosts)) {
        command_line_refuse(state, "--bus " IN_PROCESS " stands alone, in lockstep");
    }
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case 'b':
        add_bus(arguments, argument, state);
        return 0;
    case OPTION_PACE:
        set_pace(arguments, argument, state);
        return 0;
    case OPTION_HOST:
        set_host(arguments, argument, state);
        return 0;
    case OPTION_PATIENCE:
        arguments->timing.patience = (unsigned)command_line_whole(state, "--patience", argument, 1, 86400);
        return 0;
    case OPTION_FRAMES:
        arguments->frames = true;
        return 0;
    case ARGP_KEY_ARG:
        command_line_take(state, "scenario", argument, &arguments->scenario);
        return 0;
    case ARGP_KEY_END:
        check(arguments, state);
        return 0;
    default:
        return command_line_option(key, argument, state, &arguments->common);
    }
}

/* The bus. */

static bool start_balancer(struct surroundings *surroundings, const struct scenario *scenario)
{
    const struct robot_entry *entry = rig_find_robot(scenario->robot.name);
    const struct jp_energy_model *model = entry == NULL ? NULL : mission_model(scenario, entry);

    return model != NULL && local_ecu_start(&surroundings->ecu, entry, model, &surroundings->link);
}

static bool start_skid(struct surroundings *surroundings, const struct scenario *scenario)
{
    const struct skid_robot_entry *entry = skid_robot_find(scenario->skid.name);

    return entry != NULL && local_ecu_start_skid(&surroundings->ecu, entry, &surroundings->link);
}

static bool start_ecu(struct surroundings *surroundings, const struct scenario *scenario)
{
    return scenario->kind == SCENARIO_SKID ? start_skid(surroundings, scenario)
                                           : start_balancer(surroundings, scenario);
}

static bool open_links(struct surroundings *surroundings, const struct arguments *arguments)
{
    surroundings->relay.count = 0;
    surroundings->link = can_relay_link(&surroundings->relay);
    for (size_t i = 0; i < arguments->bus_count; i++) {
        struct jp_can_link link;

        if (!bus_open(&link, arguments->buses[i])) {
            surroundings->link.close(surroundings->link.port.context);
            return false;
        }
        (void)can_relay_add(&surroundings->relay, &link);
    }
    return true;
}

static bool open_surroundings(struct surroundings *surroundings, const struct arguments *arguments,
                              const struct scenario *scenario)
{
    if (strcmp(arguments->buses[0], IN_PROCESS) == 0) {
        return start_ecu(surroundings, scenario);
    }
    return open_links(surroundings, arguments);
}

/* The result. */

static void print_bus(const struct bus_mission *result, enum bus_mission_pace pace)
{
    const struct bus_drive *drive = &result->drive;
    char faults[FAULTS_NAME_SIZE];

    (void)printf("\n%-44s %10" PRIu64 "\n", "ticks with the motors on", drive->ticks_driven);
    (void)printf("%-44s %10" PRIu64 "  (%.4f %%)\n", "of those, commands that missed their deadline", drive->late,
                 drive->ticks_driven == 0 ? 0.0 : 100.0 * (double)drive->late / (double)drive->ticks_driven);
    if (pace == BUS_MISSION_REAL_TIME) {
        (void)printf("%-44s %10" PRIu64 "\n", "periods that the plant's own timer missed", result->missed_periods);
        (void)printf("%-44s %10.0f\n", "its worst lateness, us", result->worst_lateness_us);
    }
    (void)printf("%-44s %10" PRIu64 "\n", "motor commands with a wrong CRC", drive->plant.crc_errors);
    (void)printf("%-44s %10" PRIu64 "\n", "motor commands out of sequence", drive->plant.sequence_errors);
    faults_name(drive->view.errors.faults, faults);
    (void)printf("%-44s %#10x  (%s)\n", "faults that the ECU reports", drive->view.errors.faults, faults);
    (void)printf("%-44s %10" PRIu64 "\n", "times that the bridges fell silent", drive->plant.silences);
    (void)printf("%-44s %016" PRIx64 "\n", "fingerprint of trajectory and energies", result->fingerprint);
}

static json_t *bus_json(const struct bus_mission *result, enum bus_mission_pace pace)
{
    const struct bus_drive *drive = &result->drive;
    char fingerprint[17];

    (void)snprintf(fingerprint, sizeof fingerprint, "%016" PRIx64, result->fingerprint);
    return json_pack("{s:s, s:I, s:I, s:I, s:f, s:I, s:I, s:I, s:I, s:s}", "pace", pace_names[pace], "ticks_driven",
                     (json_int_t)drive->ticks_driven, "commands_late", (json_int_t)drive->late, "timer_missed",
                     (json_int_t)result->missed_periods, "timer_worst_us", result->worst_lateness_us,
                     "motor_crc_errors", (json_int_t)drive->plant.crc_errors, "motor_sequence_errors",
                     (json_int_t)drive->plant.sequence_errors, "bridge_silences", (json_int_t)drive->plant.silences,
                     "ecu_faults", (json_int_t)drive->view.errors.faults, "fingerprint", fingerprint);
}

static json_t *summary(const struct scenario *scenario, const struct bus_mission *result, enum bus_mission_pace pace)
{
    json_t *value = mission_json(scenario, &result->mission, 1);

    (void)json_object_set_new(value, "bus", bus_json(result, pace));
    return value;
}

/** The files of a drive besides its summary. */
struct files {
    FILE *log;
    FILE *frames; /**< NULL when they are not wanted */
};

static bool open_files(struct files *files, const struct arguments *arguments, const struct scenario *scenario)
{
    files->frames = NULL;
    if (!output_directory(arguments->common.output)) {
        return false;
    }
    files->log = output_open(arguments->common.output, mission_log_name(bus_mission_strategy(scenario)));
    if (files->log != NULL && arguments->frames) {
        files->frames = output_open(arguments->common.output, FRAMES_NAME);
    }
    return files->log != NULL && (files->frames != NULL || !arguments->frames);
}

static bool drive_route(struct bus_mission *result, const struct arguments *arguments, const struct scenario *scenario,
                        const struct jp_can_link *link, const struct files *files)
{
    const struct mission_view view = {.log = files->log, .progress = mission_name(bus_mission_strategy(scenario))};
    struct can_log log = {.stream = files->frames,
                          .inner = *link,
                          .interface = "can0",
                          .tick = &result->drive.tick,
                          .rate_hz = (uint32_t)scenario_robot(scenario).rate_hz};

    if (!arguments->frames) {
        return bus_mission_run(result, scenario, link, arguments->timing, &view);
    }

    const struct jp_can_link logged = can_log_link(&log);

    return bus_mission_run(result, scenario, &logged, arguments->timing, &view);
}

static bool drive_and_say(const struct arguments *arguments, const struct scenario *scenario,
                          const struct jp_can_link *link, const struct files *files, struct bus_mission *result)
{
    const bool done = drive_route(result, arguments, scenario, link, files);

    if (done) {
        mission_print(&result->mission);
    }
    print_bus(result, arguments->timing.pace);
    return done &&
           output_json(arguments->common.output, "summary.json", summary(scenario, result, arguments->timing.pace));
}

static bool drive_scenario(const struct arguments *arguments, const struct scenario *scenario,
                           const struct jp_can_link *link, struct bus_mission *result)
{
    struct files files;

    if (!open_files(&files, arguments, scenario) || !drive_and_say(arguments, scenario, link, &files, result)) {
        output_discard();
        return false;
    }
    return output_commit();
}

static bool host(const struct arguments *arguments, const struct scenario *scenario, const struct jp_can_link *link,
                 struct bus_mission *result)
{
    const bool done =
        bus_mission_host(result, scenario, link, arguments->timing, arguments->host_seconds, stop_signal_came);

    print_bus(result, arguments->timing.pace);
    return done;
}

/** Of a drive that failed, too. */
static bool write_counts(const struct arguments *arguments, const struct bus_mission *result)
{
    const char *path = arguments->common.json;

    return path == NULL || (output_json(NULL, path, bus_json(result, arguments->timing.pace)) && output_commit());
}

/** The bus carries points alone: what else a route asks for would be left out. */
static bool is_of_points_alone(const char *path, const struct scenario *scenario)
{
    if (scenario->within_seconds > 0 || scenario->within_joules > 0) {
        error_line("%s: a budget (within_seconds, within_joules) is for jp-mission; leave it out", path);
        return false;
    }
    for (size_t i = 0; i < scenario->waypoint_count; i++) {
        if (scenario->passages[i].given != 0) {
            error_line("%s: waypoints[%zu]: a heading or speed is for jp-mission, since the bus carries points alone; "
                       "write [x, y]",
                       path, i);
            return false;
        }
    }
    return true;
}

static bool run(const struct arguments *arguments)
{
    static struct surroundings surroundings;
    static struct bus_mission result;
    struct scenario scenario;
    bool done;

    if (!scenario_load(arguments->scenario, &scenario) || !is_of_points_alone(arguments->scenario, &scenario) ||
        !open_surroundings(&surroundings, arguments, &scenario)) {
        return false;
    }
    (void)printf("jp-plant: %s, robot %s on %s, %s\n", scenario.name, scenario_robot(&scenario).name,
                 arguments->buses[0], pace_names[arguments->timing.pace]);
    (void)fflush(stdout);
    if (arguments->timing.pace == BUS_MISSION_REAL_TIME) {
        (void)real_time_claim();
    }
    done = arguments->hosts ? host(arguments, &scenario, &surroundings.link, &result)
                            : drive_scenario(arguments, &scenario, &surroundings.link, &result);
    done = write_counts(arguments, &result) && done;
    surroundings.link.close(surroundings.link.port.context);
    return done;
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        {"bus", 'b', "BUS", 0,
         IN_PROCESS ", can:INTERFACE, slcan:DEVICE or pty:NAME; again for more, frames are passed on between them", 0},
        {"pace", OPTION_PACE, "PACE", 0, "lockstep, paced (lockstep, not ahead of the clock) or real-time (lockstep)",
         0},
        {"patience", OPTION_PATIENCE, "SECONDS", 0, "in lockstep, wait so long for an ECU (10)", 0},
        OPTION_OUTPUT("build/plant"),
        OPTION_JSON_COUNTS,
        {"frames", OPTION_FRAMES, NULL, 0,
         "also write DIR/" FRAMES_NAME ", all frames as candump -L does, in simulated time", 0},
        {"host", OPTION_HOST, "SECONDS", OPTION_ARG_OPTIONAL,
         "be only the body, for an operator elsewhere on the bus; until stopped, or for some simulated seconds", 0},
        {0},
    };
    static const struct argp argp = {options,
                                     parse_option,
                                     "SCENARIO.cfg",
                                     "Simulates a robot on a CAN bus and drives a scenario's route over it.",
                                     NULL,
                                     NULL,
                                     NULL};
    struct arguments arguments = {.common = {.output = "build/plant"},
                                  .timing = {BUS_MISSION_LOCKSTEP, BUS_DRIVE_PATIENCE}};

    command_line_parse(&argp, argc, argv, &arguments);
    if (arguments.hosts) {
        stop_signal_catch();
    }
    return run(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
