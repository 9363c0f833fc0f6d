/* The firmware's application as a process: the controller of a robot whose body, operator and tools are on a CAN bus.
 */
#include <inttypes.h>
#include <joulepath/tables.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/linux/periodic.h"
#include "hal/linux/retained_file.h"
#include "sim/balancer/rig.h"
#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/base/real_time.h"
#include "sim/base/stop_signal.h"
#include "sim/bus/bus_open.h"
#include "sim/bus/ecu_node.h"
#include "sim/bus/learned_line.h"

/** While nothing arrives the loop looks this often whether it shall stop, µs. */
#define IDLE_US 100000

enum { OPTION_RETAINED = COMMAND_LINE_OWN, OPTION_REAL_TIME };

struct arguments {
    const char *bus;
    const char *robot;
    const char *retained;
    const char *parameters;
    const char *json;
    enum energy_kind energy;
    bool published;
    bool real_time;
};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case 'b':
        arguments->bus = argument;
        return 0;
    case 'r':
        arguments->robot = argument;
        return 0;
    case 'm':
        if (strcmp(argument, "identified") != 0 && strcmp(argument, "published") != 0) {
            command_line_refuse(state, "--model is identified or published, not %s", argument);
        }
        arguments->published = strcmp(argument, "published") == 0;
        return 0;
    case 'e':
        if (!energy_kind_parse(argument, &arguments->energy)) {
            command_line_refuse(state, "--energy is motor or battery, not %s", argument);
        }
        return 0;
    case OPTION_RETAINED:
        arguments->retained = argument;
        return 0;
    case 'p':
        arguments->parameters = argument;
        return 0;
    case 'j':
        arguments->json = argument;
        return 0;
    case OPTION_REAL_TIME:
        arguments->real_time = true;
        return 0;
    case ARGP_KEY_END:
        if (arguments->bus == NULL) {
            command_line_refuse(state, "--bus is needed");
        }
        command_line_need_file(state, arguments->json);
        if (arguments->published && arguments->energy == ENERGY_BATTERY) {
            command_line_refuse(state,
                                "--energy battery: the published model is of the motors' energy; leave --model out");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/** What was told so far. */
struct told {
    struct learned_line line;
    const char *bus;
    bool bus_on;     /**< at the last look */
    bool bus_was_on; /**< before that there is nothing to tell */
};

static void tell_bus(struct told *told, const struct jp_can_link *link)
{
    const bool on = link->port.state(link->port.context) != JP_CAN_DOWN;

    if (on != told->bus_on && told->bus_was_on) {
        (void)printf("jp-ecu: %s is %s\n", told->bus, on ? "back" : "down or gone; waiting for it");
        (void)fflush(stdout);
    }
    told->bus_on = on;
    told->bus_was_on = told->bus_was_on || on;
}

/** After a tick: what it learned is told, and kept when the motors went off. */
static void look(struct ecu_node *node, struct told *told)
{
    learned_line_print(&told->line, node);
    (void)ecu_node_watch(node);
}

/** Until there is no frame left, or a sample is complete. */
static void accept_in_lockstep(struct jp_lockstep *lockstep, const struct jp_can_link *link)
{
    struct jp_can_frame frame;
    bool sampled = false;

    while (!sampled && link->receive(link->port.context, &frame)) {
        sampled = jp_lockstep_accept(lockstep, &frame);
    }
}

static void run_lockstep(struct ecu_node *node, const struct jp_can_link *link, struct told *told)
{
    while (!stop_signal_came()) {
        if (link->wait(link->port.context, IDLE_US)) {
            accept_in_lockstep(&node->lockstep, link);
            look(node, told);
        }
        tell_bus(told, link);
    }
}

/** True when a sample is complete. The simulator's time is to the ECU a frame like any other that it does not know. */
static bool accept_in_real_time(struct jp_ecu *ecu, const struct jp_can_link *link)
{
    struct jp_can_frame frame;
    bool sampled = false;

    while (!sampled && link->receive(link->port.context, &frame)) {
        sampled = jp_ecu_accept(ecu, &frame);
    }
    return sampled;
}

/** A tick follows each sample; when one fails to come, half a period later. */
static void run_real_time(struct ecu_node *node, const struct jp_can_link *link, struct told *told)
{
    struct jp_ecu *const ecu = &node->lockstep.ecu;
    const int64_t period_us = 1000000 / jp_ecu_tick_rate(ecu);
    int64_t last_us = jp_monotonic_us();

    while (!stop_signal_came()) {
        const int64_t deadline_us = last_us + period_us * 3 / 2;
        const bool sampled = accept_in_real_time(ecu, link);

        if (!sampled && jp_monotonic_us() < deadline_us) {
            (void)link->wait(link->port.context, deadline_us - jp_monotonic_us());
            continue;
        }
        jp_ecu_work(ecu);
        jp_ecu_tick(ecu);
        look(node, told);
        tell_bus(told, link);
        /* Without a sample time goes on by whole periods. */
        last_us = sampled ? jp_monotonic_us() : last_us + period_us;
    }
}

#define COUNTS_MAX 14

struct count {
    const char *what;
    const char *key; /**< in JSON */
    uint32_t value;
};

static size_t counts_of(const struct jp_ecu *ecu, const struct jp_ecu_lessons *lessons, struct count counts[COUNTS_MAX])
{
    const struct jp_ecu_counts *samples = &ecu->sample_counts;
    const struct jp_ecu_counts *commands = &ecu->operator_counts;
    const struct count all[] = {
        {"ticks", "ticks", ecu->tick},
        {"resets survived", "resets", ecu->resets},
        {"ticks without a sample", "samples_lost", jp_ecu_lost_samples(ecu)},
        {"frames with a wrong CRC", "crc_errors", (uint32_t)samples->crc_errors + commands->crc_errors},
        {"frames out of sequence", "sequence_errors", (uint32_t)samples->sequence_errors + commands->sequence_errors},
        {"frames malformed", "malformed", (uint32_t)samples->malformed + commands->malformed},
        {"frames unknown", "unknown", ecu->unknown_frames},
        {"frames of another controller", "conflicts", ecu->conflicts},
        {"frames that the bus did not take", "send_errors", ecu->send_errors},
        {"commands rejected", "rejected", (uint32_t)samples->rejected + commands->rejected},
        {"operator timeouts", "operator_timeouts", ecu->operator_timeouts},
        {"bus-offs", "bus_offs", ecu->bus_offs},
        {"segments learned from", "learned_from", lessons->learned_from},
        {"segments left out", "left_out", lessons->left_out},
    };

    memcpy(counts, all, sizeof all);
    return sizeof all / sizeof all[0];
}

/** Also as JSON to `path`, unless that is NULL. */
static bool tell_counts(const struct ecu_node *node, const struct told *told, const char *path)
{
    struct jp_ecu_lessons lessons;
    struct count counts[COUNTS_MAX];
    json_t *object = json_object();
    size_t count;

    jp_ecu_read_lessons(&node->lockstep.ecu, &lessons);
    count = counts_of(&node->lockstep.ecu, &lessons, counts);
    for (size_t i = 0; i < count; i++) {
        (void)printf("%-34s %10" PRIu32 "\n", counts[i].what, counts[i].value);
        (void)json_object_set_new(object, counts[i].key, json_integer(counts[i].value));
    }
    if (path == NULL) {
        json_decref(object);
        return true;
    }
    (void)json_object_set(object, "changes", told->line.told);
    return output_json(NULL, path, object) && output_commit();
}

/** Without a file the record is in the process, and NULL stands for it. */
static bool open_record(const struct arguments *arguments, struct jp_retained_file *file)
{
    char error[256];

    file->retained = NULL;
    if (arguments->retained != NULL && !jp_retained_file_open(file, arguments->retained, error, sizeof error)) {
        error_line("%s", error);
        return false;
    }
    return true;
}

static bool run_on(struct ecu_node *node, const struct jp_can_link *link, const struct arguments *arguments)
{
    struct told told = {.line.told = json_array(), .bus = arguments->bus};
    bool done;

    (void)printf("jp-ecu: robot %s on %s, %s\n", arguments->robot, arguments->bus,
                 arguments->real_time ? "real time" : "lockstep");
    if (arguments->parameters != NULL) {
        learned_line_start(node, arguments->parameters);
    }
    (void)fflush(stdout);
    if (arguments->real_time) {
        (void)real_time_claim();
        run_real_time(node, link, &told);
    } else {
        run_lockstep(node, link, &told);
    }
    done = tell_counts(node, &told, arguments->json);
    json_decref(told.line.told);
    return done;
}

static const struct jp_energy_model *model_of(const struct arguments *arguments, const struct robot_entry *entry)
{
    return arguments->published ? &jp_energy_model_published : rig_energy_model(entry, arguments->energy);
}

/** A balancer's program or, where the name is not one of those, that of another kind of robot. */
static bool start(struct ecu_node *node, const struct arguments *arguments, const struct jp_can_port *bus,
                  struct jp_retained *record)
{
    const struct skid_robot_entry *skid = skid_robot_built_in(arguments->robot);
    const struct patrol_robot_entry *patrol = patrol_robot_built_in(arguments->robot);
    const bool is_balancer = skid == NULL && patrol == NULL;
    const struct robot_entry *entry = is_balancer ? rig_find_robot(arguments->robot) : NULL;
    const struct jp_energy_model *model = entry == NULL ? NULL : model_of(arguments, entry);

    if (!is_balancer && arguments->published) {
        error_line("--model published is of gao2018, not of %s; leave it out", arguments->robot);
        return false;
    }
    if (skid != NULL) {
        return ecu_node_init_skid(node, skid, bus, record, arguments->parameters);
    }
    if (patrol != NULL) {
        return ecu_node_init_patrol(node, patrol, bus, record, arguments->parameters);
    }
    return model != NULL && ecu_node_init(node, entry, model, bus, record, arguments->parameters);
}

static bool run(const struct arguments *arguments)
{
    static struct ecu_node node;
    struct jp_retained_file record;
    struct jp_can_link link;
    bool started;
    bool kept = true;

    if (!open_record(arguments, &record) || !bus_open(&link, arguments->bus)) {
        return false;
    }
    started = start(&node, arguments, &link.port, record.retained);
    if (started) {
        kept = run_on(&node, &link, arguments);
        kept = ecu_node_end(&node) && kept;
    }
    link.close(link.port.context);
    if (record.retained != NULL) {
        jp_retained_file_close(&record);
    }
    return started && kept;
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        {"bus", 'b', "BUS", 0, "can:INTERFACE, slcan:DEVICE or pty:NAME", 0},
        {"robot", 'r', "NAME", 0, "of a robot that is built in, from src/tables (gao2018)", 0},
        {"model", 'm', "WHICH", 0, "energy model: identified or published (identified)", 0},
        {"energy", 'e', "KIND", 0, "what the identified model predicts: energy of the motor or of the battery (motor)",
         0},
        OPTION_JSON_COUNTS,
        {"retained", OPTION_RETAINED, "FILE", 0, "memory that survives a restart (none)", 0},
        {"parameters", 'p', "FILE", 0, "what is learned, kept when the motors are switched off and at the end (none)",
         0},
        {"real-time", OPTION_REAL_TIME, NULL, 0,
         "a tick for each sample, by the clock; otherwise in lockstep with jp-plant", 0},
        {0},
    };
    static const struct argp argp = {
        options, parse_option, "", "Controls a robot over CAN: the firmware's application.", NULL, NULL, NULL};
    struct arguments arguments = {.robot = "gao2018"};

    command_line_parse(&argp, argc, argv, &arguments);
    stop_signal_catch();
    return run(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
